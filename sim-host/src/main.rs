//! Entry point of the command line `sim-host`.

fn main() -> std::process::ExitCode {
    sim_host::cli::run()
}
