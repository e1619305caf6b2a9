//! Fits a sensor model to recordings of a real sensor.
//!
//! `windows` cuts the recordings into seconds at standstill and riding. `clock` analyses the times of the
//! samples, `step` their quantisation, `noise` the sensor at standstill, `vibration` the addition by riding,
//! `lag` and `distance` the delay relative to another sensor. Each gives numbers with intervals, and lists
//! what the recordings do not determine.

mod clock;
mod distance;
mod estimates;
mod found;
mod lag;
mod noise;
mod spectrum;
mod step;
mod toml;
mod vibration;
mod windows;

use crate::plant::Sensor;
use crate::plant::sensor_file::SensorNumbers;
use found::Found;
pub use toml::to_toml;
use windows::Recorded;
pub use windows::Recording;

/// A sensor that none of the recordings has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("none of the recordings has {}", .0.name())]
pub struct NotRecorded(pub Sensor);

/// Fits a model of `sensor` to recordings.
///
/// # Errors
/// None of the recordings has the sensor.
pub fn fit(sensor: Sensor, recordings: &[Recording]) -> Result<SensorNumbers, NotRecorded> {
    let of_sensor = |recording| Recorded::new(recording, sensor);
    let all: Vec<Recorded> = recordings.iter().filter_map(of_sensor).collect();
    if all.is_empty() {
        return Err(NotRecorded(sensor));
    }
    let mut found = Found { sensor, numbers: SensorNumbers::default(), white_power: [0.0; 3] };
    clock::fit(&all, &mut found);
    step::fit(&all, &mut found);
    noise::fit(&all, &mut found);
    vibration::fit(&all, &mut found);
    lag::fit(&all, &mut found);
    Ok(found.numbers)
}
