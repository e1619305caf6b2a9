//! The command line of the simulator.

fn main() -> std::process::ExitCode {
    sim_host::cli::run()
}
