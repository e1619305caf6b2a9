//! `sim-host pil basin`: a basin with the control step of every ride on a board in QEMU.

use super::basin::{BasinArgs, write};
use super::board_args::BoardArgs;
use super::conditions::{printed, setup};
use super::outputs::{Further, complain};
use super::progress::progress;
use super::scenario_error::named;
use super::{Ended, Failure, interrupt};
use crate::basin::{Method, Search, basin, basin_by};
use crate::commands::basin::Searched;
use crate::counted::counted;
use crate::pil::compare::same_basin;
use crate::pil::qemu::Qemu;
use crate::pil::{Controller, Tally};
use crate::ride::{RemoteError, rides_on};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  sim-host pil basin --speeds 3:6:1 --tolerance 0.1 --compare
  sim-host pil basin --speeds 0:10:0.1 --threads 2 --svg basin.svg --json basin.json";

/// Options of `pil basin`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    #[command(flatten)]
    basin: BasinArgs,
    #[command(flatten)]
    board: BoardArgs,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let BasinArgs { scenario: chosen, threads, netcdf, outputs } = &args.basin;
    let mut scenario = chosen.scenario()?;
    let draws = scenario.uncertain.is_some() || scenario.rider_draws.is_some();
    if draws || scenario.search.adaptive_speeds.is_some() {
        complain(
            "note: on boards there are no draws and no added speeds (uncertain, rider-draws, adaptive-speeds)",
        );
    }
    (scenario.uncertain, scenario.rider_draws, scenario.search.adaptive_speeds) = (None, None, None);
    // Every ride of a board is exact.
    scenario.search.method = Method::Plain;
    if let Some(ended) = printed(chosen, &scenario)? {
        return Ok(ended);
    }
    let setup = setup(&scenario)?;
    let searched = scenario.search.resolve(scenario.is_ridden()).map_err(|e| named(&scenario, &e))?;
    let start_board = args.board.starter(&setup)?;
    let outputs = outputs.open(Further { netcdf: netcdf.as_deref(), ..Further::default() })?;
    // One board is started first, to detect errors early; each thread has its own.
    let boards = Mutex::new(vec![start_board()?]);
    let ride = |starts: &[_]| -> Result<_, RemoteError> {
        let idle = locked(&boards).pop();
        let mut board = idle.map_or_else(&start_board, Ok)?;
        let done = rides_on(&setup.conditions, starts, &mut board)?;
        locked(&boards).push(board);
        Ok(done)
    };
    interrupt::install();
    let pool = threads.pool()?;
    let bar = progress(outputs.shows_progress(), "pil basin", searched.speeds.len(), "speeds");
    let begin = Instant::now();
    let result =
        pool.install(|| basin_by(&setup.conditions, &searched, ride, |_| bar.inc(1), interrupt::stopped));
    let seconds = begin.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let result = result?;
    let mut text = tally(&locked(&boards), seconds);
    let mut same = Ok(());
    if args.board.compare && !result.columns.is_empty() {
        let speeds = result.columns.iter().map(|column| column.speed).collect();
        let done = Search { speeds, ..searched.clone() };
        let here = pool.install(|| basin(&setup.conditions, &done, |_| (), || false))?;
        same = same_basin(&here, &result);
        if same.is_ok() {
            text += &format!(
                "the same bits as in this program: {}\n",
                counted(result.columns.len(), "speed", "speeds")
            );
        }
    }
    let ended = write(
        &setup,
        &outputs,
        &Searched { search: searched, basin: result, drawn: None, seconds },
        pool.current_num_threads(),
        &text,
    )?;
    same.map_err(|difference| format!("--compare: {difference}"))?;
    Ok(ended)
}

/// Summary of the boards' counts and speed over `seconds`.
fn tally(boards: &[Controller<Qemu>], seconds: f64) -> String {
    let sum = |of: fn(Tally) -> u64| boards.iter().map(|board| of(board.tally())).sum::<u64>();
    let (steps, affected) = (sum(|t| t.steps), sum(|t| t.affected));
    let mut text = format!(
        "{}: {steps} control steps, {:.1} times as fast as in real time\n",
        counted(boards.len(), "board", "boards"),
        steps as f64 * 1e-3 / seconds
    );
    if affected > 0 {
        text += &format!("a link fault acted on {affected} control steps\n");
    }
    let (missed, restarts) = (sum(|t| t.missed), sum(|t| t.restarts));
    if missed > 0 || restarts > 0 {
        text +=
            &format!("the boards missed {missed} control steps, their chips restarted {restarts} times\n");
    }
    text
}

/// Locks the boards, even if a thread panicked while holding them.
fn locked(boards: &Mutex<Vec<Controller<Qemu>>>) -> std::sync::MutexGuard<'_, Vec<Controller<Qemu>>> {
    boards.lock().unwrap_or_else(PoisonError::into_inner)
}
