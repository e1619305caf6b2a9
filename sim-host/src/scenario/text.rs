//! Parses values of a scenario from text, as on the command line and in the axes of a sweep.

use super::content::{Content, NONE, OrNone};
use super::plant::{ActuatorChoice, PlantChoice, SensorChange, sensor_named};
use super::ticks::{LONGEST_S, LONGEST_SENSOR_S};
use crate::range::time;
use crate::ride::{FallCriterion, LaidFlat};
use serde::de::IntoDeserializer;
use serde::de::value::{Error, StrDeserializer};

/// A number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is not a number"))
}

/// A whole number.
pub(super) fn whole<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is not a whole number in range"))
}

/// A word among those of an enum.
pub(super) fn word<'a, T: serde::Deserialize<'a>>(text: &'a str) -> Result<T, String> {
    let deserializer: StrDeserializer<'a, Error> = text.into_deserializer();
    T::deserialize(deserializer).map_err(|e| e.to_string())
}

/// A number or none.
pub(super) fn limit(text: &str) -> Result<OrNone<f64>, String> {
    match text {
        NONE => Ok(OrNone::Off),
        _ => text.parse().map(OrNone::At).map_err(|_| format!("`{text}` is neither a number nor none")),
    }
}

/// `ZERO:FULL` or none.
pub(super) fn taper(text: &str) -> Result<OrNone<[f64; 2]>, String> {
    if text == NONE {
        return Ok(OrNone::Off);
    }
    let speeds = text.split_once(':').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    speeds.map(OrNone::At).ok_or_else(|| format!("`{text}` is neither ZERO:FULL in m/s nor none"))
}

/// `KEY=VALUE`.
pub(super) fn pair(text: &str) -> Result<(&str, &str), String> {
    text.split_once('=').ok_or_else(|| "expected KEY=VALUE".into())
}

/// The pairs of `KEY=VALUE,...`.
fn pairs(text: &str) -> impl Iterator<Item = Result<(&str, &str), String>> {
    text.split(',').map(|pair| pair.split_once('=').ok_or_else(|| format!("`{pair}` is not KEY=VALUE")))
}

fn keyed(key: &str, value: &str) -> Result<f64, String> {
    value.trim().parse().map_err(|_| format!("{key}: `{value}` is not a number"))
}

/// Adds one `MODEL+...`, `NAME[.AXIS]:KEY=VALUE,...` or `imu:KEY=VALUE,...`; none removes all models.
pub(super) fn sensor(plant: &mut PlantChoice, text: &str) -> Result<(), String> {
    if text == NONE {
        plant.sensors.clear();
        return Ok(());
    }
    let Some((place, settings)) = text.split_once(':') else {
        let models =
            text.split('+').map(|name| SensorChange { model: Some(name.into()), ..SensorChange::default() });
        plant.sensors.extend(models);
        return Ok(());
    };
    if place == "imu" {
        return pairs(settings).try_for_each(|pair| pair.and_then(|(key, value)| mount(plant, key, value)));
    }
    let (name, axis) =
        place.split_once('.').map_or((place, None), |(name, axis)| (name, Some(axis.to_owned())));
    sensor_named(name)?;
    let mut change = SensorChange { sensor: Some(name.into()), axis, ..SensorChange::default() };
    for pair in pairs(settings) {
        let (key, value) = pair?;
        match key {
            "model" => change.model = Some(Content::Named(value.into())),
            "delay" => change.delay_s = Some(time(value, LONGEST_SENSOR_S).map_err(|e| e.to_string())?),
            "every" => change.every_s = Some(time(value, LONGEST_SENSOR_S).map_err(|e| e.to_string())?),
            "bias" => change.bias = Some(keyed(key, value)?),
            "scale" => change.scale = Some(keyed(key, value)?),
            "noise" => change.noise = Some(keyed(key, value)?),
            "quantum" => change.quantum = Some(keyed(key, value)?),
            "range" => change.range = Some(keyed(key, value)?),
            "dropout" => change.dropout = Some(keyed(key, value)?),
            _ => {
                return Err(format!(
                    "unknown key `{key}`; expected model=NAME|FILE, delay=TIME, every=TIME, noise, bias, scale, quantum, range, dropout"
                ));
            }
        }
    }
    plant.sensors.push(change);
    Ok(())
}

fn mount(plant: &mut PlantChoice, key: &str, value: &str) -> Result<(), String> {
    let [x, y, z] = &mut plant.imu.point_m;
    let [roll, pitch, yaw] = &mut plant.imu.turned_rad;
    let place = match key {
        "x" => x,
        "y" => y,
        "z" => z,
        "roll" => roll,
        "pitch" => pitch,
        "yaw" => yaw,
        _ => {
            return Err(format!(
                "unknown key `{key}` of the imu; expected x, y, z in m, roll, pitch, yaw in rad"
            ));
        }
    };
    *place = keyed(key, value)?;
    Ok(())
}

/// The actuator of `NAME|FILE|KEY=VALUE,...`.
pub(super) fn actuator(text: &str) -> Result<ActuatorChoice, String> {
    let (name, settings) = match text.split_once(',') {
        _ if text.split(',').next().is_some_and(|first| first.contains('=')) => (NONE, Some(text)),
        Some((name, settings)) => (name, Some(settings)),
        None => (text, None),
    };
    let model = (name != NONE).then(|| name.into());
    let mut choice = ActuatorChoice { model, ..ActuatorChoice::default() };
    for pair in settings.into_iter().flat_map(pairs) {
        let (key, value) = pair?;
        let place = match key {
            "delay" => {
                choice.delay_s = Some(time(value, LONGEST_S).map_err(|e| e.to_string())?);
                continue;
            }
            "time-constant" => {
                choice.time_constant_s = Some(time(value, 10.0).map_err(|e| e.to_string())?);
                continue;
            }
            "scale" => &mut choice.scale,
            "limit" => &mut choice.limit_nm,
            "viscous" => &mut choice.viscous_nm_s_rad,
            "coulomb" => &mut choice.coulomb_nm,
            "creep" => &mut choice.creep_rad_s,
            "stop" => &mut choice.stop_rad,
            "voltage" => &mut choice.voltage_v,
            "resistance" => &mut choice.resistance_ohm,
            "constant" => &mut choice.constant_nm_a,
            _ => {
                return Err(format!(
                    "unknown key `{key}`; expected delay=TIME, time-constant=TIME, scale, limit, viscous, coulomb, creep, \
                     stop, voltage, resistance, constant"
                ));
            }
        };
        *place = Some(keyed(key, value)?);
    }
    Ok(choice)
}

/// The criterion `published`, or `KEY=VALUE,...`; omitted keys have their defaults.
///
/// # Errors
/// The error with key, value and range.
pub(super) fn fall(text: &str) -> Result<FallCriterion, String> {
    let mut fall = FallCriterion::default();
    if text == "published" {
        return Ok(FallCriterion::PUBLISHED);
    }
    let mut lasting_s = None;
    for pair in pairs(text) {
        let (key, value) = pair?;
        match key {
            "roll" => fall.roll_rad = angle(value)?,
            "steer" => fall.steer_rad = angle(value)?,
            "flat" if value == NONE => fall.flat = None,
            "flat" => {
                let roll_rad = angle(value)?;
                fall.flat = fall.flat.map(|flat| LaidFlat { roll_rad, ..flat });
            }
            "lasting" => lasting_s = Some(time(value, 10.0).map_err(|e| e.to_string())?),
            _ => {
                return Err(format!(
                    "unknown key `{key}`; expected roll, steer, flat=ANGLE, lasting=TIME, or published"
                ));
            }
        }
    }
    match (lasting_s, &mut fall.flat) {
        (Some(lasting_s), Some(flat)) => flat.lasting_s = lasting_s,
        (Some(_), None) => {
            return Err("lasting needs flat=ANGLE; it cannot be combined with flat=none".into());
        }
        (None, _) => {}
    }
    fall.check().map(|()| fall).map_err(|e| e.to_string())
}

/// An angle with its unit, as \[rad\].
fn angle(text: &str) -> Result<f64, String> {
    let wrong = || format!("`{text}` is not an angle; expected a number with its unit, as 80deg or 1.4rad");
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong);
    match text.strip_suffix("deg") {
        Some(degrees) => number(degrees).map(f64::to_radians),
        None => number(text.strip_suffix("rad").ok_or_else(wrong)?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_can_be_typed() {
        assert_eq!(fall("roll=90deg,steer=90deg,flat=80deg,lasting=1s"), Ok(FallCriterion::default()));
        assert_eq!(fall("flat=none"), Ok(FallCriterion::PUBLISHED));
        assert_eq!(fall("published"), Ok(FallCriterion::PUBLISHED));
    }

    #[test]
    fn nonsense_is_refused_with_the_reason() {
        for text in [
            "",
            "roll",
            "roll=90",
            "roll=91deg",
            "roll=0deg",
            "roll=nandeg",
            "steer=-45deg",
            "flat=2rad",
            "yaw=1rad",
            "lasting=0s",
            "lasting=1",
            "flat=none,lasting=1s",
        ] {
            assert!(fall(text).is_err_and(|error| !error.is_empty()), "{text}");
        }
    }
}
