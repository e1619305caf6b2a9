//! `sim-host bicycle`: list, show, check, accel.

use super::outputs::print;
use super::{Ended, Failure};
use crate::bicycle::linear::Linear;
use crate::bicycle::{Geometry, Motion, State, Torques, catalogue, pitch_from_upright};
use crate::eigen::critical_speeds;
use crate::report::document::{CheckDocument, SCHEMA};
use crate::report::output::Output;
use crate::report::resolved::{ResolvedBicycle, Tool};
use control::Law;
use nalgebra::Matrix2;
use std::fmt::Write;
use std::path::PathBuf;

const ACCEL_HELP: &str = "\
IN.csv has the columns roll, steer, roll_rate, steer_rate, rear_wheel_rate, roll_torque, steer_torque
in any order (rad, rad/s, N m; right positive; rear_wheel_rate negative forward). The answer has the
columns roll_acc, steer_acc, rear_wheel_acc (rad/s^2) with 17 significant digits, line by line.

Example:
  sim-host bicycle accel --bicycle benchmark --states states.csv > accelerations.csv";

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// The bicycles that ship
    List,
    /// One bicycle's parameters
    Show {
        /// Shipped bicycle, FILE, or FILE#NAME
        #[arg(long, default_value = "rigid_jason", value_name = "NAME|FILE")]
        bicycle: String,
    },
    /// Checks a bicycle; prints its linear model M, C1, K0, K2 and critical speeds
    Check {
        /// Shipped bicycle, FILE, or FILE#NAME
        #[arg(long, default_value = "rigid_jason", value_name = "NAME|FILE")]
        bicycle: String,
        /// Write JSON to FILE, or to standard output
        #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
        json: Option<PathBuf>,
    },
    /// Accelerations of the nonlinear bicycle at given states
    #[command(after_help = ACCEL_HELP)]
    Accel {
        /// Shipped bicycle, FILE, or FILE#NAME
        #[arg(long, default_value = "rigid_jason", value_name = "NAME|FILE")]
        bicycle: String,
        /// CSV file of states and torques
        #[arg(long, value_name = "IN.csv")]
        states: PathBuf,
        /// Write to FILE instead of standard output
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
    },
}

pub(super) fn run(command: &Command) -> Result<Ended, Failure> {
    match command {
        Command::List => list()?,
        Command::Show { bicycle } => show(bicycle)?,
        Command::Check { bicycle, json } => check(bicycle, json.as_ref())?,
        Command::Accel { bicycle, states, csv } => accel(bicycle, states, csv.as_ref())?,
    }
    Ok(Ended::Done)
}

fn list() -> Result<(), Failure> {
    let mut text = String::new();
    for name in catalogue::shipped_names() {
        let bicycle = catalogue::load(&name)?;
        let c = critical_speeds(&Linear::new(&bicycle.parameters), &Law::None);
        let speed = |v: Option<f64>| v.map_or("  none".into(), |v| format!("{v:6.3}"));
        let _ = writeln!(
            text,
            "{name:24} v_w {}  v_c {} m/s  {}",
            speed(c.v_w),
            speed(c.v_c),
            bicycle.source.as_deref().unwrap_or("")
        );
    }
    Ok(print(&text)?)
}

fn show(name: &str) -> Result<(), Failure> {
    let bicycle = catalogue::load(name)?;
    let mut text = String::new();
    for (key, remark) in [("source", &bicycle.source), ("note", &bicycle.note)] {
        if let Some(remark) = remark {
            let _ = writeln!(text, "{key} = {remark:?}");
        }
    }
    for (key, value) in crate::bicycle::KEYS.iter().zip(bicycle.parameters.to_values()) {
        let _ = writeln!(text, "{key} = {value:?}");
    }
    Ok(print(&text)?)
}

fn check(name: &str, json: Option<&PathBuf>) -> Result<(), Failure> {
    let bicycle = catalogue::load(name)?;
    for warning in &bicycle.warnings {
        eprintln!("warning: {name}: {warning}");
    }
    let linear = Linear::new(&bicycle.parameters);
    let c = critical_speeds(&linear, &Law::None);
    let rows = |m: &Matrix2<f64>| [[m[(0, 0)], m[(0, 1)]], [m[(1, 0)], m[(1, 1)]]];
    let document = CheckDocument {
        schema: SCHEMA,
        tool: Tool::this(),
        bicycle: ResolvedBicycle::new(&bicycle),
        M: rows(&linear.m),
        C1: rows(&linear.c1),
        K0: rows(&linear.k0),
        K2: rows(&linear.k2),
        v_d: c.v_d,
        v_w: c.v_w,
        v_c: c.v_c,
    };
    if let Some(path) = json {
        let text = serde_json::to_string_pretty(&document)? + "\n";
        if path.as_os_str() == "-" {
            return Ok(print(&text)?);
        }
        return Ok(Output::create(path)?.finish(text.as_bytes())?);
    }
    let mut text = format!("{name}: sound\n");
    for (label, m) in [("M", document.M), ("C1", document.C1), ("K0", document.K0), ("K2", document.K2)] {
        let [[a, b], [c, d]] = m;
        let _ = writeln!(text, "{label:2} = [[{a:.6}, {b:.6}], [{c:.6}, {d:.6}]]");
    }
    for (label, speed) in [("v_d", c.v_d), ("v_w", c.v_w), ("v_c", c.v_c)] {
        let _ = writeln!(text, "{label} = {}", speed.map_or("none".into(), |v| format!("{v:.6} m/s")));
    }
    Ok(print(&text)?)
}

const COLUMNS: [&str; 7] =
    ["roll", "steer", "roll_rate", "steer_rate", "rear_wheel_rate", "roll_torque", "steer_torque"];

fn accel(name: &str, states: &PathBuf, csv: Option<&PathBuf>) -> Result<(), Failure> {
    let b = Geometry::new(&catalogue::load(name)?.parameters);
    let output = csv.map(|path| Output::create(path)).transpose()?;
    let file = states.display();
    let text = std::fs::read_to_string(states).map_err(|e| format!("can't read {file}: {e}"))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers()?.clone();
    let mut places = [0; 7];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = header.iter().position(|h| h == column).ok_or_else(|| {
            format!("{file}: column `{column}` is missing; expected {}", COLUMNS.join(", "))
        })?;
    }
    let mut answer = String::from("roll_acc,steer_acc,rear_wheel_acc\n");
    for record in reader.records() {
        let record = record.map_err(|e| format!("{file}: {e}"))?;
        let line = record.position().map_or(0, |p| p.line());
        let mut v = [0.0; 7];
        for ((value, &place), column) in v.iter_mut().zip(&places).zip(COLUMNS) {
            let cell = record.get(place).unwrap_or("");
            *value = cell.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
                format!("{file}, line {line}: `{column}` = `{cell}` is not a finite number")
            })?;
        }
        let pitch = pitch_from_upright(&b, v[0], v[1]).ok_or_else(|| {
            format!(
                "{file}, line {line}: at roll {} and steer {} rad the front wheel can't touch the ground",
                v[0], v[1]
            )
        })?;
        let state = State {
            roll: v[0],
            steer: v[1],
            roll_rate: v[2],
            steer_rate: v[3],
            rear_wheel_rate: v[4],
            pitch,
        };
        let a = Motion::new(&b, &state).accelerations(&b, &Torques { roll: v[5], steer: v[6] });
        let _ = writeln!(answer, "{:.16e},{:.16e},{:.16e}", a.roll, a.steer, a.rear_wheel);
    }
    match output {
        Some(file) => Ok(file.finish(answer.as_bytes())?),
        None => Ok(print(&answer)?),
    }
}
