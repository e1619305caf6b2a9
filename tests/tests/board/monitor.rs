//! Evaluation of a board's messages.

use crate::client::SHORT;
use control::{Sample, sensors::frame::MISSING};
use link::message::Message;
use link::telemetry::Telemetry;
use sim_host::board::Client;
use sim_host::board::monitor::{Monitor, News};
use sim_host::board::recorded::{Recorder, Recording};
use sim_host::board::telemetry_row::TelemetryRow;
use sim_host::board::transport::{Transport, TransportError};
use std::time::Duration;
use tempfile::TempDir;
use tests::link_board::{LinkBoard, telemetry};

/// Bytes that arrive in pieces of this size, then the end.
struct Pieces(Vec<u8>, usize);

impl Transport for Pieces {
    fn send(&mut self, _: &[u8]) -> Result<(), TransportError> {
        Err(TransportError::OneWay { line: "pieces".into() })
    }
    fn receive(&mut self, _: Duration) -> Result<Vec<u8>, TransportError> {
        if self.0.is_empty() {
            return Err(TransportError::Ended { line: "pieces".into(), rest: 0 });
        }
        let length = self.1.min(self.0.len());
        Ok(self.0.drain(..length).collect())
    }
}

/// All messages of a line until its end, and the number of damaged frames.
fn hear(line: Box<dyn Transport>) -> (Monitor, Vec<News>, u32) {
    let (mut client, mut monitor, mut news) = (Client::new(line, SHORT), Monitor::default(), Vec::new());
    while let Ok(received) = client.listen(Duration::ZERO) {
        news.extend(received.iter().map(|one| monitor.take(one)));
    }
    (monitor, news, client.damaged())
}

fn step(board: &mut LinkBoard, steps: u32) -> Vec<u8> {
    board.unsolicited(&Message::Telemetry(telemetry(steps)))
}

/// Situation: 400 steps; three frames are lost, one is damaged; in pieces of any size.
/// Action: receive.
/// Must hold: 396 frames, four missing by their numbers, one of them damaged; the clock at the last step; no restart.
#[test]
fn missing_and_damaged_frames_are_counted() {
    let mut board = LinkBoard::default();
    let mut bytes = Vec::new();
    for i in 1..=400 {
        let mut frame = step(&mut board, 20 * i);
        match i {
            7 | 8 | 300 => continue,
            50 => frame[40] ^= 0x55,
            _ => {}
        }
        bytes.extend(frame);
    }
    for piece in [1, 17, 4096] {
        let (monitor, news, damaged) = hear(Box::new(Pieces(bytes.clone(), piece)));
        assert_eq!((monitor.frames, monitor.missing, monitor.restarts, damaged), (396, 4, 0, 1), "{piece}");
        assert!((monitor.t - 8.0).abs() < 1e-9, "{}", monitor.t);
        assert_eq!(news.len(), 396);
    }
}

/// Situation: steps every 20 ms, log texts now and then; nothing arrives for so long that the frames' numbers wrap
/// around, once and twice.
/// Action: receive.
/// Must hold: every missing frame is counted; no restart.
#[test]
fn a_long_gap_is_counted_whole() {
    for gap in [0, 5, 32_767, 32_768, 60_000, 65_535, 65_536, 70_000, 150_000_u32] {
        let (mut board, mut bytes) = (LinkBoard::default(), Vec::new());
        for i in 1..=200 {
            if i == 101 {
                board.sequence = board.sequence.wrapping_add(gap as u16);
            }
            let steps = 20 * (i + if i > 100 { gap } else { 0 });
            bytes.extend(step(&mut board, steps));
            if i % 50 == 0 {
                bytes.extend(board.unsolicited(&Message::Log("text")));
            }
        }
        let (monitor, ..) = hear(Box::new(Pieces(bytes, 4096)));
        assert_eq!((monitor.frames, monitor.missing, monitor.restarts), (204, gap.into(), 0));
    }
}

/// Situation: the board's clock and step count wrap around; later it restarts.
/// Action: receive.
/// Must hold: time continues over the wrap; the restart is counted, is no gap, and its time begins again.
#[test]
fn a_clock_continues_over_its_wrap_and_a_restart_is_reported() {
    let (mut board, mut bytes) = (LinkBoard::default(), Vec::new());
    let at = |now_us: u32, steps: u32| {
        let mut step = telemetry(steps);
        step.frame.now_us = now_us;
        step
    };
    for i in 0..10_u32 {
        let step = at((u32::MAX - 5_000).wrapping_add(i * 1_000), (u32::MAX - 5).wrapping_add(i));
        bytes.extend(board.unsolicited(&Message::Telemetry(step)));
    }
    let before = f64::from(u32::MAX - 5_000) * 1e-6;
    let (monitor, ..) = hear(Box::new(Pieces(bytes.clone(), 100)));
    assert!((monitor.t - before - 0.009).abs() < 1e-6 && monitor.restarts == 0, "{monitor:?}");
    board.sequence = 0;
    bytes.extend((1..=3_u32).flat_map(|i| board.unsolicited(&Message::Telemetry(at(i * 1_000, i)))));
    let (monitor, ..) = hear(Box::new(Pieces(bytes, 100)));
    assert_eq!((monitor.frames, monitor.missing, monitor.restarts), (13, 0, 1));
    assert!((monitor.t - 0.003).abs() < 1e-9, "{}", monitor.t);
}

/// Situation: a fault, a log text, and an unknown kind, between two steps.
/// Action: receive.
/// Must hold: each is reported as its kind; none is a gap.
#[test]
fn faults_and_texts_are_reported() {
    let mut board = LinkBoard::default();
    let mut bytes = step(&mut board, 1);
    bytes.extend(board.unsolicited(&Message::Fault(tests::link_board::faults()[4])));
    bytes.extend(board.unsolicited(&Message::Log("steer sensor found")));
    let mut frame = [0; link::frame::MAX_FRAME];
    let used = link::frame::encode(0xbf, 3, &[1, 2, 3], &mut frame).expect("room");
    bytes.extend(&frame[..used]);
    let (monitor, news, damaged) = hear(Box::new(Pieces(bytes, 64)));
    assert!(matches!(&news[0], News::Step(_)));
    assert!(matches!(&news[1], News::Fault(fault) if fault.kind == "panic" && fault.boot == 1));
    assert_eq!(news[2..], [News::Log("steer sensor found".into()), News::Unknown]);
    assert_eq!((monitor.missing, damaged), (0, 0));
}

/// Situation: a line that is recorded.
/// Action: read it; then read the recording.
/// Must hold: the same, message by message and byte by byte up to the last end of a frame; a recording answers
/// nothing, and the error says so.
#[test]
fn a_recording_has_the_received_messages() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("ride.link");
    let mut board = LinkBoard::default();
    let mut bytes: Vec<u8> = (1..=90).flat_map(|i| step(&mut board, i)).collect();
    bytes.truncate(bytes.len() - 3);
    let file = Box::new(std::fs::File::create(&path).expect("a file"));
    let pieces = Box::new(Pieces(bytes.clone(), 333));
    let (live, news, _) = hear(Box::new(Recorder::new(pieces, "ride.link", file)));
    let whole = bytes.iter().rposition(|byte| *byte == 0).expect("an end") + 1;
    assert_eq!(std::fs::read(&path).expect("the recording"), bytes[..whole]);
    let (replayed, again, _) = hear(Box::new(Recording::open(&path).expect("opens")));
    assert_eq!((news.len(), live.frames, replayed.frames), (89, 89, 89));
    assert_eq!(news, again);
    let mut client = Client::new(Box::new(Recording::open(&path).expect("opens")), SHORT);
    let error = client.hello().expect_err("one way").to_string();
    assert!(error.contains("ride.link is a recording"), "{error}");
}

/// Situation: a step with a different value for every sensor, and one with none.
/// Action: as a row.
/// Must hold: each value under its column with its age; empty where there is no sample; every column that `ride` has
/// as well has the same meaning.
#[test]
fn a_row_has_every_sensor_under_its_name() {
    let mut received = telemetry(7);
    let sample = |value, age_ticks| Sample { value, age_ticks };
    received.frame.accel_m_s2 = control::Triple { value: [1.0, 2.0, 3.0], age_ticks: 4 };
    received.frame.steer_rad = sample(0.1, 1);
    received.frame.steer_rate_rad_s = sample(0.2, 2);
    received.frame.rear_wheel_m_s = sample(3.9, 3);
    received.frame.rider_torque_nm = sample(0.5, 5);
    received.frame.motor_torque_nm = sample(0.6, MISSING);
    let columns =
        |received: &Telemetry| serde_json::to_value(TelemetryRow::new(0.007, received)).expect("a row");
    let row = columns(&received);
    for (column, value) in [
        ("t", 0.007),
        ("steps", 7.0),
        ("late", 2.0),
        ("mode", 4.0),
        ("limits", 4.0),
        ("torque", 1.5),
        ("gain", 6.0),
        ("measured_roll_rate", 0.25),
        ("measured_pitch_rate", -0.5),
        ("measured_yaw_rate", 0.125),
        ("gyro_age", 0.0),
        ("measured_accel_x", 1.0),
        ("measured_accel_y", 2.0),
        ("measured_accel_z", 3.0),
        ("accel_age", 4.0),
        ("measured_steer", 0.1),
        ("steer_age", 1.0),
        ("measured_steer_rate", 0.2),
        ("steer_rate_age", 2.0),
        ("measured_front_speed", 4.0),
        ("front_speed_age", 0.0),
        ("measured_rear_speed", 3.9),
        ("rear_speed_age", 3.0),
        ("measured_rider_torque", 0.5),
        ("rider_torque_age", 5.0),
        ("motor_slope", 0.5),
    ] {
        let got = row[column].as_f64().unwrap_or_else(|| panic!("{column}: {row}"));
        assert!((got - value).abs() < 1e-6, "{column} {got}");
    }
    assert_eq!(row["causes"], received.command.causes.0);
    assert!(
        ["measured_motor_torque", "motor_torque_age", "gyro_slope"].iter().all(|name| row[*name].is_null())
    );
    let none = columns(&Telemetry { frame: control::SensorFrame::missing(), ..received });
    let empty = none.as_object().expect("columns").values().filter(|value| value.is_null()).count();
    assert_eq!(empty, 20 + 1, "the sensors, their ages and a slope: {none}");
}
