//! `sim-host ride`: one ride after a disturbance.

use super::conditions::{printed, setup};
use super::options::{Chosen, Ride as RideOptions};
use super::outputs::{Further, OutputArgs, Outputs, Results};
use super::scenario_error::named;
use super::{Ended, Failure};
use crate::commands::Setup;
use crate::commands::ride::{self, Ridden};
use crate::report::figure::{self, RideFigure};
use crate::report::{mcap, netcdf, table, terminal};
use crate::ride::{Conditions, FallCause, FallCriterion, LaidFlat, Ride, Start, TracePoint, frames};
use control::wire::encode_frame;
use control::{Causes, SensorFrame};
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  sim-host ride --speed 4 --steer-rate 5
  sim-host ride --law none --speed 6 --steer-rate 1 --svg ride.svg --csv ride.csv
  sim-host ride --rider smart --law h --speed 4 --steer-rate 5
  sim-host ride --preset product --speed 3 --roll-rate 0.5 --json
  sim-host ride --speed 4 --steer-rate 5 --mcap ride.mcap";

/// Options of `ride` and of a ride on a board.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    pub(super) scenario: Chosen<RideOptions>,
    /// Write the sensor frames that the firmware received, 81 bytes each, for replay on the chip
    #[arg(long, value_name = "FILE")]
    frames: Option<PathBuf>,
    /// Write a NetCDF file with CF conventions; a name that ends with .nc4 gives NetCDF-4; - is standard output
    #[arg(long, value_name = "FILE")]
    netcdf: Option<PathBuf>,
    /// Write the rows of --csv as MCAP, for Foxglove and PlotJuggler
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    #[command(flatten)]
    outputs: OutputArgs,
}

impl Args {
    /// Checks every requested output.
    pub(super) fn open(&self) -> Result<Outputs, Failure> {
        self.outputs.open(Further {
            frames: self.frames.as_deref(),
            netcdf: self.netcdf.as_deref(),
            mcap: self.mcap.as_deref(),
        })
    }
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let scenario = args.scenario.scenario()?;
    let start = ride::start(&scenario).map_err(|e| named(&scenario, &e))?;
    if let Some(ended) = printed(&args.scenario, &scenario)? {
        return Ok(ended);
    }
    let setup = setup(&scenario)?;
    ride::check_direction(start, &setup.conditions).map_err(|e| named(&scenario, &e))?;
    let outputs = args.open()?;
    let ridden = ride::ride(&setup)?;
    let sensed = || frames(&setup.conditions, start, &ridden.trace);
    write(&setup, &outputs, &ridden, sensed, "")?;
    Ok(Ended::Done)
}

/// Writes a ride with its trace and the frames of its controller; `extra` is added to the text.
pub(super) fn write(
    setup: &Setup,
    outputs: &Outputs,
    ridden: &Ridden,
    sensed: impl FnOnce() -> Vec<SensorFrame>,
    extra: &str,
) -> Result<(), Failure> {
    let document = ridden.document(setup);
    let Ridden { ride, trace } = ridden;
    let Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s } = ride.start;
    let title = format!(
        "{}: {speed_m_s} m/s, steer rate {steer_rate_rad_s} rad/s, roll rate {roll_rate_rad_s} rad/s",
        setup.config.label(),
    );
    let figure = RideFigure { trace, outcome: ride.outcome, title: &title };
    let config = json!({"config": document.config, "start": document.start, "outcome": document.outcome,
        "time_to_fall_s": document.time_to_fall_s, "fall": document.fall});
    let framed = outputs.write_frames(|| sensed().iter().flat_map(encode_frame).collect());
    let written = outputs
        .write_netcdf(|| netcdf::ride(&title, netcdf::provenance(&config, &document.scenario), ride, trace));
    let logged =
        outputs.write_mcap(|| mcap::file("/ride", &config, trace.iter().map(|point| (point.t, *point))));
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || terminal::ride(&figure, 80) + &summary(ride, &setup.conditions) + &caused(trace) + extra,
        table: || table::table(&config, trace),
        figure: || figure::ride(&figure),
    })?;
    framed.and(written).and(logged)
}

fn summary(ride: &Ride, conditions: &Conditions) -> String {
    let (e, mut text) = (&ride.effort, String::new());
    let _ = match ride.outcome.time_to_fall_s() {
        Some(t) => writeln!(text, "fallen after {t:.6} s{}", reason(&conditions.fall, ride)),
        None if ride.undisturbed() => {
            writeln!(text, "not fallen: undisturbed, which says nothing of stability (see `sim-host eigen`)")
        }
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
        "torque: peak {:.2} N m, rms {:.2} N m, peak slew {:.1} N m/s; motor energy {} J (pushing {} J)",
        e.peak_torque_nm,
        e.rms_torque_nm,
        e.peak_slew_nm_s,
        hundredths(e.motor_energy_j),
        hundredths(e.motor_energy_out_j)
    );
    if conditions.rider.is_some() {
        let _ = writeln!(
            text,
            "rider: peak {:.2} N m, rms {:.2} N m, energy {} J; against the assist {:.0} % of the time",
            e.rider_peak_torque_nm,
            e.rider_rms_torque_nm,
            hundredths(e.rider_energy_j),
            100.0 * e.opposed
        );
    }
    text
}

/// The causes that the controller reported, each with the time of the first; empty if there were none.
fn caused(trace: &[TracePoint]) -> String {
    let mut known = Causes::NONE;
    let mut first = Vec::new();
    for point in trace {
        let added = Causes(point.causes & !known.0);
        if !added.is_empty() {
            first.extend(added.iter().map(|cause| (cause, point.t)));
            known = known.with(added);
        }
    }
    let each = first.iter().map(|(cause, t)| format!("{} {} from {t:.3} s", cause.code(), cause.name()));
    let each: Vec<String> = each.collect();
    if each.is_empty() { String::new() } else { format!("causes: {} (docs/faults)\n", each.join(", ")) }
}

/// Two digits after the decimal point; zero without a sign.
fn hundredths(x: f64) -> String {
    format!("{:.2}", (x * 100.0).round() / 100.0 + 0.0)
}

/// Reason of a fall: ": roll passed 90 deg".
fn reason(fall: &FallCriterion, ride: &Ride) -> String {
    let passed = |what, rad: f64| format!(": {what} passed {:.0} deg", rad.to_degrees());
    match ride.outcome.fall() {
        Some(FallCause::Roll) => passed("roll", fall.roll_rad),
        Some(FallCause::Steer) => passed("steer", fall.steer_rad),
        Some(FallCause::LaidFlat) => format!(": laid flat, {}", laid_flat(fall)),
        Some(FallCause::TooQuick) => {
            ": the motion became too quick to be followed, as it does beside 90 deg of roll".into()
        }
        Some(FallCause::NoMotion) => ": the model has no motion there".into(),
        None => String::new(),
    }
}

/// Definition of laid flat: "roll beyond 80 deg and no fall by 90 deg within 1 s".
pub(super) fn laid_flat(fall: &FallCriterion) -> String {
    let Some(LaidFlat { roll_rad, lasting_s }) = fall.flat else { return String::new() };
    let [flat, full] = [roll_rad, fall.roll_rad].map(f64::to_degrees);
    format!("roll beyond {flat:.0} deg and no fall by {full:.0} deg within {lasting_s} s")
}

#[cfg(test)]
mod tests {
    use super::hundredths;

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(
            [-0.001, 0.0, -0.004, -0.006, 1.005].map(hundredths),
            ["0.00", "0.00", "0.00", "-0.01", "1.00"]
        );
    }
}
