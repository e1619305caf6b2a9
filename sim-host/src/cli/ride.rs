//! `sim-host ride`.

use super::conditions::ConditionArgs;
use super::outputs::{OutputArgs, Results};
use super::{Ended, Failure};
use crate::range::within;
use crate::report::document::RideDocument;
use crate::report::figure::{self, RideFigure};
use crate::report::{table, terminal};
use crate::ride::{Ride, Start, frames, traced};
use control::wire::encode_frame;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  sim-host ride --speed 4 --steer-rate 5
  sim-host ride --law none --speed 6 --steer-rate 1 --svg ride.svg --csv ride.csv
  sim-host ride --rider smart --law h --speed 4 --steer-rate 5
  sim-host ride --preset product --speed 3 --roll-rate 0.5 --json";

/// Options of `ride`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    #[command(flatten)]
    conditions: ConditionArgs,
    /// Forward speed at the start, in m/s
    #[arg(long, value_name = "M/S", allow_negative_numbers = true)]
    speed: f64,
    /// Steer rate at the start, in rad/s, right positive
    #[arg(long, default_value_t = 0.0, value_name = "RAD/S", allow_negative_numbers = true)]
    steer_rate: f64,
    /// Roll rate at the start, in rad/s, right positive
    #[arg(long, default_value_t = 0.0, value_name = "RAD/S", allow_negative_numbers = true)]
    roll_rate: f64,
    /// Write the sensor frames as the firmware got them, 81 bytes each, for replay on the chip
    #[arg(long, value_name = "FILE")]
    frames: Option<PathBuf>,
    #[command(flatten)]
    outputs: OutputArgs,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    within("--speed (m/s)", args.speed, 0.0, 30.0)?;
    within("--steer-rate (rad/s)", args.steer_rate, -100.0, 100.0)?;
    within("--roll-rate (rad/s)", args.roll_rate, -100.0, 100.0)?;
    let setup = args.conditions.setup()?;
    let outputs = args.outputs.open(args.frames.as_deref())?;
    let start =
        Start { speed_m_s: args.speed, steer_rate_rad_s: args.steer_rate, roll_rate_rad_s: args.roll_rate };
    let (ride, trace) = traced(&setup.conditions, start);
    let document = RideDocument::new(setup.config.clone(), &ride);
    let title = format!(
        "{}: {} m/s, steer rate {} rad/s, roll rate {} rad/s",
        setup.config.label(),
        args.speed,
        args.steer_rate,
        args.roll_rate
    );
    let figure = RideFigure { trace: &trace, outcome: ride.outcome, title: &title };
    let config = json!({"config": document.config, "start": document.start});
    let framed = outputs
        .write_frames(|| frames(&setup.conditions, start, &trace).iter().flat_map(encode_frame).collect());
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || terminal::ride(&figure, 80) + &summary(&ride, setup.conditions.rider.is_some()),
        table: || table::table(&config, &trace),
        figure: || figure::ride(&figure),
    })?;
    framed?;
    Ok(Ended::Done)
}

fn summary(ride: &Ride, ridden: bool) -> String {
    let (e, mut text) = (&ride.effort, String::new());
    let _ = match ride.outcome.time_to_fall_s() {
        Some(t) => writeln!(text, "fallen after {t:.6} s"),
        None => writeln!(text, "not fallen, {}", ride.outcome.name()),
    };
    let _ = writeln!(
        text,
        "peak roll {:.1} deg, peak steer {:.1} deg",
        e.peak_roll_rad.to_degrees(),
        e.peak_steer_rad.to_degrees()
    );
    let _ = writeln!(
        text,
        "torque: peak {:.2} N m, rms {:.2} N m, peak slew {:.1} N m/s; motor energy {:.2} J (pushing {:.2} J)",
        e.peak_torque_nm, e.rms_torque_nm, e.peak_slew_nm_s, e.motor_energy_j, e.motor_energy_out_j
    );
    if ridden {
        let _ = writeln!(
            text,
            "rider: peak {:.2} N m, rms {:.2} N m, energy {:.2} J; against the assist {:.0} % of the time",
            e.rider_peak_torque_nm,
            e.rider_rms_torque_nm,
            e.rider_energy_j,
            100.0 * e.opposed
        );
    }
    text
}
