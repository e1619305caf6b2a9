//! Parses ranges of speeds: `A:B:STEP` with B included, or a single value.

/// Largest number of speeds of a range.
const MOST: usize = 100_000;

/// Largest speed \[m/s\].
pub const FASTEST_M_S: f64 = 30.0;

/// A text that is no range of speeds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpeedsError {
    /// Not a number.
    #[error("`{0}` is not a number; expected A:B:STEP in m/s, for example 0:10:0.1, or one speed")]
    Number(String),
    /// Another form.
    #[error("expected A:B:STEP or one speed, not {0}")]
    Form(String),
    /// A falling range, or a step too small.
    #[error("the range {0} must rise, in steps of at least 0.000001 m/s")]
    Steps(String),
    /// Too many speeds.
    #[error("the range {range} has {count} speeds; at most {MOST}")]
    Many {
        /// The range.
        range: String,
        /// Number of its speeds.
        count: f64,
    },
    /// No speed.
    #[error("must be given, from {least_m_s} to {FASTEST_M_S} m/s")]
    Missing {
        /// Smallest allowed speed \[m/s\].
        least_m_s: f64,
    },
    /// A speed outside its range.
    #[error("speed {speed_m_s} m/s is outside {least_m_s} to {FASTEST_M_S}")]
    Range {
        /// The speed \[m/s\].
        speed_m_s: f64,
        /// Smallest allowed speed \[m/s\].
        least_m_s: f64,
    },
}

/// The speeds in a text \[m/s\], at least 0.
pub fn parse(text: &str) -> Result<Vec<f64>, SpeedsError> {
    within(text, 0.0)
}

/// The speeds in a text \[m/s\], including negative ones.
pub fn parse_signed(text: &str) -> Result<Vec<f64>, SpeedsError> {
    within(text, -FASTEST_M_S)
}

fn within(text: &str, least: f64) -> Result<Vec<f64>, SpeedsError> {
    let number = |part: &str| {
        let number = part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| SpeedsError::Number(part.into()))
    };
    let parts: Vec<&str> = text.split(':').collect();
    let speeds = match parts[..] {
        // Adding zero turns -0 into 0.
        [one] => vec![number(one)? + 0.0],
        [from, to, step] => {
            let (from, to, step) = (number(from)?, number(to)?, number(step)?);
            if step < 1e-6 || to < from {
                return Err(SpeedsError::Steps(text.into()));
            }
            let n = ((to - from) / step + 1e-9).floor();
            if n > MOST as f64 {
                return Err(SpeedsError::Many { range: text.into(), count: n });
            }
            // Rounded to a billionth, so that steps of 0.1 give 0.3 and not 0.30000000000000004.
            (0..=n as usize).map(|i| ((from + i as f64 * step) * 1e9).round() / 1e9 + 0.0).collect()
        }
        _ => return Err(SpeedsError::Form(text.into())),
    };
    match speeds.iter().find(|v| !(least..=FASTEST_M_S).contains(*v)) {
        Some(v) => Err(SpeedsError::Range { speed_m_s: *v, least_m_s: least }),
        None => Ok(speeds),
    }
}

#[cfg(test)]
mod tests {
    use super::{parse, parse_signed};

    #[test]
    fn ranges_include_their_end() {
        assert_eq!(parse("0:0.3:0.1"), Ok(vec![0.0, 0.1, 0.2, 0.3]));
        assert_eq!(parse("2:7.5:0.1").map(|v| (v.len(), v[55])), Ok((56, 7.5)));
        assert_eq!(parse("4"), Ok(vec![4.0]));
    }

    #[test]
    fn speeds_of_riding_backwards_are_signed() {
        assert_eq!(parse_signed("-0.2:0.1:0.1").map(|v| v.len()), Ok(4));
        assert_eq!(parse_signed("-5"), Ok(vec![-5.0]));
        assert!(parse_signed("-31").is_err() && parse("-5").is_err());
    }

    #[test]
    fn nonsense_is_refused_with_the_reason() {
        for text in ["", "a", "0:1", "0:1:0", "1:0:0.1", "0:1:-1", "-1", "31", "0:nan:1", "0:30:1e-9"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
