//! Time stamps: seconds, or a date with a time of day.

/// A time stamp in seconds; a date in seconds since 1970-01-01, in UTC unless it names a time zone.
pub(crate) fn seconds(text: &str) -> Option<f64> {
    match text.parse::<f64>() {
        Ok(number) => number.is_finite().then_some(number),
        Err(_) => date_time(text),
    }
}

fn date_time(text: &str) -> Option<f64> {
    let instant = |nanoseconds: i128| nanoseconds as f64 * 1e-9;
    let zoned = || text.parse::<jiff::Timestamp>().ok().map(|time| instant(time.as_nanosecond()));
    let plain: Result<jiff::civil::DateTime, _> = text.parse();
    let utc = |time: jiff::civil::DateTime| time.to_zoned(jiff::tz::TimeZone::UTC).ok();
    // A date without a time is no time stamp.
    let plain = plain.ok().filter(|_| text.contains(':')).and_then(utc);
    plain.map(|time| instant(time.timestamp().as_nanosecond())).or_else(zoned)
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
    }

    #[test]
    fn nonsense_is_none() {
        for text in ["", "nan", "inf", "2023-05-12", "2023-13-01 00:00:00", "yesterday", "10:54:44", "1 2"] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
