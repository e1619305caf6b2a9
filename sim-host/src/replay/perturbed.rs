//! The signals of a perturbation record, over time.

use super::extract::{column, times};
use super::map::{Map, Signal, Source, quantity_of};
use super::map_error::MapTextError;
use super::unit::Quantity;
use crate::plant::Sensor;
use crate::recording::{Recording, Remark};
use std::fmt::Write;

/// Values over time \[s\], in the order of the file, without those that are not numbers.
pub type Timed = Vec<(f64, f64)>;

/// The signals of a perturbation record, SI, right positive; empty where the map assigns none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Perturbed {
    /// Lateral force on the rear frame \[N\].
    pub lateral_force_n: Timed,
    /// Steer torque beside the rider's \[N m\].
    pub steer_torque_nm: Timed,
    /// Steer angle \[rad\].
    pub steer_rad: Timed,
    /// Roll angle \[rad\].
    pub roll_rad: Timed,
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: Timed,
    /// Forward speed \[m/s\].
    pub speed_m_s: Timed,
}

/// Applies a map to a recording. Without a column for the roll rate it is the rate of the gyro about the forward axis;
/// the speed is that of the rear wheel, otherwise of the front wheel.
///
/// # Errors
/// A column that the map assigns is not in the recording, or there is no time.
pub fn perturbed(recording: &Recording, map: &Map) -> Result<Perturbed, Remark> {
    let over_time = |signal: Option<&Signal>, quantity: Quantity, axis: (usize, f64)| {
        signal.map_or(Ok(Timed::new()), |signal| over_time(recording, map, signal, quantity, axis))
    };
    let first = (0, 1.0);
    let sensor = |sensor: Sensor, axis| over_time(map.of(sensor), quantity_of(sensor), axis);
    let perturbation = &map.perturbation;
    let roll_rate_rad_s = match (&perturbation.roll_rate, map.of(Sensor::Gyro)) {
        (None, Some(gyro)) => sensor(Sensor::Gyro, gyro.turns()[0])?,
        (signal, _) => over_time(signal.as_ref(), Quantity::Rate, first)?,
    };
    let wheel = if map.of(Sensor::RearWheel).is_some() { Sensor::RearWheel } else { Sensor::FrontWheel };
    Ok(Perturbed {
        lateral_force_n: over_time(perturbation.lateral_force.as_ref(), Quantity::Force, first)?,
        steer_torque_nm: over_time(perturbation.steer_torque.as_ref(), Quantity::Torque, first)?,
        steer_rad: sensor(Sensor::Steer, first)?,
        roll_rad: over_time(map.reference.roll.as_ref(), Quantity::Angle, first)?,
        roll_rate_rad_s,
        speed_m_s: sensor(wheel, first)?,
    })
}

/// One column of a signal over time, with its sign.
fn over_time(
    recording: &Recording,
    map: &Map,
    signal: &Signal,
    quantity: Quantity,
    (axis, sign): (usize, f64),
) -> Result<Timed, Remark> {
    let factor = quantity.factor(signal.unit.as_deref()).unwrap_or(1.0);
    let name = match signal.columns.get(axis) {
        Some(Source::Column(name)) => name,
        _ => return Ok(Timed::new()),
    };
    let (group, found) = column(recording, name).ok_or_else(|| {
        Remark::of_column(Some(name), "the map names this column, which is not there".into())
    })?;
    let times = times(group, map, signal.time.as_deref())?;
    let value = |(t_s, value): (f64, &f64)| {
        (t_s + signal.late_s, sign * factor * (signal.scale * value + signal.offset))
    };
    let numbers = |(t_s, value): &(f64, f64)| t_s.is_finite() && value.is_finite();
    Ok(times.into_iter().zip(&found.values).map(value).filter(numbers).collect())
}

/// The documented columns of a perturbation record: table of the map, column, unit. The first column of a table that a file
/// has is taken.
const COLUMNS: [(&str, &str, &str); 13] = [
    ("perturbation.lateral_force", "lateral_force_n", "N"),
    ("perturbation.lateral_force", "lateral_force_kn", "kN"),
    ("perturbation.lateral_force", "lateral_force_lbf", "lbf"),
    ("perturbation.steer_torque", "steer_torque_nm", "N m"),
    ("steer", "steer_rad", "rad"),
    ("steer", "steer_deg", "deg"),
    ("reference.roll", "roll_rad", "rad"),
    ("reference.roll", "roll_deg", "deg"),
    ("perturbation.roll_rate", "roll_rate_rad_s", "rad/s"),
    ("perturbation.roll_rate", "roll_rate_deg_s", "deg/s"),
    ("rear_wheel", "speed_m_s", "m/s"),
    ("rear_wheel", "speed_km_h", "km/h"),
    ("rear_wheel", "speed_kmh", "km/h"),
];

/// Columns of the time, with their unit.
const TIMES: [(&str, &str); 5] =
    [("time_s", "s"), ("t", "s"), ("time", "s"), ("Time", "s"), ("time_ms", "ms")];

impl Map {
    /// Whether a remark concerns a perturbation record: the whole file, the time, or a column of a signal that is read.
    pub fn concerns_perturbation(&self, remark: &Remark) -> bool {
        let Some(column) = &remark.column else { return true };
        let perturbation = &self.perturbation;
        let others = [
            &perturbation.lateral_force,
            &perturbation.steer_torque,
            &perturbation.roll_rate,
            &self.reference.roll,
        ];
        let signals = self.sensors().map(|mapped| mapped.signal).chain(others.into_iter().flatten());
        let times = self.time.iter().flat_map(|time| &time.column);
        let read = signals.flat_map(|signal| {
            let columns = signal.columns.iter().filter_map(|source| match source {
                Source::Column(name) => Some(name),
                _ => None,
            });
            columns.chain(&signal.time)
        });
        times.chain(read).any(|name| name == column)
    }

    /// The map of the documented columns that the recording has: docs/identify.md.
    ///
    /// # Errors
    /// None: names and units are those of a map.
    pub fn of_perturbation(recording: &Recording) -> Result<Self, MapTextError> {
        let has = |name: &str| column(recording, name).is_some();
        let mut text = String::new();
        if let Some((name, unit)) = TIMES.iter().find(|(name, _)| has(name)) {
            let _ = writeln!(text, "[time]\ncolumn = \"{name}\"\nunit = \"{unit}\"");
        }
        let mut assigned = Vec::new();
        for (table, name, unit) in COLUMNS {
            if has(name) && !assigned.contains(&table) {
                let _ = writeln!(text, "[{table}]\ncolumns = [\"{name}\"]\nunit = \"{unit}\"");
                assigned.push(table);
            }
        }
        Self::parse(&text)
    }
}
