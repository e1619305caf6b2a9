//! `sim-host pil`: a ride whose control step runs on a board in QEMU.

use super::board_args::BoardArgs;
use super::conditions::{printed, setup};
use super::outputs::{complain, print};
use super::scenario_error::named;
use super::{Ended, Failure, pil_basin, ride};
use crate::commands::ride::{Ridden, check_direction, start};
use crate::counted::counted;
use crate::pil::Controller;
use crate::pil::compare::{Recorder, same_ride};
use crate::pil::qemu::Qemu;
use crate::ride::{rides_on, traced_on};
use std::fmt::Write;
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  sim-host pil --speed 4 --steer-rate 5 --compare
  sim-host pil --preset product --speed 4 --steer-rate 3 --inject sensors:drop@1s..1.05s
  sim-host pil --preset product --speed 4 --steer-rate 3 --fault gyro:stuck@300ms --csv ride.csv
  sim-host pil --preset product --speed 4 --steer-rate 3 --bench
  sim-host pil basin --speeds 3:6:1 --tolerance 0.1 --compare";

/// Options of `pil`.
#[derive(clap::Args)]
#[group(skip)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    ride: RideArgs,
}

#[derive(clap::Subcommand)]
enum Command {
    /// The basin of attraction, with every ride on a board
    Basin(Box<pil_basin::Args>),
}

/// A ride on a board.
#[derive(clap::Args)]
struct RideArgs {
    #[command(flatten)]
    ride: ride::Args,
    #[command(flatten)]
    board: BoardArgs,
    /// Ride five times and print the median speed
    #[arg(long, conflicts_with = "compare")]
    bench: bool,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    match &args.command {
        Some(Command::Basin(args)) => pil_basin::run(args),
        None => on_board(&args.ride),
    }
}

fn on_board(args: &RideArgs) -> Result<Ended, Failure> {
    let scenario = args.ride.scenario.scenario()?;
    let start = start(&scenario).map_err(|e| named(&scenario, &e))?;
    if let Some(ended) = printed(&args.ride.scenario, &scenario)? {
        return Ok(ended);
    }
    let setup = setup(&scenario)?;
    check_direction(start, &setup.conditions).map_err(|e| named(&scenario, &e))?;
    let start_board = args.board.starter(&setup)?;
    let outputs = args.ride.open()?;
    let mut controller = start_board()?;
    if args.bench {
        let times = (0..5).map(|_| {
            let (begin, before) = (Instant::now(), controller.tally().steps);
            rides_on(&setup.conditions, &[start], &mut controller)?;
            Ok(speed(controller.tally().steps - before, begin.elapsed().as_secs_f64()))
        });
        let mut times: Vec<f64> = times.collect::<Result<_, Failure>>()?;
        times.sort_by(f64::total_cmp);
        print(&format!(
            "median of 5 rides: {:.1} times as fast as in real time ({:.1} to {:.1})\n",
            times[2], times[0], times[4]
        ))?;
        return Ok(Ended::Done);
    }
    let begin = Instant::now();
    let mut recorder = Recorder::new(&mut controller);
    let (ride, trace) = traced_on(&setup.conditions, start, &mut recorder)?;
    let seconds = begin.elapsed().as_secs_f64();
    let steps = recorder.steps;
    let mut text = tally(&controller, seconds);
    let same = args.board.compare.then(|| same_ride(&setup.conditions, &steps, &ride, &trace));
    if let Some(Ok(())) = same {
        let _ = writeln!(
            text,
            "the same bits as in this program: {} control steps, {} instants, the ride's end",
            steps.len(),
            trace.len()
        );
    }
    let sensed = || steps.iter().map(|(frame, _)| *frame).collect();
    ride::write(&setup, &outputs, &Ridden { ride, trace }, sensed, &text)?;
    same.unwrap_or(Ok(())).map_err(|difference| format!("--compare: {difference}"))?;
    Ok(Ended::Done)
}

/// Speed relative to real time.
fn speed(steps: u64, seconds: f64) -> f64 {
    steps as f64 * 1e-3 / seconds
}

/// Summary of a controller's counts and speed over `seconds`.
fn tally(controller: &Controller<Qemu>, seconds: f64) -> String {
    let tally = controller.tally();
    let steps = tally.steps;
    let mut text = format!(
        "board: {steps} control steps in {seconds:.2} s, {:.1} times as fast as in real time\n",
        speed(steps, seconds)
    );
    if tally.affected > 0 {
        let _ = writeln!(text, "a link fault acted on {} control steps", tally.affected);
    }
    if tally.missed > 0 || tally.restarts > 0 {
        let _ = writeln!(
            text,
            "the board missed {}, its chip restarted {}",
            counted(tally.missed, "control step", "control steps"),
            counted(tally.restarts, "time", "times")
        );
        complain(&format!("note: output of the board:\n{}", controller.board.output()));
    }
    text
}
