//! `sim-host rider`: list, show, check, merge.

use super::outputs::{print, write_json};
use super::{Ended, Failure};
use crate::commands::linear_loop::unstable_speeds;
use crate::counted::counted;
use crate::report::output::Output;
use crate::report::rider::{FitEntry, RiderDocument, gain_rows, standard_errors};
use crate::report::table;
use crate::report::tool::Tool;
use crate::ride::Assist;
use crate::rider::{Fit, KEYS, Outside, RiderTable, catalogue, merge};
use crate::scenario::Scenario;
use serde_json::json;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  sim-host rider list
  sim-host rider show young
  sim-host rider show smart --gains regression --json
  sim-host rider check my-rider.toml
  sim-host rider merge run1.toml run2.toml run3.toml --out rider.toml";

const SHOW_HELP: &str = "\
The output is a file for --rider; its comments contain the fits over speed.

Examples:
  sim-host rider show young > my-rider.toml
  sim-host rider show smart --gains regression --json
  sim-host rider show hess --csv hess.csv";

const MERGE_HELP: &str = "\
The files' own groups, best_runs, regression and note are left out; gains, delay, neuromuscular \
dynamics and bicycle must agree.

Examples:
  sim-host rider merge run1.toml run2.toml run3.toml --out rider.toml
  sim-host rider merge slow.toml fast.toml --group-within 0.5 > rider.toml";

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// The built-in riders
    #[command(after_help = "Example:\n  sim-host rider list")]
    List,
    /// One rider's gains, their fits over speed and the coefficients of determination (R^2)
    #[command(after_help = SHOW_HELP)]
    Show(ShowArgs),
    /// Checks a rider's table
    #[command(after_help = "Example:\n  sim-host rider check my-rider.toml")]
    Check {
        /// Built-in rider or FILE
        #[arg(value_name = "NAME|FILE")]
        rider: String,
    },
    /// One table from several with the same gains and delay: their rows, grouped by speed
    #[command(after_help = MERGE_HELP)]
    Merge(MergeArgs),
}

#[derive(clap::Args)]
pub(super) struct MergeArgs {
    /// Riders' files, or built-in riders
    #[arg(value_name = "NAME|FILE", required = true)]
    riders: Vec<String>,
    /// A group takes rows up to this much faster than its slowest [m/s]
    #[arg(long, value_name = "M_S", default_value_t = 0.3)]
    group_within: f64,
    /// Write the table to FILE; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
}

#[derive(clap::Args)]
pub(super) struct ShowArgs {
    /// Built-in rider or FILE
    #[arg(value_name = "NAME|FILE")]
    rider: String,
    /// Only this fit of the gains over speed [default: all that the table allows]
    #[arg(long)]
    gains: Option<Fit>,
    /// Write JSON to FILE, or to standard output (also -)
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// Write a CSV table; - is standard output
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

pub(super) fn run(command: &Command) -> Result<Ended, Failure> {
    match command {
        Command::List => list()?,
        Command::Show(args) => show(args)?,
        Command::Check { rider } => check(rider)?,
        Command::Merge(args) => merged(args)?,
    }
    Ok(Ended::Done)
}

/// Sets, groups, speeds, delay and neuromuscular dynamics in a line.
fn summary(t: &RiderTable) -> String {
    let (first, last) = (&t.rows[0], &t.rows[t.rows.len() - 1]);
    format!(
        "{} in {}, {} to {} m/s, delay {} ms, muscles {:.3} rad/s, {:.3}",
        counted(t.rows.len(), "set", "sets"),
        counted(t.groups().count(), "group", "groups"),
        first.speed_m_s,
        last.speed_m_s,
        (t.delay_s * 1e9).round() / 1e6,
        t.neuromuscular.omega_rad_s,
        t.neuromuscular.zeta
    )
}

fn list() -> Result<(), Failure> {
    let mut text = String::new();
    for name in catalogue::shipped_names() {
        let table = catalogue::load(name)?;
        let source = table.source.as_deref().unwrap_or("");
        let _ = writeln!(text, "{name:19} {}\n{:19} {source}", summary(&table), "");
    }
    print(&text)
}

/// The fits of a table: the requested one, which must be possible, or all possible ones.
fn fits(table: &RiderTable, requested: Option<Fit>) -> Result<Vec<Fit>, Failure> {
    let possible = |fit: &Fit| table.schedule(*fit, Outside::default());
    if let Some(fit) = requested {
        possible(&fit).map_err(|e| format!("rider `{}`, gains {}: {e}", table.name, fit.name()))?;
        return Ok(vec![fit]);
    }
    Ok(Fit::ALL.into_iter().filter(|fit| possible(fit).is_ok()).collect())
}

fn show(args: &ShowArgs) -> Result<(), Failure> {
    let table = catalogue::load(&args.rider)?;
    let fits = fits(&table, args.gains)?;
    let entries = fits.iter().map(|fit| FitEntry::new(&table, *fit)).collect::<Result<Vec<_>, _>>()?;
    let open = |path: &Option<PathBuf>| path.as_deref().map(Output::create).transpose();
    let (json, csv) = (open(&args.json)?, open(&args.csv)?);
    if json.as_ref().zip(csv.as_ref()).is_some_and(|(json, csv)| json.collides(csv)) {
        return Err("--json and --csv have the same place to write to".into());
    }
    if let Some(output) = &csv {
        let config = json!({"rider": table.name, "delay_s": table.delay_s, "muscles": table.neuromuscular});
        output.finish(&table::table(&config, &gain_rows(&table, &fits)?)?)?;
    }
    if let Some(output) = &json {
        write_json(output, &RiderDocument::new(&table, entries.clone()))?;
    }
    if json.is_some() || csv.is_some() {
        return Ok(());
    }
    let Tool { name: tool, version, commit } = Tool::this();
    let mut text = format!("# {tool} {version} commit {commit}, rider {}\n{}", table.name, table.to_toml());
    errors(&mut text, &table);
    for entry in &entries {
        comment(&mut text, entry, &table.columns);
    }
    print(&text)
}

/// Standard errors of the measured gains as comment lines, if there are any.
fn errors(text: &mut String, table: &RiderTable) {
    if table.rows.iter().all(|row| row.covariance.is_none()) {
        return;
    }
    let _ = writeln!(text, "\n# measured gains +/- standard error");
    for row in &table.rows {
        let errors = standard_errors(table, row);
        let gain = |&i: &usize| match &errors {
            Some(errors) => {
                let digits = decimals(errors[KEYS[i]]).max(2);
                format!(
                    "  {} {:.*} +/- {:.*}",
                    KEYS[i],
                    digits.max(4),
                    row.gains.0[i],
                    digits,
                    errors[KEYS[i]]
                )
            }
            None => format!("  {} {:.4}", KEYS[i], row.gains.0[i]),
        };
        let run = row.run.map_or(String::new(), |run| format!(", run {run}"));
        let gains: String = table.columns.iter().map(gain).collect();
        let _ = writeln!(text, "# {} m/s{run}:{gains}", row.speed_m_s);
    }
}

/// Decimals that show two significant digits of a positive number.
fn decimals(x: f64) -> usize {
    if x > 0.0 { (1.0 - libm::floor(libm::log10(x))).clamp(0.0, 12.0) as usize } else { 0 }
}

/// A fit as comment lines.
fn comment(text: &mut String, fit: &FitEntry, columns: &[usize]) {
    let keys: Vec<&str> = columns.iter().map(|&i| KEYS[i]).collect();
    let _ = writeln!(text, "\n# gains {}", fit.gains);
    // Eight intervals of a spline's many.
    let every = if fit.spline.is_some() { fit.points.len().div_ceil(9) } else { 1 };
    let speeds: String = fit.points.iter().step_by(every).map(|p| format!(" {:9.3}", p.speed_m_s)).collect();
    let _ = writeln!(text, "# at m/s    {speeds}        R^2{}", fit.line.as_ref().map_or("", |_| "   line"));
    for key in keys {
        let values: String =
            fit.points.iter().step_by(every).map(|p| format!(" {:9.3}", p.gains[key])).collect();
        let r_squared = fit.r_squared[key].map_or("       none".into(), |r| format!("{r:11.3}"));
        let line = fit.line.as_ref().map_or(String::new(), |line| {
            let (slope, rest) = line[key];
            format!("   {slope:.4} v {} {:.4}", if rest < 0.0 { '-' } else { '+' }, rest.abs())
        });
        let _ = writeln!(text, "# {key:10}{values}{r_squared}{line}");
        if let Some(spline) = &fit.spline {
            let error = |errors: &BTreeMap<_, Option<f64>>| {
                errors[key]
                    .map_or("      none".into(), |error| format!(" {error:9.*}", decimals(error).max(3)))
            };
            let errors: String = spline.standard_errors.iter().step_by(every).map(error).collect();
            let _ = writeln!(
                text,
                "#       +/-{errors}   {:.2} degrees of freedom",
                spline.degrees_of_freedom[key]
            );
        }
    }
}

fn merged(args: &MergeArgs) -> Result<(), Failure> {
    let tables = args.riders.iter().map(|name| catalogue::load(name)).collect::<Result<Vec<_>, _>>()?;
    let name = args.out.display().to_string();
    let table = merge(&name, &tables, args.group_within)?;
    // Groups' means too close for a schedule are rejected before the file is written.
    table.schedule(Fit::Mean, Outside::default()).map_err(|e| format!("means of groups: {e}"))?;
    let Tool { name: tool, version, commit } = Tool::this();
    let comment = format!("# {tool} {version} commit {commit}, rider merge\n");
    Ok(Output::create(&args.out)?.finish((comment + &table.to_toml()).as_bytes())?)
}

fn check(name: &str) -> Result<(), Failure> {
    let table = catalogue::load(name)?;
    let mut text = format!("{name}: sound\n{}\n", summary(&table));
    let made_for =
        table.bicycle.as_deref().map(|name| Scenario { bicycle: name.into(), ..Scenario::default() });
    let bicycle = made_for.unwrap_or_default().load_bicycle();
    let mut speeds: Vec<f64> = table.rows.iter().map(|row| row.speed_m_s).collect();
    speeds.dedup();
    let at = counted(speeds.len(), "speed", "speeds");
    let _ = match &bicycle {
        Ok(bicycle) => {
            writeln!(text, "linear loop on bicycle {}, without a law, at the {at} of the rows:", bicycle.name)
        }
        Err(e) => writeln!(text, "linear loop not computed: {e}"),
    };
    let stability = |fit| {
        let (bicycle, rider) = bicycle.as_ref().ok().zip(table.rider(fit, Outside::default(), None).ok())?;
        Some(match unstable_speeds(&bicycle.parameters, &Assist::None, &rider, &speeds) {
            0 => ", stable".into(),
            unstable => format!(", unstable at {unstable} of {at}"),
        })
    };
    for fit in Fit::ALL {
        let _ = match table.schedule(fit, Outside::default()) {
            Ok(schedule) => {
                let points = counted(schedule.points().len(), "point", "points");
                writeln!(text, "gains {}: {points}{}", fit.name(), stability(fit).unwrap_or_default())
            }
            Err(e) => writeln!(text, "gains {}: not possible: {e}", fit.name()),
        };
    }
    print(&text)
}
