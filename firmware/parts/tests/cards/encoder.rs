//! Flight cards: the encoder's words.

use parts::as5047::{ASK_ANGLE, COUNTS, angle_counts};

/// A word with bit 15 such that the number of ones is even, counted bit by bit.
fn with_parity(word: u16) -> u16 {
    let ones = (0..15).filter(|bit| word >> bit & 1 == 1).count();
    word & 0x7fff | if ones % 2 == 1 { 0x8000 } else { 0 }
}

/// Situation: the encoder tells every angle of a turn. Must hold: each is read; with any single bit wrong, none is.
#[test]
fn every_angle_is_read_and_no_damaged_one() {
    assert_eq!(with_parity(0x7fff), ASK_ANGLE, "a read of register 3fff");
    for angle in 0..COUNTS {
        let word = with_parity(angle);
        assert_eq!(angle_counts(word), Some(angle));
        for bit in 0..16 {
            assert_eq!(angle_counts(word ^ 1 << bit), None, "{angle} with bit {bit} wrong");
        }
    }
}

/// Situation: the encoder tells of an error; its wire is cut and pulled up. Must hold: no angle.
#[test]
fn an_error_is_no_angle() {
    assert_eq!(angle_counts(with_parity(0x4000 | 77)), None);
    assert_eq!(angle_counts(0xffff), None);
}
