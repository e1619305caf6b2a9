//! `sim-host basin`: searches the basin of attraction over forward speed.

use super::conditions::{printed, setup};
use super::drawn::{self, label};
use super::live_picture::LivePicture;
use super::options::{Basin as BasinOptions, Chosen, UncertainBasin};
use super::outputs::{Further, OutputArgs, Outputs, Results, complain};
use super::progress::progress;
use super::ride::laid_flat;
use super::scenario_error::named;
use super::threads::ThreadArgs;
use super::{Ended, Failure, interrupt};
use crate::basin::{Basin, Column, Search, Work};
use crate::bicycle::linear::Linear;
use crate::commands::basin::{BasinTask, Searched};
use crate::commands::linear_loop::unstable_speeds;
use crate::commands::{Hooks, Setup};
use crate::counted::counted;
use crate::eigen::critical_speeds;
use crate::report::figure::{self, Band, BasinFigure};
use crate::report::{netcdf, table, terminal};
use crate::ride::{FallCause, FallCriterion, Outcome};
use crate::scenario::LoadedRider;
use control::Law;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  sim-host basin --svg basin.svg --json basin.json
  sim-host basin --law none --speeds 4:10:0.1
  sim-host basin --speeds 0:10:0.4 --adaptive-speeds
  sim-host basin --rider young --delay 60ms --gains best
  sim-host basin --law cl2:4 --assist ideal --schedule-speed rear
  sim-host basin --preset product --sensor-delay 20ms --csv product.csv
  sim-host basin --bicycle tests/data/bicycleparameters/bicycles/Rigid+Jason --uncertain 50
  sim-host basin --rider young --rider-draws 100 --gains spline --svg band.svg
  sim-host basin --bicycle my.toml#city --axis roll-rate --max-rate 5
  sim-host basin compare 'young=--rider young' 'smart=--rider smart' --svg riders.svg
  sim-host basin plane --speed 4 --rider smart --law h --svg plane.svg";

/// Options of `basin`, and its subcommands.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    scenario: Chosen<UncertainBasin>,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Write a NetCDF file with CF conventions; a name that ends with .nc4 gives NetCDF-4; - is standard output
    #[arg(long, value_name = "FILE")]
    netcdf: Option<PathBuf>,
    #[command(flatten)]
    outputs: OutputArgs,
}

/// Options of a basin with rides on boards.
#[derive(clap::Args)]
pub(super) struct BasinArgs {
    #[command(flatten)]
    pub(super) scenario: Chosen<BasinOptions>,
    #[command(flatten)]
    pub(super) threads: ThreadArgs,
    /// Write a NetCDF file with CF conventions; a name that ends with .nc4 gives NetCDF-4; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) netcdf: Option<PathBuf>,
    #[command(flatten)]
    pub(super) outputs: OutputArgs,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Several basins in one figure, with area, mean height and distances (RMSE)
    Compare(super::compare::Args),
    /// The basin at one speed over steer rate and roll rate together
    Plane(Box<super::plane::Args>),
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    match &args.command {
        Some(Command::Compare(args)) => return super::compare::run(args),
        Some(Command::Plane(args)) => return super::plane::run(args),
        None => {}
    }
    let scenario = args.scenario.scenario()?;
    if let Some(ended) = printed(&args.scenario, &scenario)? {
        return Ok(ended);
    }
    let setup = setup(&scenario)?;
    let mut task = BasinTask::new(setup).map_err(|e| named(&scenario, &e))?;
    let outputs = args.outputs.open(Further { netcdf: args.netcdf.as_deref(), ..Further::default() })?;
    task.search.efforts = outputs.has_efforts();
    interrupt::install();
    let pool = args.threads.pool()?;
    let bar = progress(outputs.shows_progress(), "basin", task.columns(), "columns");
    let picture = outputs.shows_picture().then(|| LivePicture::new(&bar, &task.search)).flatten();
    let column = |column: &Column| picture.iter().for_each(|picture| picture.add(column));
    let hooks = Hooks {
        finished: &|| bar.inc(1),
        added: &|columns| bar.inc_length(columns as u64),
        stop: &interrupt::stopped,
    };
    let compute = || pool.install(|| task.run(picture.is_some(), column, hooks));
    let found = picture.as_ref().map_or_else(compute, |picture| picture.during(compute))?;
    bar.finish_and_clear();
    write(&task.setup, &outputs, &found, pool.current_num_threads(), "")
}

/// Writes a complete or partial basin, searched by `threads`; `extra` is added to the text.
pub(super) fn write(
    setup: &Setup,
    outputs: &Outputs,
    found: &Searched,
    threads: usize,
    extra: &str,
) -> Result<Ended, Failure> {
    let Searched { search, basin: result, seconds, .. } = found;
    if result.columns.is_empty() {
        complain("interrupted: no speed is done, nothing is written");
        return Ok(Ended::Interrupted);
    }
    let complete = found.complete();
    let document = found.document(setup);
    // Without finished draws there is no band.
    let drawn = found.drawn();
    let heights = drawn.map_or(Vec::new(), |drawn| drawn.of.heights());
    let band: Vec<_> =
        search.speeds.iter().zip(&heights).map(|(v, [low, _, high])| (*v, *low, *high)).collect();
    let band_label = drawn.map_or(String::new(), label);
    let uncontrolled = critical_speeds(&Linear::new(&setup.parameters), &Law::None);
    let conditions = setup.config.label();
    let cut = if complete { "" } else { ", interrupted" };
    let title = format!("Basin of attraction: {conditions}, {}{cut}", setup.config.assist);
    let figure = BasinFigure {
        series: &[("", result)],
        self_stable: uncontrolled.v_w.zip(uncontrolled.v_c),
        axis: search.axis,
        cap: search.max_rate,
        title: &title,
        band: drawn.map(|_| Band { label: &band_label, edges: &band }),
    };
    let config = json!({"config": document.config, "search": document.search, "complete": complete});
    let written = outputs.write_netcdf(|| {
        let attributes = netcdf::provenance(&config, &document.scenario);
        netcdf::basin(&title, attributes, search.axis, result, drawn.map(|drawn| &drawn.of))
    });
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || {
            terminal::basin(&figure, 80)
                + &summary(result, search, &setup.conditions.fall, *seconds, threads)
                + &unstable(result, setup)
                + &drawn.map_or(String::new(), |drawn| drawn::summary(drawn, &search.speeds))
                + extra
        },
        table: || {
            let drawn = drawn.map_or(Vec::new(), |drawn| table::drawn_rows(&search.speeds, &drawn.of));
            table::table(&config, &[table::basin_rows(result), drawn].concat())
        },
        figure: || figure::basin(&figure),
    })?;
    written?;
    if complete {
        return Ok(Ended::Done);
    }
    let (done, all, what) = match &found.drawn {
        Some(drawn) if found.every_speed() => (drawn.of.basins.len(), drawn.count, "draws"),
        _ => (result.columns.len(), search.speeds.len(), "speeds"),
    };
    complain(&format!("interrupted: {done} of {all} {what} are done and kept"));
    Ok(Ended::Interrupted)
}

/// The result as text.
fn summary(basin: &Basin, search: &Search, fall: &FallCriterion, seconds: f64, threads: usize) -> String {
    let mut text = String::new();
    let Work { rides, steps: _, right_hand_sides } = basin.work();
    let at_least = if basin.capped() { "at least " } else { "" };
    let (done, all) = (basin.columns.len(), search.speeds.len());
    match (&basin.columns[..], basin.mean_height()) {
        _ if done < all => {
            let _ = writeln!(text, "incomplete, {done} of {all} speeds: no area and no mean height");
        }
        ([only], _) => {
            let _ = writeln!(
                text,
                "one speed: no area; height {at_least}{:.3} rad/s (within {})",
                only.upper, search.tolerance
            );
        }
        (_, mean) => {
            let _ = writeln!(text, "area {at_least}{:.3} rad m/s^2", basin.area());
            let mean = mean.unwrap_or(0.0);
            let _ = writeln!(
                text,
                "mean height {at_least}{mean:.3} rad/s (borders within {} rad/s)",
                search.tolerance
            );
        }
    }
    let undecided = spans(basin, |c| c.outcome == Some(Outcome::Undecided));
    if !undecided.is_empty() {
        let _ = writeln!(
            text,
            "border undecided at {undecided} m/s: still upright at the time limit, not settled (see --time-limit)"
        );
    }
    let capped = spans(basin, |c| c.capped);
    if !capped.is_empty() {
        let _ = writeln!(text, "nothing fell up to {} rad/s at {capped} m/s", search.max_rate);
    }
    text += &lying(basin, fall);
    for column in &basin.columns {
        for island in &column.islands {
            let _ = writeln!(
                text,
                "island at {} m/s: {:.2} to {:.2} rad/s does not fall either",
                column.speed, island.from, island.to
            );
        }
    }
    let _ = writeln!(
        text,
        "{}, {right_hand_sides} right-hand sides, {seconds:.2} s ({:.0} ns each on {})",
        counted(rides, "ride", "rides"),
        seconds * 1e9 / right_hand_sides.max(1) as f64,
        counted(threads, "thread", "threads")
    );
    text
}

/// Text: the rides laid flat without reaching the angles of a fall, if any.
fn lying(basin: &Basin, fall: &FallCriterion) -> String {
    let mut text = String::new();
    let [flat, quick] = [FallCause::LaidFlat, FallCause::TooQuick].map(|cause| basin.falls(cause));
    if flat > 0 {
        let _ = writeln!(text, "laid flat: {flat} rides of the scan, by {}", laid_flat(fall));
    }
    if quick > 0 {
        let _ = writeln!(
            text,
            "too quick to be followed beside 90 deg of roll, a fall: {quick} rides of the scan"
        );
    }
    let at = spans(basin, |c| matches!(c.beyond, Some(FallCause::LaidFlat | FallCause::TooQuick)));
    if !at.is_empty() {
        let _ = writeln!(text, "beyond the border rides lie flat at {at} m/s");
    }
    text
}

/// Text: at how many of the speeds above 0 where every disturbance falls the linear loop is unstable, with a rider.
fn unstable(basin: &Basin, setup: &Setup) -> String {
    let none = |c: &Column| c.speed > 0.0 && c.upper == 0.0;
    let speeds: Vec<f64> = basin.columns.iter().filter(|c| none(c)).map(|c| c.speed).collect();
    let Some(LoadedRider { table, rider, .. }) = setup.rider.as_ref().filter(|_| !speeds.is_empty()) else {
        return String::new();
    };
    let unstable = unstable_speeds(&setup.parameters, &setup.conditions.assist, rider, &speeds);
    format!(
        "note: height 0 at {} m/s, {}; the linear loop of rider {} with law {} is unstable at {unstable} of them (see sim-host eigen)\n",
        spans(basin, none),
        counted(speeds.len(), "speed", "speeds"),
        table.name,
        setup.config.law.name,
    )
}

/// The speeds of the columns that satisfy `is`, as ranges: "0.9 to 4.1, 7.3 to 10".
fn spans(basin: &Basin, is: impl Fn(&Column) -> bool) -> String {
    let runs = basin.columns.chunk_by(|a, b| is(a) == is(b)).filter(|run| is(&run[0]));
    let text = |run: &[Column]| match run {
        [one] => one.speed.to_string(),
        _ => format!("{} to {}", run[0].speed, run[run.len() - 1].speed),
    };
    runs.map(text).collect::<Vec<_>>().join(", ")
}
