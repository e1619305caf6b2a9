//! Lines of candump.

use super::written;
use sim_host::recording::candump::{is_one, parse};
use sim_host::recording::frames::{Frame, Id};

fn id(number: u32, extended: bool) -> Id {
    Id { number, extended }
}

/// Situation: one line of each kind that can-utils write: classic, extended, CAN FD, no bytes, the direction after
/// it, the code for the length; a remote frame, an error frame.
/// Action: read.
/// Must hold: time, bus, identifier and bytes as written; frames without data counted, no other message.
#[test]
fn every_kind_of_line_is_read() {
    let text = "(1436509052.249713) can0 123#DEADBEEF\n(1436509052.249714) can0 00000123#01\n\
                (1436509052.3) vcan1 7FF##3000102030405060708090A0B T\n(1436509053.000000) can0 000# R\n\
                (1436509053.5) can0 1FFFFFFF#1122334455667788_B\n\n(1436509054.0) can0 123#R\n\
                (1436509054.1) can0 00000123#R8\n(1436509054.2) can0 20000080#0000000000000000\n";
    assert!(is_one(text));
    let frames = parse(text).unwrap();
    let all: Vec<Frame> = frames.iter().collect();
    let fd: Vec<u8> = (0..12).collect();
    let expected = [
        (1_436_509_052.249_713, 1, 0, id(0x123, false), &[0xde, 0xad, 0xbe, 0xef][..]),
        (1_436_509_052.249_714, 2, 0, id(0x123, true), &[1]),
        (1_436_509_052.3, 3, 1, id(0x7ff, false), &fd),
        (1_436_509_053.0, 4, 0, id(0, false), &[]),
        (1_436_509_053.5, 5, 0, id(0x1fff_ffff, true), &[0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88]),
    ];
    assert_eq!(all.len(), expected.len());
    for (got, (time_s, line, bus, id, data)) in all.iter().zip(expected) {
        assert_eq!(*got, Frame { time_s, line, bus, id, data });
    }
    assert_eq!(
        (frames.remote, frames.errors, frames.buses),
        (2, 1, vec!["can0".to_owned(), "vcan1".to_owned()])
    );
    assert_eq!(frames.remarks, []);
}

/// Situation: the lines for the screen: absolute times, a date, with the text of `-x`, letters after the bytes.
/// Action: read.
/// Must hold: the same frames; the date is universal time.
#[test]
fn lines_for_the_screen_are_read_where_their_times_are_clear() {
    let text = " (1700000000.000001)  can0  123   [3]  01 02 03\n \
                (2023-11-14 22:13:20.500000)  can0  00000123   [2]  DE AD   '..'\n \
                (1700000001.000000)  can0  RX - -  123  [12]  00 01 02 03 04 05 06 07 08 09 0A 0B\n \
                (1700000002.000000)  can0  123   [0]  remote request\n \
                (1700000002.000000)  can0  20000080   [8]  00 00 00 00 00 00 00 00   ERRORFRAME\n";
    let frames = parse(text).unwrap();
    let all: Vec<(f64, Id, usize)> =
        frames.iter().map(|frame| (frame.time_s, frame.id, frame.data.len())).collect();
    let expected =
        [(1_700_000_000.000_001, false, 3), (1_700_000_000.5, true, 2), (1_700_000_001.0, false, 12)];
    assert_eq!(all, expected.map(|(time_s, extended, bytes)| (time_s, id(0x123, extended), bytes)));
    assert_eq!((frames.remote, frames.errors, frames.remarks), (1, 1, Vec::new()));
}

/// Situation: lines for the screen whose times begin at 0 and rise; the same that fall; lines without any time.
/// Action: read.
/// Must hold: the first are read; the others are rejected with the line and the way to record.
#[test]
fn ambiguous_times_are_rejected() {
    let rising = " (000.000000)  can0  304   [2]  90 01\n (000.009000)  can0  304   [2]  90 01\n";
    let falling = format!("{rising} (000.008000)  can0  304   [2]  90 01\n");
    assert_eq!(parse(rising).unwrap().len(), 2);
    let error = parse(&falling).unwrap_err();
    assert_eq!(error.line, Some(3));
    assert!(error.what.contains("candump -t d") && error.what.contains("candump -L"), "{error}");
    let error = written("a.log", "  can0  304   [2]  90 01\n", &["ride.dbc"]).unwrap_err();
    assert_eq!(error, "a.log: line 1: has no time stamp; record with `candump -L`");
}

/// Situation: damaged lines of every kind between good ones, the last one cut; a time that jumps back.
/// Action: read.
/// Must hold: each of the first three is named with its line, the rest counted; the good frames are all there, the
/// jump as recorded.
#[test]
fn only_damaged_lines_are_lost() {
    let bad = [
        "(1.0) can0 12#00",
        "(1.0) can0 800#00",
        "(1.0) can0 123#0",
        "(1.0) can0 123#0g",
        "(1.0) can0 123#001122334455667788",
        "(1.0) can0 123##",
        "(1.0) can0 123###00",
        "(x) can0 123#00",
        "(1.0) can0",
        "(1.0 can0 123#00",
        "ERROR: no such device",
        "(1.0) can0 123#00 what",
        "(1.0) can0  123  [9",
        "(1.0) can0  123  [2] 00",
        "(1.0) can0 3FFFFFFFF#00",
        "(1.0) can0 7FFFFFFFé#00",
    ];
    let good = "(2.5) can0 304#9001\n";
    for line in bad {
        let frames = parse(&format!("{good}{line}\n(2.0) can0 304#9101\n")).unwrap();
        let times_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
        assert_eq!(times_s, [2.5, 2.0], "{line}");
        assert_eq!(frames.remarks.len(), 1, "{line}");
        assert_eq!(frames.remarks[0].line, Some(2), "{line}");
    }
    let all = format!("{good}{}\n(3.0) can0 304#9", bad.join("\n"));
    let frames = parse(&all).unwrap();
    let remarks: Vec<String> = frames.remarks.iter().map(ToString::to_string).collect();
    assert_eq!(remarks.len(), 4, "{remarks:?}");
    assert!(remarks[0].starts_with("line 2: ") && remarks[2].starts_with("line 4: "), "{remarks:?}");
    assert_eq!(remarks[3], "14 more lines that are no frame; left out");
    let cut = parse("(2.5) can0 304#9001\n(3.0) can0 304#9").unwrap();
    assert_eq!(
        cut.remarks[0].to_string(),
        "line 2: half a byte is missing, the file ends within it; left out"
    );
    assert_eq!(parse(bad[0]).unwrap_err().line, Some(1));
}
