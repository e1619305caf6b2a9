//! The numbers found so far for one sensor.

use super::estimates::digits;
use crate::plant::Sensor;
use crate::plant::sensor_file::{MeasuredNumber, SensorNumbers};
use crate::weave::Estimate;

/// Results so far.
pub(super) struct Found {
    pub(super) sensor: Sensor,
    pub(super) numbers: SensorNumbers,
    /// Density of the white noise at standstill, by axis \[unit^2/Hz\].
    pub(super) white_power: [f64; 3],
}

impl Found {
    /// Records a number with its unit, for an axis if the sensor has several.
    pub(super) fn number(
        &mut self,
        number: &str,
        axis: Option<usize>,
        unit: &str,
        found: Estimate,
        seconds: f64,
    ) {
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
    pub(super) fn left_out(&mut self, what: String) {
        self.numbers.left_out.push(what);
    }

    /// The sensor's unit.
    pub(super) fn unit(&self) -> &'static str {
        match self.sensor {
            Sensor::Gyro | Sensor::SteerRate => "rad/s",
            Sensor::Accel => "m/s^2",
            Sensor::Steer | Sensor::Path => "rad",
            Sensor::FrontWheel | Sensor::RearWheel => "m/s",
            Sensor::RiderTorque | Sensor::MotorReport => "N m",
        }
    }

    pub(super) fn axes(&self) -> usize {
        self.sensor.axes().len().max(1)
    }
}
