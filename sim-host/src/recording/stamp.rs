//! Time stamps: seconds, or a date with a time of day.

use chrono::{DateTime, NaiveDateTime};

/// A time stamp in seconds; a date in seconds since 1970-01-01, in UTC unless it has an offset from UTC.
pub(crate) fn seconds(text: &str) -> Option<f64> {
    match text.parse::<f64>() {
        Ok(number) => number.is_finite().then_some(number),
        Err(_) => date_time(text),
    }
}

/// Such a date.
pub(super) fn date_time(text: &str) -> Option<f64> {
    // ISO 8601 permits a comma, RFC 3339 lower case and a blank.
    let text = text.replace(',', ".").to_ascii_uppercase().replacen(' ', "T", 1);
    let with_offset =
        |form: &str| DateTime::parse_from_str(&text, &format!("{form}%#z")).map(|time| time.to_utc());
    let utc = |form: &str| NaiveDateTime::parse_from_str(&text, form).map(|time| time.and_utc());
    let forms = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%dT%H:%M"];
    let time = forms.iter().find_map(|form| utc(form).or_else(|_| with_offset(form)).ok())?;
    let nanoseconds =
        i128::from(time.timestamp()) * 1_000_000_000 + i128::from(time.timestamp_subsec_nanos());
    Some(nanoseconds as f64 * 1e-9)
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn stamps_are_read() {
        assert_eq!(seconds("12.5"), Some(12.5));
        let day = |text| seconds(text).map(|s| s / 86400.0);
        assert_eq!(day("1970-01-01 00:00:00"), Some(0.0));
        assert_eq!([day("2000-03-01T00:00:00"), day("2024-02-29 00:00:00Z")], [Some(11017.0), Some(19782.0)]);
        let at = |text| seconds(text).unwrap_or(f64::NAN);
        assert!((at("2023-05-12 10:54:44.255000000") - at("2023-05-12T10:54:44.245Z") - 0.01).abs() < 1e-6);
        assert!((at("2024-03-01 00:00:00+02:00") - at("2024-02-29 23:59:59+02:00") - 1.0).abs() < 1e-6);
        // The same instant in three time zones, and forms of ISO 8601.
        let noon = at("2024-02-29T12:00:00.5");
        for text in [
            "2024-02-29 12:00:00.5Z",
            "2024-02-29T14:00:00.5+02:00",
            "2024-02-29 14:00:00,5+02",
            "2024-02-29 06:30:00.500-0530",
            "2024-02-29t12:00:00.5z",
        ] {
            assert_eq!(at(text), noon, "{text}");
        }
        assert_eq!([at("2024-02-29 12:00"), at("2024-02-29T13:00+01:00")], [noon - 0.5; 2]);
    }

    #[test]
    fn nonsense_is_none() {
        for text in [
            "",
            "nan",
            "inf",
            "2023-05-12",
            "2023-13-01 00:00:00",
            "yesterday",
            "10:54:44",
            "1 2",
            "2024-02-29 24:00:00",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
