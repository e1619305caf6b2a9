//! The option that defines a fall.

use super::plant_args::pairs;
use crate::range::time;
use crate::ride::FallCriterion;

/// The fall option of every command that rides.
#[derive(clap::Args)]
pub(super) struct FallArg {
    /// Fall: roll or steer passes these angles, or the bicycle lies flat short of them for a time after the flat angle
    /// of roll; published has no flat
    #[arg(long, value_name = "KEY=VALUE,...|published", default_value = "roll=90deg,steer=90deg,flat=80deg,lasting=1s", value_parser = parse, allow_hyphen_values = true)]
    pub(super) fall: FallCriterion,
}

/// The criterion `published`, or `KEY=VALUE,...`; omitted keys have their defaults.
///
/// # Errors
/// The error with key, value and range.
fn parse(text: &str) -> Result<FallCriterion, String> {
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
            "flat" if value == "none" => fall.flat = None,
            "flat" => {
                let roll_rad = angle(value)?;
                fall.flat = fall.flat.map(|flat| crate::ride::LaidFlat { roll_rad, ..flat });
            }
            "lasting" => lasting_s = Some(time(value, 10.0)?),
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
    fall.check()?;
    Ok(fall)
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
        assert_eq!(parse("roll=90deg,steer=90deg,flat=80deg,lasting=1s"), Ok(FallCriterion::default()));
        assert_eq!(parse("flat=none"), Ok(FallCriterion::PUBLISHED));
        assert_eq!(parse("published"), Ok(FallCriterion::PUBLISHED));
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
            assert!(parse(text).is_err_and(|error| !error.is_empty()), "{text}");
        }
    }
}
