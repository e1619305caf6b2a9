//! Parses values of a scenario from text, as on the command line and in the axes of a sweep.

use super::content::{Content, NONE, OrNone};
use super::plant::{ActuatorChoice, PlantChoice, SensorChange, sensor_named};
use super::text_error::TextError;
use super::ticks::{LONGEST_S, LONGEST_SENSOR_S};
use crate::range::time;
use crate::ride::{FallCriterion, LaidFlat};
use serde::de::IntoDeserializer;
use serde::de::value::{Error, StrDeserializer};

/// An error about a text of another form.
pub(super) fn form(text: &str, wrong: &'static str) -> TextError {
    TextError::Form { text: text.into(), wrong }
}

/// A number.
pub(super) fn number(text: &str) -> Result<f64, TextError> {
    text.trim().parse().map_err(|_| form(text, "not a number"))
}

/// The shortest decimal number that is the same single: 0.1, not 0.10000000149011612.
pub(super) fn decimal(x: f32) -> f64 {
    x.to_string().parse().unwrap_or_else(|_| f64::from(x))
}

/// A whole number.
pub(super) fn whole<T: std::str::FromStr>(text: &str) -> Result<T, TextError> {
    text.trim().parse().map_err(|_| form(text, "not a whole number in range"))
}

/// A seed of random numbers, from 0 to 2^63 - 1.
///
/// # Errors
/// The text is no such number.
pub fn seed(text: &str) -> Result<u64, TextError> {
    // TOML has no larger whole numbers.
    let seed = whole(text).ok().filter(|seed| *seed <= i64::MAX as u64);
    seed.ok_or_else(|| TextError::Seed(text.into()))
}

/// A word among those of an enum.
pub(super) fn word<'a, T: serde::Deserialize<'a>>(text: &'a str) -> Result<T, TextError> {
    let deserializer: StrDeserializer<'a, Error> = text.into_deserializer();
    Ok(T::deserialize(deserializer)?)
}

/// A number or none.
pub(super) fn limit(text: &str) -> Result<OrNone<f64>, TextError> {
    match text {
        NONE => Ok(OrNone::Off),
        _ => text.parse().map(OrNone::At).map_err(|_| form(text, "neither a number nor none")),
    }
}

/// `ZERO:FULL` or none.
pub(super) fn taper(text: &str) -> Result<OrNone<[f64; 2]>, TextError> {
    if text == NONE {
        return Ok(OrNone::Off);
    }
    let speeds = text.split_once(':').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    speeds.map(OrNone::At).ok_or_else(|| form(text, "neither ZERO:FULL in m/s nor none"))
}

/// `KEY=VALUE`.
pub(super) fn pair(text: &str) -> Result<(&str, &str), TextError> {
    text.split_once('=').ok_or(TextError::Pair)
}

/// The pairs of `KEY=VALUE,...`.
fn pairs(text: &str) -> impl Iterator<Item = Result<(&str, &str), TextError>> {
    text.split(',').map(|pair| pair.split_once('=').ok_or_else(|| form(pair, "not KEY=VALUE")))
}

fn keyed(key: &str, value: &str) -> Result<f64, TextError> {
    value.trim().parse().map_err(|_| TextError::Number { key: key.into(), value: value.into() })
}

/// An error about an unknown key.
fn unknown(key: &str, place: &'static str, known: &'static str) -> TextError {
    TextError::Key { key: key.into(), place, known }
}

/// Adds one `MODEL+...`, `NAME[.AXIS]:KEY=VALUE,...` or `imu:KEY=VALUE,...`; none removes all models.
pub(super) fn sensor(plant: &mut PlantChoice, text: &str) -> Result<(), TextError> {
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
            "delay" => change.delay_s = Some(time(value, LONGEST_SENSOR_S)?),
            "every" => change.every_s = Some(time(value, LONGEST_SENSOR_S)?),
            "bias" => change.bias = Some(keyed(key, value)?),
            "scale" => change.scale = Some(keyed(key, value)?),
            "noise" => change.noise = Some(keyed(key, value)?),
            "quantum" => change.quantum = Some(keyed(key, value)?),
            "range" => change.range = Some(keyed(key, value)?),
            "dropout" => change.dropout = Some(keyed(key, value)?),
            _ => {
                return Err(unknown(
                    key,
                    "",
                    "model=NAME|FILE, delay=TIME, every=TIME, noise, bias, scale, quantum, range, dropout",
                ));
            }
        }
    }
    plant.sensors.push(change);
    Ok(())
}

fn mount(plant: &mut PlantChoice, key: &str, value: &str) -> Result<(), TextError> {
    let [x, y, z] = &mut plant.imu.point_m;
    let [roll, pitch, yaw] = &mut plant.imu.turned_rad;
    let place = match key {
        "x" => x,
        "y" => y,
        "z" => z,
        "roll" => roll,
        "pitch" => pitch,
        "yaw" => yaw,
        _ => return Err(unknown(key, " of the imu", "x, y, z in m, roll, pitch, yaw in rad")),
    };
    *place = keyed(key, value)?;
    Ok(())
}

/// The actuator of `NAME|FILE|KEY=VALUE,...`.
pub(super) fn actuator(text: &str) -> Result<ActuatorChoice, TextError> {
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
                choice.delay_s = Some(time(value, LONGEST_S)?);
                continue;
            }
            "time-constant" => {
                choice.time_constant_s = Some(time(value, 10.0)?);
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
                return Err(unknown(
                    key,
                    "",
                    "delay=TIME, time-constant=TIME, scale, limit, viscous, coulomb, creep, stop, voltage, resistance, \
                     constant",
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
pub(super) fn fall(text: &str) -> Result<FallCriterion, TextError> {
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
            "lasting" => lasting_s = Some(time(value, 10.0)?),
            _ => return Err(unknown(key, "", "roll, steer, flat=ANGLE, lasting=TIME, or published")),
        }
    }
    match (lasting_s, &mut fall.flat) {
        (Some(lasting_s), Some(flat)) => flat.lasting_s = lasting_s,
        (Some(_), None) => return Err(TextError::Lasting),
        (None, _) => {}
    }
    fall.check()?;
    Ok(fall)
}

/// An angle with its unit, as \[rad\].
fn angle(text: &str) -> Result<f64, TextError> {
    let wrong = || form(text, "not an angle; expected a number with its unit, as 80deg or 1.4rad");
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
            assert!(fall(text).is_err_and(|error| !error.to_string().is_empty()), "{text}");
        }
    }
}
