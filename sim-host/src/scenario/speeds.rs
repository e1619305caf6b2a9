//! Parses ranges of speeds: `A:B:STEP` with B included, or a single value.

/// The speeds in a text \[m/s\], at least 0.
pub fn parse(text: &str) -> Result<Vec<f64>, String> {
    within(text, 0.0)
}

/// The speeds in a text \[m/s\], including negative ones.
pub fn parse_signed(text: &str) -> Result<Vec<f64>, String> {
    within(text, -30.0)
}

fn within(text: &str, least: f64) -> Result<Vec<f64>, String> {
    let number = |part: &str| {
        part.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
            format!("`{part}` is not a number; expected A:B:STEP in m/s, for example 0:10:0.1, or one speed")
        })
    };
    let parts: Vec<&str> = text.split(':').collect();
    let speeds = match parts[..] {
        // Adding zero turns -0 into 0.
        [one] => vec![number(one)? + 0.0],
        [from, to, step] => {
            let (from, to, step) = (number(from)?, number(to)?, number(step)?);
            if step < 1e-6 || to < from {
                return Err(format!("the range {text} must rise, in steps of at least 0.000001 m/s"));
            }
            let n = ((to - from) / step + 1e-9).floor();
            if n > 1e5 {
                return Err(format!("the range {text} has {n} speeds; at most 100000"));
            }
            // Rounded to a billionth, so that steps of 0.1 give 0.3 and not 0.30000000000000004.
            (0..=n as usize).map(|i| ((from + i as f64 * step) * 1e9).round() / 1e9 + 0.0).collect()
        }
        _ => return Err(format!("expected A:B:STEP or one speed, not {text}")),
    };
    match speeds.iter().find(|v| !(least..=30.0).contains(*v)) {
        Some(v) => Err(format!("speed {v} m/s is outside {least} to 30")),
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
