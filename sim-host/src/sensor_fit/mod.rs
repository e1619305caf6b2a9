//! Fits a sensor model to recordings of a real sensor.
//!
//! `windows` cuts the recordings into seconds at standstill and riding. `clock` analyses the times of the
//! samples, `step` their quantisation, `noise` the sensor at standstill, `vibration` the addition by riding,
//! `lag` and `distance` the delay relative to another sensor. Each gives numbers with intervals, and lists
//! what the recordings do not determine.

mod clock;
mod distance;
mod lag;
mod noise;
mod spectrum;
mod step;
mod toml;
mod vibration;
mod windows;

use crate::plant::Sensor;
use crate::plant::sensor_file::{MeasuredNumber, SensorNumbers};
use crate::replay::Samples;
use crate::weave::Estimate;
use crate::weave::pool::pool;
use crate::weave::student::quantile;
pub use toml::to_toml;
use windows::Recorded;

/// One recording.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Samples of the sensors.
    pub samples: Samples,
    /// Distance counted by the wheel sensor \[m\] over time \[s\], if recorded with the speed.
    pub distance_m: Vec<(f64, f64)>,
}

/// Fits a model of `sensor` to recordings.
///
/// # Errors
/// None of the recordings has the sensor.
pub fn fit(sensor: Sensor, recordings: &[Recording]) -> Result<SensorNumbers, String> {
    let of_sensor = |recording| Recorded::new(recording, sensor);
    let all: Vec<Recorded> = recordings.iter().filter_map(of_sensor).collect();
    if all.is_empty() {
        return Err(format!("none of the recordings has {}", sensor.name()));
    }
    let mut found = Found { sensor, numbers: SensorNumbers::default(), white_power: [0.0; 3] };
    clock::fit(&all, &mut found);
    step::fit(&all, &mut found);
    noise::fit(&all, &mut found);
    vibration::fit(&all, &mut found);
    lag::fit(&all, &mut found);
    Ok(found.numbers)
}

/// Results so far.
struct Found {
    sensor: Sensor,
    numbers: SensorNumbers,
    /// Density of the white noise at standstill, by axis \[unit^2/Hz\].
    white_power: [f64; 3],
}

impl Found {
    /// Records a number with its unit, for an axis if the sensor has several.
    fn number(&mut self, number: &str, axis: Option<usize>, unit: &str, found: Estimate, seconds: f64) {
        let axis = axis.and_then(|axis| self.sensor.axes().get(axis)).copied().unwrap_or_default();
        let [value, low, high] = [found.value, found.low, found.high].map(digits);
        self.numbers.measured.push(MeasuredNumber {
            number: number.into(),
            axis: axis.into(),
            unit: unit.into(),
            value,
            low,
            high,
            seconds: (10.0 * seconds).round() / 10.0,
        });
    }

    /// Records a quantity that the recordings do not determine.
    fn left_out(&mut self, what: String) {
        self.numbers.left_out.push(what);
    }

    /// The sensor's unit.
    fn unit(&self) -> &'static str {
        match self.sensor {
            Sensor::Gyro | Sensor::SteerRate => "rad/s",
            Sensor::Accel => "m/s^2",
            Sensor::Steer | Sensor::Path => "rad",
            Sensor::FrontWheel | Sensor::RearWheel => "m/s",
            Sensor::RiderTorque | Sensor::MotorReport => "N m",
        }
    }

    fn axes(&self) -> usize {
        self.sensor.axes().len().max(1)
    }
}

/// Rounds to four digits, more than the accuracy of any of these numbers; rounding residues become zero.
fn digits(x: f64) -> f64 {
    if x.abs() < 1e-12 {
        return 0.0;
    }
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// Mean of independent values with its interval by Student's t; none for fewer than two.
fn mean(values: &[f64]) -> Option<Estimate> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (values.len() > 1).then(|| Estimate::new(mean, (square / n).sqrt(), quantile(n - 1.0)))
}

/// Combined mean of the recordings; scatter between them widens the interval.
fn pooled(recordings: &[Vec<f64>]) -> Option<Estimate> {
    let means: Vec<Estimate> = recordings.iter().filter_map(|values| mean(values)).collect();
    // Equal values have no error to weigh by.
    if means.iter().any(|mean| mean.standard_error == 0.0) {
        return mean(&recordings.concat());
    }
    pool(&means).map(|pooled| pooled.mean)
}

/// Square root of a power that can't be negative.
fn root(power: Estimate) -> Estimate {
    let root = |x: f64| x.max(0.0).sqrt();
    let value = root(power.value);
    let standard_error = if value > 0.0 { 0.5 * power.standard_error / value } else { 0.0 };
    Estimate { value, standard_error, low: root(power.low), high: root(power.high) }
}

/// Share of `n` events, with Wilson's interval.
fn share(events: usize, n: usize) -> Estimate {
    let (n, z) = (n.max(1) as f64, quantile(1e9));
    let p = events as f64 / n;
    let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    Estimate {
        value: p,
        standard_error: half / z,
        low: (middle - half).max(0.0),
        high: (middle + half).min(1.0),
    }
}

/// Quantile of sorted values, with its interval by order statistics.
fn part_of(sorted: &[f64], part: f64) -> Estimate {
    let n = sorted.len() as f64;
    let at = |share: f64| sorted[((n - 1.0) * share.clamp(0.0, 1.0)).round() as usize];
    let half = quantile(1e9) * (part * (1.0 - part) / n).sqrt();
    let (value, low, high) = (at(part), at(part - half), at(part + half));
    Estimate { value, standard_error: 0.25 * (high - low), low, high }
}

/// An observed number, without an interval.
const fn observed(value: f64) -> Estimate {
    Estimate { value, standard_error: 0.0, low: value, high: value }
}
