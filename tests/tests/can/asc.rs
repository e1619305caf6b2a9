//! Lines of ASC.

use sim_host::recording::asc::{is_one, parse};
use sim_host::recording::frames::{Frame, Id};

const HEADER: &str = "date Mit Jun 7 10:00:00.000 am 2023\r\nbase hex  timestamps absolute\r\n\
                      internal events logged\r\n// version 9.0.0\r\nBegin Triggerblock Mit Jun 7 10:00:00.000 am 2023\r\n\
                      \x20  0.000000 Start of measurement\r\n";

fn id(number: u32, extended: bool) -> Id {
    Id { number, extended }
}

/// Situation: events of every kind that Vector's tools write, with the fields after the bytes.
/// Action: read.
/// Must hold: time, bus, identifier and bytes as written; remote and error frames counted; all others skipped without
/// a message.
#[test]
fn every_kind_of_event_is_read_or_skipped() {
    let text = format!(
        "{HEADER}   0.010000 1  123             Rx   d 4 DE AD BE EF  Length = 264000 BitCount = 138 ID = 291\r\n\
         \x20  0.020000 2  1FFFFFFFx       Tx   d 8 00 01 02 03 04 05 06 07\r\n\
         \x20  0.030000 1  7ff             Rx   d 0\r\n\
         \x20  0.035000 1  123             Rx   d f 00 01 02 03 04 05 06 07\r\n\
         \x20  0.040000 CANFD   1 Rx        1F0   Speed_Message               1 0 9 12 00 01 02 03 04 05 06 07 08 09 0a 0b   130000  130   303000 e0006659 46500250 4b140250 20011736 2001040d\r\n\
         \x20  0.050000 CANFD   3 Tx      18FF1234x                                 0 0 2  2 AA BB 0 0 1000 0 0 0 0 0\r\n\
         \x20  0.060000 1  123             Rx   r 8 Length = 1704000\r\n\
         \x20  0.070000 1  ErrorFrame\r\n   0.075000 CANFD   1 Rx   ErrorFrame  Not Acknowledge error\r\n\
         \x20  0.080000 1  Statistic: D 8 R 0 XD 0 XR 0 E 0 O 0 B 1.28%\r\n\
         \x20  0.090000 CAN 1 Status:chip status error active\r\n   0.1 Li 1 RcvError\r\n\
         \x20  0.110000 1  J1939TP FEE3p 6 0 0 - Rx d 23 A0 0F\r\n   0.120000 log trigger event\r\n\
         End TriggerBlock\r\n"
    );
    assert!(is_one(&text));
    let frames = parse(&text).unwrap();
    let (eight, twelve): (Vec<u8>, Vec<u8>) = ((0..8).collect(), (0..12).collect());
    let expected = [
        (0.01, 7, 0, id(0x123, false), &[0xde, 0xad, 0xbe, 0xef][..]),
        (0.02, 8, 1, id(0x1fff_ffff, true), &eight),
        (0.03, 9, 0, id(0x7ff, false), &[]),
        (0.035, 10, 0, id(0x123, false), &eight),
        (0.04, 11, 0, id(0x1f0, false), &twelve),
        (0.05, 12, 2, id(0x18ff_1234, true), &[0xaa, 0xbb]),
    ];
    let all: Vec<Frame> = frames.iter().collect();
    assert_eq!(frames.remarks, []);
    assert_eq!(all.len(), expected.len());
    for (got, (time_s, line, bus, id, data)) in all.iter().zip(expected) {
        assert_eq!(*got, Frame { time_s, line, bus, id, data });
    }
    assert_eq!((frames.remote, frames.errors), (1, 2));
    assert_eq!(frames.buses, ["1", "2", "3"]);
}

/// Situation: decimal identifiers and bytes, times relative to the previous event, an event that is no frame in
/// between.
/// Action: read.
/// Must hold: the numbers are decimal, and the times are summed over all events.
#[test]
fn decimal_numbers_and_relative_times() {
    let text = "date Wed Jun 7 10:00:00 2023\nbase dec timestamps relative\n   0.500000 Start of measurement\n   \
                0.100000 1  291  Rx d 2 222 173\n   0.250000 CAN 1 Status:chip status error active\n   \
                0.150000 1  536870911x  Rx d 1 255\n";
    let frames = parse(text).unwrap();
    let all: Vec<Frame> = frames.iter().collect();
    assert_eq!(
        (all[0].id, all[0].data, all[1].id, all[1].data),
        (id(0x123, false), &[0xde, 0xad][..], id(0x1fff_ffff, true), &[0xff][..])
    );
    assert!((all[0].time_s - 0.6).abs() < 1e-12 && (all[1].time_s - 1.0).abs() < 1e-12, "{all:?}");
    let absolute = text.replace("relative", "absolute");
    let times_s: Vec<f64> = parse(&absolute).unwrap().iter().map(|frame| frame.time_s).collect();
    assert_eq!(times_s, [0.1, 0.15]);
}

/// Situation: damaged lines of every kind between good ones; a log without a header.
/// Action: read.
/// Must hold: each is named with its line, the good ones are there; without a header it is hexadecimal.
#[test]
fn only_damaged_lines_are_lost() {
    for line in [
        "0.5 1 123 Rx d",
        "0.5 1 123 Rx d 3 01 02",
        "0.5 1 123 Rx d 3 01 02 0g",
        "0.5 1 123 Rx d 3 01 02 100",
        "0.5 1 123 Rx d 10 01 02 00",
        "0.5 1 800 Rx d 1 00",
        "0.5 1 20000000x Rx d 1 00",
        "0.5 1 EngineData Rx d 1 00",
        "0.5 1 123 Rx",
        "0.5 1 123",
        "0.5 1",
        "0.5",
        "0.5 1 123 ?x d 1 00",
        "0.5 CANFD 1 Rx 123 1 0 9",
        "0.5 CANFD 1 Rx 123 1 0 9 65 00",
        "0.5 CANFD 1 Rx 123 1 0 9 12 00 01",
        "1 123 Rx d 1 00",
        "something else",
    ] {
        let text = format!("0.4 1 304 Rx d 2 90 01\n{line}\n0.3 1 304 Tx d 2 91 01\n");
        assert!(is_one(&text));
        let frames = parse(&text).unwrap();
        let times_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
        assert_eq!(times_s, [0.4, 0.3], "{line}");
        let lines: Vec<Option<u64>> = frames.remarks.iter().map(|remark| remark.line).collect();
        assert_eq!(lines, [Some(2)], "{line}");
    }
    let error = parse("base hex timestamps absolute\n").unwrap_err();
    assert_eq!(error.to_string(), "no data frame in it");
}
