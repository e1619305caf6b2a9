//! Every signal of every frame, compared with the value of cantools.

use super::{column, file, group, recorded, remarks, same};
use sim_host::recording::Recording;
use std::collections::BTreeMap;

/// Values by message and signal, in the order of the frames; only those of the first `frames` frames.
fn expected(name: &str, frames: u64) -> BTreeMap<(String, String), Vec<f64>> {
    let text = std::fs::read_to_string(file(&format!("{name}.expected.csv"))).unwrap();
    let mut all: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let [frame, message, signal, value] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        if frame.parse::<u64>().unwrap() <= frames {
            all.entry((message.to_owned(), signal.to_owned())).or_default().push(value.parse().unwrap());
        }
    }
    all
}

/// Number of values; all are those of cantools, and there are no others.
fn compared(recording: &Recording, expected: &BTreeMap<(String, String), Vec<f64>>) -> usize {
    for ((message, signal), values) in expected {
        let got = column(group(recording, message), signal);
        assert!(same(got, values), "{message}.{signal}: {got:?}, expected {values:?}");
    }
    let columns: usize = recording.groups.iter().map(|group| group.columns.len()).sum();
    assert_eq!(columns, expected.len());
    expected.values().map(Vec::len).sum()
}

/// Situation: a short ride of messages of 100 Hz, 0.25 ms apart, the steer sensor's 4 ms earlier, in each format.
/// Action: read with its database.
/// Must hold: every one of the 280 values is that of cantools, a steer angle and a speed that are not available are NaN,
/// and the times are those of the frames to 1 us.
#[test]
fn a_ride_is_the_same_in_every_format() {
    let expected = expected("ride", u64::MAX);
    for (name, start_s) in [
        ("ride.log", 1_700_000_000.0),
        ("ride.long.log", 1_700_000_000.0),
        ("ride.asc", 0.0),
        ("ride.blf", 1_700_000_000.0),
        ("ride.mf4", 0.0),
    ] {
        let recording = recorded(name, &["ride.dbc"]).unwrap();
        assert_eq!(compared(&recording, &expected), 280, "{name}");
        assert_eq!(remarks(&recording), [] as [String; 0], "{name}");
        for (message, first_s) in [("LWS_Standard", 0.0), ("Gyro", 0.004_25), ("RearWheel", 0.005)] {
            let times_s = group(&recording, message).times_s.clone().unwrap();
            assert_eq!(times_s.len(), 20);
            for (k, time_s) in times_s.iter().enumerate() {
                let due_s = start_s + first_s + 0.01 * k as f64;
                assert!((time_s - due_s).abs() < 1.5e-6, "{name} {message} {k}: {time_s}");
            }
        }
        let steer = column(group(&recording, "LWS_Standard"), "LWS_ANGLE");
        assert!(steer[7].is_nan() && steer.iter().filter(|x| x.is_nan()).count() == 1, "{steer:?}");
        let units: Vec<&str> =
            group(&recording, "LWS_Standard").columns.iter().map(|column| column.unit.as_str()).collect();
        assert_eq!(units, ["deg", "deg/s", "", ""]);
    }
}

/// Situation: any bytes in messages of every kind: both byte orders, across bytes, signed, of 64 bits, floating-point
/// numbers, pages, pages in pages, CAN FD, extended identifiers, one of them 0.
/// Action: read in each format with the database, whose text is Windows-1252.
/// Must hold: every value is that of cantools in every bit; frames in no database, remote and error frames are
/// counted.
#[test]
fn odd_messages_are_the_same_in_every_format() {
    let expected = expected("odd", u64::MAX);
    for name in ["odd.log", "odd.asc", "odd.blf", "odd.mf4", "log2asc.asc"] {
        let recording = recorded(name, &["odd.dbc"]).unwrap();
        assert_eq!(compared(&recording, &expected), 222, "{name}");
        assert_eq!(
            remarks(&recording),
            [
                "frames of 0x555 are in no database: 2; left out",
                "remote frames, which have no data: 1; left out",
                "error frames: 1; left out",
                "message Mixed: frames that end before its signals do: 1; these are blank there",
            ],
            "{name}"
        );
        assert_eq!(group(&recording, "Mixed").columns[0].unit, "°/s");
    }
}

/// Situation: the first 60 of these frames as a logger writes them, records of all groups in order of arrival:
/// finished, not finished, and finished and sorted by asammdf.
/// Action: read.
/// Must hold: the same values; the unfinished one is reported as such.
#[test]
fn a_loggers_file_has_the_same_values_finished_or_not() {
    let expected = expected("odd", 60);
    for name in ["logger.mf4", "unsorted.mf4", "sorted.mf4"] {
        let recording = recorded(name, &["odd.dbc"]).unwrap();
        assert!(compared(&recording, &expected) > 120, "{name}");
        let finished: Vec<String> =
            remarks(&recording).into_iter().filter(|remark| remark.contains("not finished")).collect();
        assert_eq!(finished.len(), usize::from(name == "logger.mf4"), "{name}");
        assert_eq!(remarks(&recording).len(), finished.len(), "{name}: {:?}", remarks(&recording));
    }
}

/// Situation: logs as text. Action: read. Must hold: each row has the line of its frame.
#[test]
fn rows_have_the_lines_of_their_frames() {
    for (name, id) in [("ride.log", " 301#"), ("ride.long.log", " 301 "), ("ride.asc", " 301 ")] {
        let text = std::fs::read_to_string(file(name)).unwrap();
        let lines: Vec<u64> =
            text.lines().zip(1..).filter(|(line, _)| line.contains(id)).map(|(_, number)| number).collect();
        assert_eq!(group(&recorded(name, &["ride.dbc"]).unwrap(), "Gyro").lines, lines, "{name}");
    }
    assert!(group(&recorded("ride.mf4", &["ride.dbc"]).unwrap(), "Gyro").lines.is_empty());
}
