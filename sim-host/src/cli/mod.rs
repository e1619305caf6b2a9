//! The command line, one file per subcommand.

mod accel;
mod basin;
mod bicycle;
mod bicycle_args;
mod board_args;
mod command_line;
mod compare;
mod conditions;
mod design;
mod drawn;
mod eigen;
mod ended;
mod faults;
#[cfg(feature = "fmu")]
mod fmu;
mod identify;
mod identify_files;
mod identify_loop;
mod identify_rider;
mod identify_rider_args;
mod identify_rider_results;
mod identify_sensor;
mod inputs;
mod interrupt;
mod live_picture;
mod monitor;
mod monitor_can;
mod monitor_files;
mod monitor_text;
mod monitor_view;
mod options;
mod outputs;
mod param;
mod parameter_file;
mod pil;
mod pil_basin;
mod plane;
mod port_args;
mod progress;
mod record;
mod recording_args;
mod replay;
mod ride;
mod rider;
mod scenario_error;
mod schema;
mod study;
mod study_args;
mod study_swept;
mod sweep;
mod sweep_status;
mod thesis;
mod threads;
mod weave_args;

use crate::report::output::OutputError;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use ended::{Ended, Failure, UsageError, is_broken_pipe};
use outputs::warn;
use std::io::Write;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Exit codes: 0 ran (a fall is a result), 1 bad input or I/O, 2 usage, 3 part of a board's \
data could not be decoded, 130 interrupted.

Examples:
  sim-host basin --svg basin.svg               the basin of the thesis bicycle under law h
  sim-host ride --speed 4 --steer-rate 5       one ride
  sim-host sweep --over law=h,f,g --out laws   basins over a grid of conditions
  sim-host replay ride.csv --map extract       replay of a recorded ride through the firmware
  sim-host pil --speed 4 --steer-rate 5        the same on an emulated board
  sim-host eigen --law cl2:4                   eigenvalues over speed
  sim-host bicycle list                        the built-in bicycles
  sim-host rider list                          the built-in riders
  sim-host thesis --quick                      the published tables and figures, reproduced";

/// Computes from which disturbances a bicycle with a steer assist recovers
#[derive(Parser)]
#[command(name = "sim-host", version = VERSION, after_help = EXAMPLES, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("SIM_HOST_COMMIT"), ")");

#[derive(Subcommand)]
enum Command {
    /// The basin of attraction over forward speed.
    Basin(Box<basin::Args>),
    /// One ride after a disturbance.
    #[command(after_help = ride::EXAMPLES)]
    Ride(Box<ride::Args>),
    /// Replay of recorded rides through the firmware: modes, causes, margins of every check.
    #[command(after_help = replay::help())]
    Replay(Box<replay::Args>),
    /// Rides and basins with the control step on a board in QEMU: processor in the loop.
    Pil(Box<pil::Args>),
    /// Basins over a grid of conditions: resumable, divisible among machines.
    Sweep(Box<sweep::Args>),
    /// Eigenvalues of the linearised bicycle over speed, and its critical speeds.
    Eigen(eigen::Args),
    /// Identification from recordings: the gains of a rider, the weave, sensors.
    #[command(after_help = identify::EXAMPLES, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
    Identify(Box<identify::Args>),
    /// A synthetic perturbation record: a rider on a treadmill, pushed sideways at random times.
    #[command(after_help = record::EXAMPLES)]
    Record(Box<record::Args>),
    /// The reproduced tables and figures of the thesis, as a report.
    Thesis(thesis::Args),
    /// Bicycles: list, show, check, accelerations.
    #[command(subcommand, after_help = bicycle::EXAMPLES)]
    Bicycle(bicycle::Command),
    /// Riders: list, show, check, merge.
    #[command(subcommand, after_help = rider::EXAMPLES)]
    Rider(rider::Command),
    /// A gain schedule with the largest worst-case basin, evaluated beside the known laws.
    Design(design::Args),
    /// A study: a computed answer to a question, as a page with figures.
    Study(study_args::Args),
    /// The built-in studies with their questions.
    #[command(after_help = "Example:\n  sim-host studies")]
    Studies,
    /// Live values of a board with names of causes and limits; also as table or recording.
    Monitor(monitor::Args),
    /// A board's parameters: list, get, set, store, reset, export, import.
    #[command(subcommand, after_help = param::EXAMPLES)]
    Param(param::Command),
    /// The fault records stored on a board.
    Faults(faults::Args),
    /// The controller, the bicycle or the rider as an FMU, for other simulators.
    #[cfg(feature = "fmu")]
    #[command(subcommand, after_help = fmu::EXAMPLES)]
    Fmu(fmu::Command),
    /// The controller, the bicycle or the rider as an FMU: needs a build with `--features fmu`.
    #[cfg(not(feature = "fmu"))]
    Fmu {
        /// Not read
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
        words: Vec<String>,
    },
    /// The JSON schema of a command's `--json` document.
    #[command(after_help = "Example:\n  sim-host schema basin > basin.schema.json")]
    Schema {
        /// Name of the document
        #[arg(value_parser = schema::names())]
        document: String,
    },
}

/// Runs the program: arguments from the process, results to standard output, errors to standard error.
pub fn run() -> ExitCode {
    let command = with_negative_numbers(Cli::command());
    let cli = match command.try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(help) if !help.use_stderr() => return code(shown(&help)),
        Err(usage) => usage.exit(),
    };
    interrupt::handle_signals();
    if let Err(why) = inputs::refuse_overwriting(std::env::args_os().skip(1)) {
        outputs::complain(&format!("error: {why}"));
        return ExitCode::from(1);
    }
    let ended = match cli.command {
        Command::Basin(args) => basin::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Ride(args) => ride::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Pil(args) => pil::run(&args),
        Command::Eigen(args) => eigen::run(&args),
        Command::Identify(command) => identify::run(&command),
        Command::Record(args) => record::run(&args),
        Command::Thesis(args) => thesis::run(&args),
        Command::Bicycle(command) => bicycle::run(&command),
        Command::Rider(command) => rider::run(&command),
        Command::Design(args) => design::run(&args),
        Command::Study(args) => study::run(&args),
        Command::Studies => study::list(),
        Command::Monitor(args) => monitor::run(&args),
        Command::Param(command) => param::run(&command),
        Command::Faults(args) => faults::run(&args),
        #[cfg(feature = "fmu")]
        Command::Fmu(command) => fmu::run(&command),
        #[cfg(not(feature = "fmu"))]
        Command::Fmu { words: _ } => {
            Err("this program was built without FMUs; with them: `cargo build --release -p sim-host --features fmu`".into())
        }
        Command::Schema { document } => schema::run(&document),
    };
    code(ended)
}

/// Lets every option take a negative number, so that the error is about its range.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| {
            let option = !arg.is_positional() && arg.get_action().takes_values();
            if option { arg.allow_negative_numbers(true) } else { arg }
        })
        .mut_subcommands(with_negative_numbers)
}

/// Writes the help or the version to standard output.
fn shown(help: &clap::Error) -> Result<Ended, Failure> {
    let written = help.print().and_then(|()| std::io::stdout().flush());
    written.map(|()| Ended::Done).map_err(|error| OutputError::of_standard(error).into())
}

/// The exit code of a command, with its error on standard error.
fn code(ended: Result<Ended, Failure>) -> ExitCode {
    match ended {
        Ok(Ended::Done) => ExitCode::SUCCESS,
        Ok(Ended::Interrupted) => ExitCode::from(130),
        Ok(Ended::Partly) => ExitCode::from(3),
        // A reader that closes the pipe, like `head`, is no error.
        Err(e) if is_broken_pipe(&*e) => ExitCode::SUCCESS,
        Err(e) => {
            outputs::complain(&format!("error: {e}"));
            ExitCode::from(if e.is::<UsageError>() { 2 } else { 1 })
        }
    }
}
