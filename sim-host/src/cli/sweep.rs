//! `sim-host sweep`: basins over a grid of conditions, from options to a folder of results.

use super::options::{Cells, Options, ScenarioFile, Search};
use super::outputs::{complain, complain_once, print, write_json};
use super::progress::{print_wait, progress};
use super::scenario_error::failure;
use super::threads::ThreadArgs;
use super::{Ended, Failure, UsageError, interrupt, sweep_status};
use crate::basin::{Bound, border};
use crate::commands::sweep::{SweepTask, sweep as resolve};
use crate::counted::counted;
use crate::report::output::Output;
use crate::scenario::Scenario;
use crate::scenario::setting::Given;
use crate::sweep::document::SweepDocument;
use crate::sweep::{self, Axis, Cell, Folder, Grid, Progress, Shard, Wait};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

const EXAMPLES: &str = "\
KEY is the name of an option below, or a word in braces in an option's value. VALUES are words \
and ranges: A:B:STEP, A:B/N (N evenly spaced values), A:B/logN (evenly in the logarithm).

Examples:
  sim-host sweep --over torque-limit=0.5:20/log9,none --over sensor-delay=0ms:100ms/6 --out limits
  sim-host sweep --over law=h,f,g --over rider=none,smart --speeds 2:7.5:0.5 --out laws
  sim-host sweep --law cl2:{k} --over k=0.5:20/log7 --out cl2
  sim-host sweep --over law=h,f,g --out part2 --shard 2/3
  sim-host sweep --over law=h,f,g --out laws & sim-host sweep --over law=h,f,g --out laws
  sim-host sweep --status laws
  sim-host sweep merge part1 part2 part3 --out whole";

/// Options of `sweep`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    /// Axis and its values; may be repeated, once per axis
    #[arg(long, required_unless_present = "status", value_name = "KEY=VALUES", value_parser = Axis::parse)]
    over: Vec<Axis>,
    /// Folder of the results; an interrupted sweep in it is continued, and several processes share the cells
    #[arg(long, default_value = "sweep", value_name = "DIR")]
    out: PathBuf,
    /// Compute only part I of N, to be merged with the others
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    /// Show which cells of the sweep in DIR are done, by which processes the others are computed, and the time left
    #[arg(long, value_name = "DIR", conflicts_with_all = ["over", "out", "shard", "dry_run", "quiet", "scenario", "threads"])]
    status: Option<PathBuf>,
    /// List the cells, estimate the computing time, and end
    #[arg(long, conflicts_with = "json")]
    dry_run: bool,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    scenario: ScenarioFile,
    #[command(flatten)]
    search: Options<Search>,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten, next_help_heading = "Options of `basin`, for all cells")]
    conditions: Options<Cells>,
}

/// Outputs besides the folder.
#[derive(clap::Args)]
struct OutputArgs {
    /// Also write the document to FILE, or to standard output (-)
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// No text or progress bar
    #[arg(long, short)]
    quiet: bool,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Merge the parts of a sweep
    Merge(Merge),
}

/// Options of `sweep merge`.
#[derive(clap::Args)]
struct Merge {
    /// Folders written by `sweep --shard`
    #[arg(required = true, value_name = "DIR")]
    parts: Vec<PathBuf>,
    /// Folder of the complete sweep
    #[arg(long, default_value = "sweep", value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    if let Some(Command::Merge(args)) = &args.command {
        return merge(args);
    }
    if let Some(folder) = &args.status {
        if let Some(given) = args.search.given.iter().chain(&args.conditions.given).next() {
            let name = given.setting.name;
            return Err(UsageError(format!(
                "--{name} has no effect with --status, which reads the folder's plan"
            ))
            .into());
        }
        return sweep_status::run(folder, args.output.json.as_deref());
    }
    let mut base = args.scenario.read()?;
    args.search.apply(&mut base)?;
    let resolved = resolved(&args.over, &base, args.conditions.given.clone())?;
    let mine = args.shard.unwrap_or(Shard::WHOLE).of(&resolved.plan.cells);
    let pool = args.threads.pool()?;
    if args.dry_run {
        return dry_run(&resolved, &mine, &args.out, pool.current_num_threads());
    }
    let json = args.output.json.as_deref().map(Output::create).transpose()?;
    interrupt::install();
    let folder = Folder::open(&args.out, &resolved.plan)?;
    let to_do = to_do(&resolved, &mine, &folder);
    let bar = progress(!args.output.quiet, "sweep", to_do.len() * resolved.search.speeds.len(), "columns");
    let waits = |wait: &Wait| print_wait(!args.output.quiet, &bar, wait);
    let steps = Progress { advanced: &|| bar.inc(1), waits: &waits, stop: &interrupt::stopped };
    let done = pool.install(|| sweep::run(&to_do, &resolved.search, &folder, &steps));
    bar.finish_and_clear();
    let done = done?;
    let grid = Grid::gather(&resolved.plan, std::slice::from_ref(&folder))?;
    finish(&grid, &folder, json.as_ref(), args.output.quiet)?;
    if done.cells == to_do.len() {
        return Ok(Ended::Done);
    }
    let there = mine.iter().filter(|&&i| grid.units[i].is_some()).count();
    complain(&format!(
        "interrupted: {there} of {} cells are done and kept; the same command continues",
        mine.len()
    ));
    Ok(Ended::Interrupted)
}

/// The sweep, with its remarks on standard error.
pub(super) fn resolved(axes: &[Axis], base: &Scenario, given: Vec<Given>) -> Result<SweepTask, Failure> {
    let task = resolve(axes, base, given).map_err(|error| failure(base, error))?;
    task.remarks.iter().for_each(|remark| complain_once(remark));
    Ok(task)
}

/// The cells of `mine` that are missing or damaged; damage causes a warning.
pub(super) fn to_do<'a>(resolved: &'a SweepTask, mine: &[usize], folder: &Folder) -> Vec<&'a Cell> {
    let cells = mine.iter().map(|&i| &resolved.cells[i]);
    let missing = |cell: &&Cell| match folder.unit(&cell.id) {
        Ok(there) => there.is_none(),
        Err(e) => {
            complain(&format!("warning: {e}: computed again"));
            true
        }
    };
    cells.filter(missing).collect()
}

/// Writes the results of a complete sweep, and the requested document.
pub(super) fn finish(
    grid: &Grid,
    folder: &Folder,
    json: Option<&Output>,
    quiet: bool,
) -> Result<(), Failure> {
    let document = SweepDocument::new(grid);
    if document.complete {
        sweep::write(grid, &document, folder)?;
    }
    if let Some(output) = json {
        write_json(output, &document)?;
    }
    if quiet || json.is_some_and(Output::is_standard) {
        return Ok(());
    }
    print(&summary(grid, &document, folder.path()))
}

fn summary(grid: &Grid, document: &SweepDocument, folder: &Path) -> String {
    let (all, folder) = (grid.units.len(), folder.display());
    if !document.complete {
        return format!("{} of {all} cells are in {folder}; the rest is missing\n", document.cells.len());
    }
    let mut text = format!(
        "{}, {}; results in {folder}\n",
        counted(all, "cell", "cells"),
        counted(document.work.rides, "ride", "rides")
    );
    let (name, unit) = if grid.one_speed() { ("height", "rad/s") } else { ("area", "rad m/s^2") };
    let measured = grid.measures().into_iter().enumerate().filter_map(|(i, m)| Some((i, m?)));
    let measured: Vec<(usize, (f64, Bound))> = measured.collect();
    let by_size = |a: &&(usize, (f64, Bound)), b: &&(usize, (f64, Bound))| a.1.0.total_cmp(&b.1.0);
    let ends = [("largest", measured.iter().max_by(by_size)), ("smallest", measured.iter().min_by(by_size))];
    for (which, end) in ends {
        if let Some(&(i, (measure, bound))) = end {
            let at = grid.plan.label(i);
            let least = if bound.is_measured() { "" } else { "at least " };
            let _ = writeln!(text, "{which} {name} {least}{measure:.3} {unit} at {at}");
        }
    }
    let capped = measured.iter().filter(|(_, (_, bound))| !bound.is_measured()).count();
    if capped > 0 {
        let [largest, smallest] =
            ends.map(|(_, end)| end.is_some_and(|(_, (_, bound))| !bound.is_measured()));
        let unknown = not_known(measured.len(), capped, largest, smallest);
        let rate = document.search.max_rate;
        let _ = writeln!(
            text,
            "{capped} of {all} cells are lower bounds, as nothing fell up to {rate} rad/s{unknown}"
        );
    }
    text
}

/// Note on the ranking of `all` cells of which `capped` are lower bounds; `largest` and `smallest` say whether those
/// cells are lower bounds themselves.
fn not_known(all: usize, capped: usize, largest: bool, smallest: bool) -> &'static str {
    match (capped > usize::from(largest), smallest && all > 1) {
        (false, false) => "",
        (true, false) => ": which is the largest is not known",
        (false, true) => ": which is the smallest is not known",
        (true, true) => ": which is the largest and which the smallest is not known",
    }
}

/// Most columns timed for an estimate.
const TIMED: usize = 4;

/// Lists the cells and estimates the computing time from a few columns.
fn dry_run(resolved: &SweepTask, mine: &[usize], out: &Path, threads: usize) -> Result<Ended, Failure> {
    let (plan, speeds) = (&resolved.plan, &resolved.search.speeds);
    let folder = out.join(sweep::PLAN).exists().then(|| Folder::open(out, plan)).transpose()?;
    let to_do: Vec<&Cell> = match &folder {
        Some(folder) => to_do(resolved, mine, folder),
        None => mine.iter().map(|&i| &resolved.cells[i]).collect(),
    };
    let missing: BTreeSet<&str> = to_do.iter().map(|cell| &*cell.id).collect();
    let mut text = String::new();
    for &i in mine {
        let is = if missing.contains(&*plan.cells[i]) { "to do" } else { "done " };
        let _ = writeln!(text, "{}  {is}  {}", plan.cells[i], plan.label(i));
    }
    let timed: Vec<&&Cell> = to_do.iter().step_by(to_do.len().div_ceil(TIMED).max(1)).collect();
    let begin = Instant::now();
    for cell in &timed {
        border(&cell.conditions, &resolved.search, speeds[speeds.len() / 2]);
    }
    let each = begin.elapsed().as_secs_f64() / timed.len().max(1) as f64;
    let columns = to_do.len() * speeds.len();
    let _ = writeln!(
        text,
        "{} of {} to do, {} each: about {} on {} ({} timed)",
        to_do.len(),
        counted(mine.len(), "cell", "cells"),
        counted(speeds.len(), "speed", "speeds"),
        duration(each * columns as f64 / threads as f64),
        counted(threads, "thread", "threads"),
        counted(timed.len(), "column", "columns")
    );
    print(&text)?;
    Ok(Ended::Done)
}

/// A duration as text.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

fn merge(args: &Merge) -> Result<Ended, Failure> {
    let json = args.output.json.as_deref().map(Output::create).transpose()?;
    let parts: Vec<(Folder, _)> = args.parts.iter().map(|p| Folder::there(p)).collect::<Result<_, _>>()?;
    let plan = &parts[0].1;
    for (folder, other) in &parts[1..] {
        if let Some(what) = plan.difference(other) {
            let (first, other) = (parts[0].0.path().display(), folder.path().display());
            return Err(format!("{first} and {other} are parts of different sweeps: {what} differs").into());
        }
    }
    let folders: Vec<Folder> = parts.iter().map(|(folder, _)| folder.clone()).collect();
    let grid = Grid::gather(plan, &folders)?;
    if let Some(first) = grid.units.iter().position(Option::is_none) {
        return Err(format!(
            "{} of {} cells are in none of the folders, the first is {}; compute the missing shards first",
            grid.missing(),
            grid.units.len(),
            plan.label(first)
        )
        .into());
    }
    let whole = Folder::open(&args.out, plan)?;
    for unit in grid.units.iter().flatten() {
        if !matches!(whole.unit(&unit.id), Ok(Some(_))) {
            whole.keep(unit)?;
        }
    }
    finish(&grid, &whole, json.as_ref(), args.output.quiet)?;
    Ok(Ended::Done)
}
