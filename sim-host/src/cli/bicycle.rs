//! `sim-host bicycle`: list, show, check, accel.

use super::bicycle_args::BicycleArgs;
use super::eigen::stable_line;
use super::outputs::{print, write_json};
use super::{Ended, Failure, accel, warn};
use crate::bicycle::catalogue::{self, Bicycle};
use crate::bicycle::linear::Linear;
use crate::bicycle::uncertain::Measured;
use crate::bicycle::{Geometry, KEYS, onboard};
use crate::commands::CommandError;
use crate::eigen::{Feedback, Model, Stability, stability};
use crate::plant::ImuMount;
use crate::report::document::CheckDocument;
use crate::report::output::Output;
use crate::report::resolved::ResolvedBicycle;
use crate::report::tool::{SCHEMA, Tool};
use control::{Capsize, Config, Law};
use nalgebra::Matrix2;
use std::fmt::Write;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  sim-host bicycle list
  sim-host bicycle show --bicycle benchmark > my.toml
  sim-host bicycle check --bicycle my.toml";

const SHOW_HELP: &str = "\
The output is a file for --bicycle; with --ini its name must end in .txt.

Examples:
  sim-host bicycle show --bicycle benchmark > my.toml
  sim-host bicycle show --bicycle benchmark --ini > MyBenchmark.txt";

const CHECK_HELP: &str = "\
Examples:
  sim-host bicycle check --bicycle my.toml
  sim-host bicycle check --bicycle benchmark --json";

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// The built-in bicycles with their weave and capsize speeds
    #[command(after_help = "Example:\n  sim-host bicycle list")]
    List,
    /// One bicycle's parameters
    #[command(after_help = SHOW_HELP)]
    Show {
        #[command(flatten)]
        which: BicycleArgs,
        /// In the format of BicycleParameters: remarks after #, values and deviations without quotation marks
        #[arg(long)]
        ini: bool,
    },
    /// Checks a bicycle; prints its linear model M, C1, K0, K2 and critical speeds
    #[command(after_help = CHECK_HELP)]
    Check {
        #[command(flatten)]
        which: BicycleArgs,
        /// Write JSON to FILE, or to standard output (also -)
        #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
        json: Option<PathBuf>,
    },
    /// Accelerations of the nonlinear bicycle at given states
    Accel(accel::Args),
}

pub(super) fn run(command: &Command) -> Result<Ended, Failure> {
    match command {
        Command::List => list()?,
        Command::Show { which, ini } => show(&which.load()?, *ini)?,
        Command::Check { which, json } => check(&which.load()?, json.as_ref())?,
        Command::Accel(args) => accel::run(args)?,
    }
    Ok(Ended::Done)
}

fn list() -> Result<(), Failure> {
    let mut text = String::new();
    for name in catalogue::shipped_names() {
        let bicycle = catalogue::load(&name)?;
        let Stability { critical: c, ranges, .. } = uncontrolled(&bicycle)?;
        let ranges: Vec<String> = ranges.iter().map(|(from, to)| format!("{from:.3} to {to:.3}")).collect();
        let ranges = if ranges.is_empty() { "nowhere".into() } else { ranges.join(", ") };
        let speed = |v: Option<f64>| v.map_or("  none".into(), |v| format!("{v:6.3}"));
        let _ = writeln!(
            text,
            "{name:24} v_w {}  v_c {} m/s  stable {:16}  {}",
            speed(c.v_w),
            speed(c.v_c),
            ranges,
            bicycle.source.as_deref().unwrap_or("")
        );
    }
    print(&text)
}

/// Stability of the uncontrolled bicycle.
fn uncontrolled(bicycle: &Bicycle) -> Result<Stability, Failure> {
    let model = Model::new(&bicycle.parameters, Feedback::new(Law::None, Capsize::default()), None);
    stability(&model).ok_or_else(|| format!("{}: {}", bicycle.name, CommandError::NoEigenvalue).into())
}

fn show(bicycle: &Bicycle, ini: bool) -> Result<(), Failure> {
    let Tool { name: tool, version, commit } = Tool::this();
    let mut text = format!("# {tool} {version} commit {commit}, bicycle {}\n", bicycle.name);
    let (remark, quote) = if ini { ("# ", "") } else { ("", "\"") };
    for (key, words) in [("source", &bicycle.source), ("note", &bicycle.note)] {
        if let Some(words) = words {
            let _ = writeln!(text, "{remark}{key} = {}", toml::Value::from(words.as_str()));
        }
    }
    if let Some(included) = bicycle.rider_included {
        let _ = writeln!(text, "{remark}rider_included = {included}");
    }
    bicycle.warnings.iter().for_each(|warning| text += &format!("# warning: {warning}\n"));
    let deviations = bicycle.measured.as_ref().map_or([0.0; KEYS.len()], Measured::deviations);
    for ((key, value), sd) in KEYS.iter().zip(bicycle.parameters.to_values()).zip(deviations) {
        let _ = match sd > 0.0 {
            true => writeln!(text, "{key} = {quote}{value:?}+/-{sd:?}{quote}"),
            false => writeln!(text, "{key} = {value:?}"),
        };
    }
    print(&text)
}

fn check(bicycle: &Bicycle, json: Option<&PathBuf>) -> Result<(), Failure> {
    warn(bicycle);
    let linear = Linear::new(&bicycle.parameters);
    let Stability { critical: c, ranges, changes } = uncontrolled(bicycle)?;
    let flashed_off = onboard::fit(
        &mut Config::product(),
        &Geometry::new(&bicycle.parameters),
        ImuMount::default().point_m,
    );
    let rows = |m: &Matrix2<f64>| [[m[(0, 0)], m[(0, 1)]], [m[(1, 0)], m[(1, 1)]]];
    let document = CheckDocument {
        schema: SCHEMA,
        tool: Tool::this(),
        bicycle: ResolvedBicycle::new(bicycle),
        M: rows(&linear.m),
        C1: rows(&linear.c1),
        K0: rows(&linear.k0),
        K2: rows(&linear.k2),
        v_d: c.v_d,
        v_w: c.v_w,
        v_c: c.v_c,
        stable_ranges: ranges.iter().map(|&(from, to)| [from, to]).collect(),
        stability_changes: changes,
        flashed_off,
    };
    if let Some(path) = json {
        return write_json(&Output::create(path)?, &document);
    }
    let verdict = if bicycle.warnings.is_empty() { "sound" } else { "doubtful" };
    let mut text = format!("{}: {verdict}\n", bicycle.name);
    match bicycle.rider_included {
        Some(true) => text += "with a rider's body\n",
        Some(false) => text += "without a rider's body\n",
        None => {}
    }
    let uncertain = document.bicycle.uncertainties.len();
    if uncertain > 0 {
        let _ = writeln!(
            text,
            "{uncertain} of {} values have an uncertainty; `basin --uncertain N` rides N draws",
            KEYS.len()
        );
    }
    for (label, m) in [("M", document.M), ("C1", document.C1), ("K0", document.K0), ("K2", document.K2)] {
        let [[a, b], [c, d]] = m;
        let _ = writeln!(text, "{label:2} = [[{a:.6}, {b:.6}], [{c:.6}, {d:.6}]]");
    }
    for (label, speed) in [("v_d", c.v_d), ("v_w", c.v_w), ("v_c", c.v_c)] {
        let _ = writeln!(text, "{label} = {}", speed.map_or("none".into(), |v| format!("{v:.6} m/s")));
    }
    text += &stable_line(&ranges);
    for reason in &document.flashed_off {
        let _ = writeln!(text, "on the flashed code (--preset product) {reason}");
    }
    print(&text)
}
