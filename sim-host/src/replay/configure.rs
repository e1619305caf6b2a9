//! The firmware's configuration, adapted to a recording: only the recorded sensors are declared.

use super::map::Map;
use super::samples::Samples;
use crate::parameters::{self, SetError};
use crate::plant::Sensor;
use control::{Config, Wheel};

/// Changes of the configuration for the recording.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Fitted {
    /// Sensors that the configuration declares and the recording lacks; switched off.
    pub switched_off: Vec<&'static str>,
    /// Sensors of the map whose columns are missing or empty, each with the columns.
    pub absent: Vec<String>,
    /// Checks switched off because a sensor or an axis is missing, each with the reason.
    pub unchecked: Vec<String>,
}

/// A parameter of a map that can't be set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("parameters: {key} = {value}: {error}")]
pub struct MapParameterError {
    /// The parameter.
    pub key: String,
    /// Its value.
    pub value: String,
    /// The error.
    pub error: SetError,
}

/// Declares the recorded sensors in a configuration, and sets the map's parameters.
///
/// # Errors
/// A parameter of the map that does not exist, or a value that is not allowed.
pub fn fitted(config: &mut Config, samples: &Samples, map: &Map) -> Result<Fitted, MapParameterError> {
    let mut fitted = Fitted { absent: samples.absent.clone(), ..Fitted::default() };
    let has = |sensor| samples.track(sensor).is_some();
    for sensor in Sensor::ALL {
        let wheel = config.input.front_wheel;
        let declared = declared(config, sensor);
        if declared.fitted && !has(sensor) {
            declared.fitted = false;
            fitted.switched_off.push(sensor.name());
        } else if !declared.fitted && has(sensor) && sensor == Sensor::RearWheel {
            // The published conditions declare the front wheel only; the rear wheel has the same range.
            *declared = control::Sensor { fitted: true, ..wheel };
        }
    }
    config.input.wheel = match (has(Sensor::FrontWheel), config.input.wheel) {
        (false, _) => Wheel::Rear,
        (true, Wheel::Rear) if !has(Sensor::RearWheel) => Wheel::Front,
        (_, wheel) => wheel,
    };
    unchecked(config, samples, &mut fitted);
    // The recorded bicycle was assembled and checked before the ride.
    config.calibration.polarity_checked = true;
    for (key, value) in &map.parameters {
        let text = match value {
            toml::Value::String(word) => word.clone(),
            toml::Value::Boolean(on) => if *on { "on" } else { "off" }.into(),
            number => number.to_string(),
        };
        parameters::set(config, key, &text).map_err(|error| MapParameterError {
            key: key.clone(),
            value: text.clone(),
            error,
        })?;
    }
    Ok(fitted)
}

/// A sensor's declaration.
fn declared(config: &mut Config, sensor: Sensor) -> &mut control::Sensor {
    let input = &mut config.input;
    match sensor {
        Sensor::Gyro => &mut input.gyro,
        Sensor::Accel => &mut input.accel,
        Sensor::Steer => &mut input.steer,
        Sensor::SteerRate => &mut input.steer_rate,
        Sensor::FrontWheel => &mut input.front_wheel,
        Sensor::RearWheel => &mut input.rear_wheel,
        Sensor::RiderTorque => &mut input.rider_torque,
        Sensor::MotorReport => &mut input.motor,
        Sensor::Path => &mut input.path,
    }
}

/// Switches off checks whose input is a substitute or missing, and lists the checks without values to compare.
fn unchecked(config: &mut Config, samples: &Samples, fitted: &mut Fitted) {
    let made_up = |sensor: Sensor| samples.track(sensor).map_or([false; 3], |track| track.made_up);
    let has = |sensor| samples.track(sensor).is_some();
    if made_up(Sensor::Gyro) != [false; 3] {
        let cross = &mut config.cross;
        (cross.yaw_rad_s, cross.yaw_slow_rad_s, cross.yaw_slope) = (None, None, false);
        config.response.gyro = false;
        fitted.unchecked.push("yaw and gyro response: not all axes of the gyro were recorded".into());
    }
    if made_up(Sensor::Gyro)[0] {
        config.cross.roll_correlation = false;
        fitted.unchecked.push("roll correlation: the gyro's x axis was not recorded".into());
    }
    if made_up(Sensor::Accel) != [false; 3] {
        (config.permit.lifted_m_s2, config.permit.crash_m_s2) = (None, None);
        fitted.unchecked.push("lifted and crash: not all axes of the accelerometer were recorded".into());
    }
    // The computed torque did not act: the bicycle responded to the recorded torque, where there is one.
    if !has(Sensor::MotorReport) && config.response.motor.take().is_some() {
        fitted.unchecked.push("motor response: the torque that comes out did not act on this bicycle".into());
    }
    let lacks = [
        (
            config.cross.wheels_m_s.is_some() && !(has(Sensor::FrontWheel) && has(Sensor::RearWheel)),
            "wheels: one wheel only",
        ),
        (config.cross.yaw_rad_s.is_some() && !has(Sensor::Steer), "yaw: no steer angle"),
        (config.cross.roll_correlation && !has(Sensor::Steer), "roll correlation: no steer angle"),
        (
            config.cross.steer_rad.is_some() && !(has(Sensor::Steer) && has(Sensor::SteerRate)),
            "steer: angle and rate are not both there",
        ),
        (config.cross.motor_nm.is_some() && !has(Sensor::MotorReport), "motor: no report of the drive"),
        (config.response.gyro && !has(Sensor::Accel), "gyro response: no accelerometer"),
        (config.permit.lifted_m_s2.is_some() && !has(Sensor::Accel), "lifted and crash: no accelerometer"),
    ];
    fitted
        .unchecked
        .extend(lacks.into_iter().filter(|(lacks, _)| *lacks).map(|(_, reason)| reason.to_owned()));
}
