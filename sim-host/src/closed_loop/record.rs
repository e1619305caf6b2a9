//! The record of a closed loop from a recording's samples.

use super::{Channel, Geometry, Record, Signal};
use crate::plant::Sensor;
use crate::replay::{Map, Sample, Samples};

/// Samples of a signal that are further apart than this many of its periods have a gap between them.
const GAP: f64 = 5.0;

/// A recording without the torque of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no torque: the map assigns neither `reference.torque` nor `motor` to a recorded column; without it only a replay is possible"
)]
pub struct Lacking;

/// The record at the times of the torque: the recording's own (`reference.torque`), otherwise the motor's report. Other
/// signals are interpolated linearly, except across gaps.
///
/// # Errors
/// No torque in the recording.
pub fn record(samples: &Samples) -> Result<Record, Lacking> {
    let axis = |sensor: Sensor, axis: usize| {
        let track = samples.track(sensor).filter(|track| !track.made_up[axis])?;
        let values = track.samples.iter().map(|Sample { t_s, value }| (*t_s, value[axis]));
        Some(values.collect::<Vec<(f64, f64)>>())
    };
    let own = (!samples.torque_nm.is_empty()).then(|| samples.torque_nm.clone());
    let torque = own.or_else(|| axis(Sensor::MotorReport, 0)).ok_or(Lacking)?;
    let times_s: Vec<f64> = torque.iter().map(|(t_s, _)| *t_s).collect();
    let speed = axis(Sensor::RearWheel, 0).or_else(|| axis(Sensor::FrontWheel, 0));
    let roll = (!samples.roll_rad.is_empty()).then(|| samples.roll_rad.clone());
    let of = |signal| match signal {
        Signal::RollRate => axis(Sensor::Gyro, 0),
        Signal::Steer => axis(Sensor::Steer, 0),
        Signal::Roll => roll.clone(),
        Signal::SteerRate => axis(Sensor::SteerRate, 0),
        Signal::RiderTorque => axis(Sensor::RiderTorque, 0),
        Signal::YawRate => axis(Sensor::Gyro, 2),
    };
    let channel = |signal| Some(Channel { signal, values: at(&times_s, &of(signal)?) });
    Ok(Record {
        torque_nm: torque.iter().map(|(_, torque)| *torque).collect(),
        speed_m_s: speed.map_or_else(|| vec![f64::NAN; times_s.len()], |speed| at(&times_s, &speed)),
        distance_m: (!samples.distance_m.is_empty()).then(|| at(&times_s, &samples.distance_m)),
        channels: Signal::ALL.into_iter().filter_map(channel).collect(),
        times_s,
    })
}

/// The part of a record between two times \[s\].
pub fn within(record: &Record, from_s: Option<f64>, to_s: Option<f64>) -> Record {
    let from = record.times_s.partition_point(|t| from_s.is_some_and(|from| *t < from));
    let to = record.times_s.partition_point(|t| to_s.is_none_or(|to| *t <= to)).max(from);
    let part = |values: &[f64]| values[from..to].to_vec();
    let channel = |channel: &Channel| Channel { signal: channel.signal, values: part(&channel.values) };
    Record {
        times_s: part(&record.times_s),
        torque_nm: part(&record.torque_nm),
        speed_m_s: part(&record.speed_m_s),
        distance_m: record.distance_m.as_deref().map(part),
        channels: record.channels.iter().map(channel).collect(),
    }
}

/// Wheelbase and tilt from a map's parameters.
pub fn geometry(map: &Map) -> Option<Geometry> {
    let number = |key: &str| {
        let value = map.parameters.get(key)?;
        value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
    };
    Some(Geometry { wheelbase_m: number("cross.wheelbase_m")?, tilt_rad: number("cross.tilt_rad")? })
}

/// The values at `times_s`, which increase as the samples' times do; NaN outside the samples and in gaps.
fn at(times_s: &[f64], samples: &[(f64, f64)]) -> Vec<f64> {
    let mut steps: Vec<f64> = samples.windows(2).map(|two| two[1].0 - two[0].0).collect();
    steps.sort_by(f64::total_cmp);
    let longest = steps.get(steps.len() / 2).map_or(0.0, |period| GAP * period);
    let value = |t_s: &f64| {
        let next = samples.partition_point(|(time, _)| time < t_s);
        match (next.checked_sub(1).map(|before| samples[before]), samples.get(next)) {
            (_, Some((time, value))) if time == t_s => *value,
            (Some((t0, x0)), Some((t1, x1))) if t1 - t0 <= longest => x0 + (x1 - x0) * (t_s - t0) / (t1 - t0),
            _ => f64::NAN,
        }
    };
    times_s.iter().map(value).collect()
}
