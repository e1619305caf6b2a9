//! `sim-host eigen`: eigenvalues over speed and critical speeds.

use super::options::{Bicycle as BicycleOptions, Options, Rider as RiderOptions};
use super::outputs::{Further, OutputArgs, Results, complain, complain_once};
use super::scenario_error::failure;
use super::{Ended, Failure, interrupt, warn};
use crate::commands::eigen::{EigenTask, Eigenvalues, eigen_until};
use crate::eigen::{CriticalSpeeds, LinearActuator, Mode, Stability};
use crate::range::{TimeError, time};
use crate::report::figure::{self, EigenFigure};
use crate::report::{table, terminal};
use crate::scenario::{Scenario, law, speeds};
use control::Capsize;
use nalgebra::Complex;
use serde_json::json;
use std::fmt::Write;

const EXAMPLES: &str = "\
Examples:
  sim-host eigen --bicycle benchmark
  sim-host eigen --law h --speeds 0:10:0.05 --svg eigen.svg
  sim-host eigen --law cl2:4 --json
  sim-host eigen --law balance-assist:5.2 --bicycle balanceassistv1
  sim-host eigen --bicycle benchmark --capsize 0.7:6.5
  sim-host eigen --law h --actuator-lag 20ms --steer-friction 0.34 --modes --csv motor.csv
  sim-host eigen --rider smart --law h --speeds 2:7.5:0.1 --json
  sim-host eigen --law cl1 --modes --csv modes.csv";

/// Options of `eigen`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    #[command(flatten)]
    bicycle: Options<BicycleOptions>,
    /// Roll-rate law: none, h, h-cut, f, g, cl1, cl2:K, balance-assist:K, or a table FILE
    #[arg(long, default_value = "none")]
    law: String,
    /// Added capsize term: torque into the lean of K (v - V) times the roll angle above the speed V in m/s
    #[arg(long, value_name = "K:V", value_parser = law::capsize, allow_hyphen_values = true)]
    capsize: Option<Capsize>,
    #[command(flatten)]
    actuator: ActuatorArgs,
    #[command(flatten)]
    rider: Options<RiderOptions>,
    /// Forward speeds in m/s: A:B:STEP, B included, or one; below 0 (backwards, as with a steered rear wheel) without
    /// law and rider
    #[arg(long, default_value = "0:10:0.1", value_parser = speeds::parse_signed, value_name = "A:B:STEP", allow_hyphen_values = true)]
    speeds: std::vec::Vec<f64>,
    /// With a rider or a delay: number of rightmost eigenvalues, 4 to 40 [default: 12]; otherwise there are four, or five
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(4..=40))]
    roots: Option<u8>,
    /// Adds the modes to the table of --csv
    #[arg(long, requires = "csv")]
    modes: bool,
    #[command(flatten)]
    outputs: OutputArgs,
}

/// Actuator between the law and the steer axis.
#[derive(clap::Args)]
struct ActuatorArgs {
    /// Delay from the command to the drive, for example 5ms; not with --rider
    #[arg(long, value_name = "TIME", default_value = "0ms", value_parser = second, allow_hyphen_values = true)]
    actuator_delay: f64,
    /// Time constant of the torque's first-order response, for example 20ms
    #[arg(long, value_name = "TIME", default_value = "0ms", value_parser = second, allow_hyphen_values = true)]
    actuator_lag: f64,
    /// Viscous friction about the steer axis, in N m s/rad
    #[arg(long, value_name = "NMS/RAD", default_value_t = 0.0, allow_negative_numbers = true)]
    steer_friction: f64,
    /// Inertia added about the steer axis, in kg m^2: a rotor's times the gear ratio squared
    #[arg(long, value_name = "KGM2", default_value_t = 0.0, allow_negative_numbers = true)]
    steer_inertia: f64,
}

fn second(text: &str) -> Result<f64, TimeError> {
    time(text, 1.0)
}

impl ActuatorArgs {
    fn actuator(&self) -> LinearActuator {
        LinearActuator {
            delay_s: self.actuator_delay,
            time_constant_s: self.actuator_lag,
            viscous_nm_s_rad: self.steer_friction,
            inertia_kg_m2: self.steer_inertia,
            ..LinearActuator::default()
        }
    }
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let bicycle = args.bicycle.bicycle()?;
    warn(&bicycle);
    let task = EigenTask {
        bicycle,
        rider: args.rider.rider()?,
        law: (args.law.clone(), law::parse(&args.law)?),
        capsize: args.capsize,
        actuator: args.actuator.actuator(),
        speeds: args.speeds.clone(),
        roots: args.roots.map(usize::from),
    };
    let outputs = args.outputs.open(Further::default())?;
    interrupt::install_saying("nothing is written");
    let found = eigen_until(&task, &interrupt::stopped).map_err(|e| failure(&Scenario::default(), e))?;
    let Some(found) = found else { return Ok(Ended::Interrupted) };
    let Eigenvalues { document, count, values, modes, stability } = found;
    let Stability { critical, ranges, .. } = stability;
    document.warnings.iter().for_each(|doubt| complain_once(&format!("warning: {doubt}")));
    if let Some((n, v)) =
        values.iter().map(Vec::len).zip(&args.speeds).filter(|(n, _)| *n < count).min_by_key(|x| x.0)
    {
        complain(&format!(
            "note: --roots {count}: {n} of them at {v} m/s; those further left decay too quickly to be distinguished"
        ));
    }
    let rider = document.rider.as_ref().map_or(String::new(), |r| format!(", {}", r.label()));
    let turned = document.actuator.map_or("", |_| ", actuator");
    let beside = args.capsize.map_or(String::new(), |c| format!(" and capsize {}:{}", c.k_c, c.v_max_m_s));
    let title = format!("Eigenvalues: {}{rider}, law {}{beside}{turned}", task.bicycle.name, args.law);
    let figure =
        EigenFigure { speeds: &args.speeds, modes: &modes, stable: &ranges, critical, title: &title };
    let config = json!({"bicycle": document.bicycle, "rider": document.rider, "warnings": document.warnings, "law": document.law, "capsize": document.capsize,
        "actuator": document.actuator});
    let in_table = if args.modes { &modes[..] } else { &[] };
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || {
            terminal::eigen(&figure, 80) + &summary(&critical, &ranges, args.speeds.iter().any(|v| *v < 0.0))
        },
        table: || {
            table::rows(&config, &columns(count, in_table), rows(&args.speeds, &values, count, in_table))
        },
        figure: || figure::eigen(&figure),
    })?;
    Ok(Ended::Done)
}

/// Columns of the table: the speed, the rightmost eigenvalues, the modes.
fn columns(count: usize, modes: &[Mode]) -> Vec<String> {
    let numbered = |name: &str, n: usize| {
        let name = name.replace(' ', "_");
        (1..=n).flat_map(|i| [format!("{name}re{i}"), format!("{name}im{i}")]).collect::<Vec<_>>()
    };
    let of_modes = modes.iter().flat_map(|mode| numbered(&format!("{}_", mode.name), mode.roots.len()));
    ["speed_m_s".into()].into_iter().chain(numbered("", count)).chain(of_modes).collect()
}

fn rows(
    speeds: &[f64],
    values: &[Vec<Complex<f64>>],
    count: usize,
    modes: &[Mode],
) -> impl Iterator<Item = Vec<Option<f64>>> {
    let both = |root: Option<Complex<f64>>| [root.map(|e| e.re), root.map(|e| e.im)];
    (0..speeds.len()).map(move |i| {
        let rightmost = (0..count).map(|n| values[i].get(n).copied());
        let of_modes = modes.iter().flat_map(|mode| &mode.roots).map(|root| root[i]);
        [Some(speeds[i])].into_iter().chain(rightmost.chain(of_modes).flat_map(both)).collect()
    })
}

fn summary(critical: &CriticalSpeeds, stable: &[(f64, f64)], backwards: bool) -> String {
    let mut text = if backwards { "riding forward:\n".into() } else { String::new() };
    for (name, what, speed) in [
        ("v_d", "weave pair forms", critical.v_d),
        ("v_w", "weave becomes stable", critical.v_w),
        ("v_c", "capsize becomes unstable", critical.v_c),
    ] {
        let _ = match speed {
            Some(v) => writeln!(text, "{name} = {v:.4} m/s ({what})"),
            None => writeln!(text, "{name}: none up to {} m/s ({what})", crate::eigen::SEARCH_TO_M_S),
        };
    }
    text + &stable_line(stable)
}

/// The stable ranges of speed, in a line.
pub(super) fn stable_line(stable: &[(f64, f64)]) -> String {
    let ranges: Vec<String> = stable.iter().map(|(from, to)| format!("{from:.4} to {to:.4} m/s")).collect();
    let ranges = if ranges.is_empty() { "nowhere".into() } else { ranges.join(", ") };
    format!("stable: {ranges} (searched up to {} m/s)\n", crate::eigen::SEARCH_TO_M_S)
}
