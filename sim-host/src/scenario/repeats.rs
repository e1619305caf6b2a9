//! Doubts about sensors without noise beside noisy ones, which the flashed checks take for stuck.

use crate::plant::{Sensor, SensorConfig, SensorModel};
use control::{Cause, Config};

/// Warnings about an IMU whose samples repeat in steady riding while another sensor's change: what
/// `cross.same_checks` reports as stuck. A real IMU always has noise.
pub(super) fn warnings(config: &Config, sensors: &SensorConfig) -> Vec<String> {
    if config.cross.same_checks == 0 {
        return Vec::new();
    }
    let sensors_of_motion =
        [Sensor::Gyro, Sensor::Accel, Sensor::Steer, Sensor::FrontWheel, Sensor::RearWheel];
    let fitted = sensors_of_motion.map(|sensor| (sensor, sensor.declared(&config.input).fitted));
    let changing = |(sensor, fitted): &(Sensor, bool)| *fitted && changes(sensors.model(*sensor));
    let Some((noisy, _)) = fitted.iter().find(|sensor| changing(sensor)) else { return Vec::new() };
    let imu = [(fitted[0], Cause::GyroStuck), (fitted[1], Cause::AccelStuck)];
    let still = imu.into_iter().filter(|((_, fitted), _)| *fitted).filter(|(sensor, _)| !changing(sensor));
    still
        .map(|((sensor, _), cause)| {
            let (name, noisy) = (sensor.name(), noisy.name());
            format!(
                "{name} is exact beside {noisy}, which is noisy: in steady riding its samples repeat, which the checks take for stuck \
                 (cause {}, {}); give it noise, for example --sensor {name}:noise=0.01",
                cause.code(),
                cause.name()
            )
        })
        .collect()
}

/// Whether a sensor's samples change in steady riding.
fn changes(model: &SensorModel) -> bool {
    let SensorModel { noise, fitted, .. } = model;
    let mut axes = fitted.white.iter().chain(&fitted.walk).chain(fitted.vibration.iter().flatten());
    *noise > 0.0 || axes.any(|amount| *amount > 0.0)
}
