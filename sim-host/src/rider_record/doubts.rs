//! Values that look wrong: another unit than the column's name says, or a motion that a linear model does not describe.

use super::outliers::high;
use crate::identify::{Record, Signal};
use crate::range::plain;

/// Angles and rates beyond these are suspected to be in degrees: nobody rides with a roll angle of 60 degrees.
const SUSPECT_RAD: f64 = 1.0;
const SUSPECT_RAD_S: f64 = 6.0;
/// Beyond this angle the linear bicycle is off by more than a few per cent \[rad\].
const LINEAR_RAD: f64 = 0.35;
/// Lateral forces outside of this range do not move a rider noticeably, or throw the rider off \[N\].
const FORCE_N: (f64, f64) = (2.0, 1000.0);
/// Steer torques outside of this range do not move the handlebar noticeably, or tear it out of a rider's hands \[N m\].
const TORQUE_NM: (f64, f64) = (0.05, 100.0);
/// Largest standard deviation of a constant speed, relative to its mean.
const SPEED_DEVIATION: f64 = 0.05;

/// Doubts about a record.
pub(super) fn doubts(record: &Record, speed_m_s: f64, deviation_m_s: Option<f64>) -> Vec<String> {
    let mut doubts = Vec::new();
    for measured in &record.measured {
        let valid = (0..record.len()).filter(|k| measured.valid[*k]).map(|k| measured.values[k]);
        let (name, high) = (measured.signal.name(), high(valid));
        let (suspect, unit, other) = match measured.signal {
            Signal::RollRate => (SUSPECT_RAD_S, "rad/s", "degrees a second"),
            Signal::Steer | Signal::Roll => (SUSPECT_RAD, "rad", "degrees"),
        };
        if high > suspect {
            doubts.push(format!(
                "{name} reaches {high:.3} {unit} in one sample of a hundred: is it in {other}?"
            ));
        } else if measured.signal != Signal::RollRate && high > LINEAR_RAD {
            doubts.push(format!(
                "{name} reaches {high:.2} rad; the linear bicycle is made for less than {LINEAR_RAD} rad"
            ));
        }
    }
    let disturbances = [("lateral force", "N", FORCE_N), ("steer torque", "N m", TORQUE_NM)];
    for (input, (name, unit, (least, most))) in disturbances.into_iter().enumerate() {
        let largest = record.disturbances.samples.iter().map(|x| x[input].abs()).fold(0.0, f64::max);
        if largest > 0.0 && !(least..=most).contains(&largest) {
            doubts.push(format!(
                "the largest {name} is {} {unit}; {least} to {most} {unit} are expected: is the unit right?",
                plain(largest)
            ));
        }
    }
    if let Some(deviation) = deviation_m_s.filter(|deviation| *deviation > SPEED_DEVIATION * speed_m_s) {
        doubts.push(format!(
            "the speed varies by {deviation:.2} m/s (standard deviation) about {speed_m_s:.2} m/s; the model has a constant speed"
        ));
    }
    doubts
}
