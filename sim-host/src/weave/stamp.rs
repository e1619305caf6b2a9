//! Time stamps: seconds, or a date with a time of day.

/// The seconds that a stamp stands for, of dates those since 1970-01-01; a zone is left out of account.
pub(super) fn seconds(text: &str) -> Option<f64> {
    match text.parse::<f64>() {
        Ok(number) => number.is_finite().then_some(number),
        Err(_) => date_time(text),
    }
}

fn date_time(text: &str) -> Option<f64> {
    let (date, time) = text.split_once(['T', 't', ' '])?;
    let time = time.trim_start().trim_end_matches(['Z', 'z']);
    // A zone's sign stands after the time; it is the same in every line.
    let time = time.split(['+', '-']).next()?.trim_end();
    let [year, month, day] = parts(date, '-')?;
    let [hour, minute, second] = time.split(':').collect::<Vec<_>>().try_into().ok()?;
    let (hour, minute): (u32, u32) = (hour.parse().ok()?, minute.parse().ok()?);
    let second: f64 = second.parse().ok()?;
    let right = (1..=12).contains(&month) && (1..=31).contains(&day) && hour < 24 && minute < 60;
    let right = right && (0.0..61.0).contains(&second);
    right.then(|| 86400.0 * days(year, month, day) as f64 + f64::from(3600 * hour + 60 * minute) + second)
}

fn parts(text: &str, separator: char) -> Option<[i64; 3]> {
    let numbers = text.split(separator).map(|part| part.parse().ok()).collect::<Option<Vec<i64>>>()?;
    numbers.try_into().ok()
}

/// Days from 1970-01-01 in the Gregorian calendar, counted from March on so that the leap day ends the year.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    365 * year + year.div_euclid(4) - year.div_euclid(100)
        + year.div_euclid(400)
        + (153 * month + 2) / 5
        + day
        - 719_469
}

#[cfg(test)]
mod tests {
    use super::{days, seconds};

    #[test]
    fn stamps_are_read() {
        assert_eq!(seconds("12.5"), Some(12.5));
        assert_eq!([days(1970, 1, 1), days(2000, 3, 1), days(2024, 2, 29)], [0, 11017, 19782]);
        let at = |text| seconds(text).unwrap_or(f64::NAN);
        assert!((at("2023-05-12 10:54:44.255000000") - at("2023-05-12T10:54:44.245Z") - 0.01).abs() < 1e-6);
        assert!((at("2024-03-01 00:00:00+02:00") - at("2024-02-29 23:59:59+02:00") - 1.0).abs() < 1e-6);
    }

    #[test]
    fn nonsense_is_none() {
        for text in [
            "",
            "nan",
            "inf",
            "2023-05-12",
            "2023-13-01 00:00:00",
            "2023-05-12 10:54",
            "yesterday",
            "10:54:44",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
