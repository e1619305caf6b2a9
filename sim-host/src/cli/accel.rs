//! `sim-host bicycle accel`.

use super::{Failure, warn};
use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques, catalogue, pitch_from_upright};
use crate::report::output::Output;
use std::fmt::Write;
use std::path::PathBuf;

const HELP: &str = "\
IN.csv has the columns roll, steer, roll_rate, steer_rate, rear_wheel_rate, roll_torque, steer_torque
in any order; rad, rad/s, N m; right positive; rear_wheel_rate negative forward. The answer has the
columns roll_acc, steer_acc, rear_wheel_acc in rad/s^2 with 17 significant digits, line by line.

Example:
  sim-host bicycle accel --bicycle benchmark --states states.csv > accelerations.csv";

/// Options of `bicycle accel`.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(super) struct Args {
    /// Shipped bicycle, FILE, or FILE#NAME
    #[arg(long, default_value = "rigid_jason", value_name = "NAME|FILE")]
    bicycle: String,
    /// CSV file of states and torques
    #[arg(long, value_name = "IN.csv")]
    states: PathBuf,
    /// Write to FILE instead of standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    csv: PathBuf,
}

/// The columns, and how large their values may be either way.
const COLUMNS: [(&str, f64); 7] = [
    ("roll", 10.0),
    ("steer", 10.0),
    ("roll_rate", 1e4),
    ("steer_rate", 1e4),
    ("rear_wheel_rate", 1e4),
    ("roll_torque", 1e6),
    ("steer_torque", 1e6),
];

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let bicycle = catalogue::load(&args.bicycle)?;
    warn(&bicycle);
    let output = Output::create(&args.csv)?;
    let file = args.states.display();
    let text = std::fs::read_to_string(&args.states).map_err(|e| format!("can't read {file}: {e}"))?;
    let answer =
        accelerations(&Geometry::new(&bicycle.parameters), &text).map_err(|e| format!("{file}: {e}"))?;
    Ok(output.finish(answer.as_bytes())?)
}

/// The answer to a table of states.
fn accelerations(b: &Geometry, text: &str) -> Result<String, String> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let places = places(reader.headers().map_err(|e| e.to_string())?)?;
    let mut answer = String::from("roll_acc,steer_acc,rear_wheel_acc\n");
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let line = record.position().map_or(0, |p| p.line());
        let a = row(b, &places, &record).map_err(|e| format!("line {line}: {e}"))?;
        let _ = writeln!(answer, "{:.16e},{:.16e},{:.16e}", a.roll, a.steer, a.rear_wheel);
    }
    Ok(answer)
}

/// Where in a line the columns stand.
fn places(header: &csv::StringRecord) -> Result<[usize; 7], String> {
    let mut places = [0; 7];
    for (place, (column, _)) in places.iter_mut().zip(COLUMNS) {
        let mut found = header.iter().enumerate().filter(|(_, h)| *h == column);
        let Some((at, _)) = found.next() else {
            let all = COLUMNS.map(|(name, _)| name).join(", ");
            return Err(format!("column `{column}` is missing; expected {all}"));
        };
        if found.next().is_some() {
            return Err(format!("column `{column}` is there twice"));
        }
        *place = at;
    }
    Ok(places)
}

fn row(b: &Geometry, places: &[usize; 7], record: &csv::StringRecord) -> Result<Accelerations<f64>, String> {
    let mut v = [0.0; 7];
    for ((value, &place), (column, most)) in v.iter_mut().zip(places).zip(COLUMNS) {
        let cell = record.get(place).unwrap_or("");
        *value = cell
            .parse()
            .ok()
            .filter(|x: &f64| x.abs() <= most)
            .ok_or_else(|| format!("`{column}` = `{cell}` is not a number from -{most} to {most}"))?;
    }
    let [roll, steer, roll_rate, steer_rate, rear_wheel_rate, roll_torque, steer_torque] = v;
    let pitch = pitch_from_upright(b, roll, steer).ok_or_else(|| {
        format!("at roll {roll} and steer {steer} rad the front wheel can't touch the ground")
    })?;
    let state = State { roll, steer, roll_rate, steer_rate, rear_wheel_rate, pitch };
    let a = Motion::new(b, &state).accelerations(b, &Torques { roll: roll_torque, steer: steer_torque });
    if [a.roll, a.steer, a.rear_wheel].iter().all(|x| x.is_finite()) {
        Ok(a)
    } else {
        Err(format!("at roll {roll} and steer {steer} rad the bicycle has no finite accelerations"))
    }
}
