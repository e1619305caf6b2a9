//! SPI words of the encoder.

use devices::as5047::{COUNTS, FLAGGED, Line, READ_ANGLE};
use devices::vesc6::MOTOR;

/// A word with bit 15 as even parity, counted bit by bit.
fn with_parity(word: u16) -> u16 {
    let ones = (0..15).filter(|bit| word >> bit & 1 == 1).count();
    word & 0x7fff | if ones % 2 == 1 { 0x8000 } else { 0 }
}

/// The angle in one answer on a line without previous errors.
fn alone(answer: u16) -> Option<u16> {
    Line::default().step(answer)
}

/// Situation: answers with every angle of a turn. Must hold: each is decoded; with any single bit wrong, none is.
#[test]
fn every_angle_is_read_and_no_damaged_one() {
    assert_eq!(with_parity(0x7fff), READ_ANGLE, "a read of register 3fff");
    for angle in 0..COUNTS {
        let word = with_parity(angle);
        assert_eq!(alone(word), Some(angle));
        for bit in 0..16 {
            assert_eq!(alone(word ^ 1 << bit), None, "{angle} with bit {bit} wrong");
        }
    }
}

/// Situation: a frame is cut, and the next answers have the error flag: one, then all. Must hold: the first few are
/// rejected, fewer than make the motor loop raise an encoder loss; from then on all are accepted, and each is
/// counted; after the flag is cleared, the count restarts.
#[test]
fn the_error_flag_rejects_a_few_answers_only() {
    let mut line = Line::default();
    let flagged = with_parity(0x4000 | 77);
    let answers: Vec<_> = (0..1000).map(|_| line.step(flagged)).collect();
    let rejected = usize::from(FLAGGED);
    assert!(
        answers[..rejected].iter().all(Option::is_none) && answers[rejected..].iter().all(|a| *a == Some(77))
    );
    assert!(u16::from(FLAGGED) + 1 < MOTOR.encoder.timeout_calls);
    assert_eq!((line.flagged, line.damaged), (1000, 0));
    assert_eq!([with_parity(78), flagged].map(|answer| line.step(answer)), [Some(78), None]);
}

/// Situation: the encoder's wire is open and pulled up; one bit of a flagged answer is wrong. Must hold: never an
/// angle, for any duration.
#[test]
fn an_open_line_is_never_an_angle() {
    let mut line = Line::default();
    assert!((0..1000).all(|_| line.step(0xffff).is_none()));
    assert_eq!((line.flagged, line.damaged), (0, 1000));
    (0..=FLAGGED).for_each(|_| _ = line.step(with_parity(0x4000 | 77)));
    assert!((0..1000).all(|_| line.step(with_parity(0x4000 | 77) ^ 1).is_none()));
}
