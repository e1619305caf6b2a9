//! `sim-host bicycle accel`: accelerations of the nonlinear bicycle from a table of states.

use super::bicycle_args::BicycleArgs;
use super::outputs::complain;
use super::{Failure, warn};
use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques, pitch_from_upright};
use crate::input_file;
use crate::recording::cut_line;
use crate::report::output::Output;
use std::fmt::Write;
use std::path::PathBuf;

const HELP: &str = "\
IN.csv has the columns roll, steer, roll_rate, steer_rate, rear_wheel_rate, roll_torque, steer_torque \
in any order; rad, rad/s, N m; right positive; rear_wheel_rate negative forward. The table of \
`ride --csv` is accepted as well: without torque columns, roll_torque is 0 and steer_torque the sum of its \
motor_torque and rider_torque. Lines that begin with # are skipped. The output has the \
columns roll_acc, steer_acc, rear_wheel_acc in rad/s^2 with 17 significant digits, line by line.

Example:
  sim-host bicycle accel --bicycle benchmark --states states.csv > accelerations.csv";

/// Options of `bicycle accel`.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(super) struct Args {
    #[command(flatten)]
    which: BicycleArgs,
    /// CSV file of states and torques
    #[arg(long, value_name = "IN.csv")]
    states: PathBuf,
    /// Write to FILE instead of standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    csv: PathBuf,
}

/// The columns, and the largest allowed magnitude of their values.
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
    let bicycle = args.which.load()?;
    warn(&bicycle);
    let output = Output::create(&args.csv)?;
    let file = args.states.display();
    let text = input_file::recorded_text(&args.states).map_err(|e| format!("can't read {file}: {e}"))?;
    let answer =
        accelerations(&Geometry::new(&bicycle.parameters), &text).map_err(|e| format!("{file}: {e}"))?;
    if let Some(remark) = cut_line(&text) {
        complain(&format!("warning: {file}: {remark}"));
    }
    Ok(output.finish(answer.as_bytes())?)
}

/// The table of accelerations for a table of states.
fn accelerations(b: &Geometry, text: &str) -> Result<String, String> {
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let places = Places::new(reader.headers().map_err(|e| e.to_string())?)?;
    let mut answer = String::from("roll_acc,steer_acc,rear_wheel_acc\n");
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let line = record.position().map_or(0, |p| p.line());
        let a = row(b, &places, &record).map_err(|e| format!("line {line}: {e}"))?;
        let _ = writeln!(answer, "{:.16e},{:.16e},{:.16e}", a.roll, a.steer, a.rear_wheel);
    }
    Ok(answer)
}

/// Indices of the columns of a state, and of those whose sum is each torque.
struct Places {
    state: [usize; 5],
    roll_torque: Vec<usize>,
    steer_torque: Vec<usize>,
}

impl Places {
    fn new(header: &csv::StringRecord) -> Result<Self, String> {
        let place = |column: &str| {
            let mut found = header.iter().enumerate().filter(|(_, h)| *h == column).map(|(at, _)| at);
            match (found.next(), found.next()) {
                (_, Some(_)) => Err(format!("column `{column}` is listed twice")),
                (at, None) => Ok(at),
            }
        };
        let needed = |column: &str| {
            place(column)?.ok_or_else(|| {
                let all = COLUMNS.map(|(name, _)| name).join(", ");
                let separator = match header.iter().any(|h| h.contains(';')) {
                    true => "; columns are separated by commas, not by `;`",
                    false => "",
                };
                format!("column `{column}` is missing; expected {all}{separator}")
            })
        };
        let mut state = [0; 5];
        for (at, (column, _)) in state.iter_mut().zip(COLUMNS) {
            *at = needed(column)?;
        }
        // The table of a ride has motor torque and rider torque separately.
        let of_ride = (place("motor_torque")?, place("rider_torque")?);
        let (roll_torque, steer_torque) = match (place("steer_torque")?, of_ride) {
            (None, (Some(motor), Some(rider))) => {
                (place("roll_torque")?.into_iter().collect(), vec![motor, rider])
            }
            _ => (vec![needed("roll_torque")?], vec![needed("steer_torque")?]),
        };
        Ok(Self { state, roll_torque, steer_torque })
    }
}

fn row(b: &Geometry, places: &Places, record: &csv::StringRecord) -> Result<Accelerations<f64>, String> {
    let number = |place: usize, (column, most): (&str, f64)| {
        let cell = record.get(place).unwrap_or("");
        let value = cell.parse().ok().filter(|x: &f64| x.abs() <= most);
        value.ok_or_else(|| format!("`{column}` = `{cell}` is not a number from -{most} to {most}"))
    };
    let mut v = [0.0; 7];
    for ((value, &place), column) in v.iter_mut().zip(&places.state).zip(COLUMNS) {
        *value = number(place, column)?;
    }
    for (i, summed) in [(5, &places.roll_torque), (6, &places.steer_torque)] {
        for &place in summed {
            v[i] += number(place, COLUMNS[i])?;
        }
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
