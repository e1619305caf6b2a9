//! Framing in a stream of arbitrary bytes.

use link::frame::{Decoder, Dropped, Frame, MAX_FRAME, MAX_PAYLOAD, Received, VERSION, encode};
use proptest::prelude::*;

/// A received frame, owned.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Got {
    Frame(u8, u16, Vec<u8>),
    Wrong(u8),
}

impl Got {
    fn of(received: Received<'_>) -> Self {
        match received {
            Received::Frame(Frame { kind, sequence, payload }) => {
                Got::Frame(kind, sequence, payload.to_vec())
            }
            Received::WrongVersion { theirs } => Got::Wrong(theirs),
        }
    }
}

fn feed(decoder: &mut Decoder, bytes: &[u8]) -> Vec<Got> {
    bytes.iter().filter_map(|byte| decoder.feed(*byte).map(Got::of)).collect()
}

/// As [`feed`], all bytes at once.
fn take(decoder: &mut Decoder, mut bytes: &[u8]) -> Vec<Got> {
    let mut got = Vec::new();
    while !bytes.is_empty() {
        got.extend(decoder.take(&mut bytes).map(Got::of));
    }
    got
}

fn line(kind: u8, sequence: u16, payload: &[u8]) -> Vec<u8> {
    let mut bytes = [0; MAX_FRAME];
    let used = encode(kind, sequence, payload, &mut bytes).expect("room");
    bytes[..used].to_vec()
}

/// A frame of another version, built by hand.
fn foreign(version: u8) -> Vec<u8> {
    let mut plain = vec![version, 1, 2, 3, 4, 5];
    plain.extend_from_slice(&link::frame::CRC.checksum(&plain).to_le_bytes());
    let mut bytes = vec![0; 64];
    let used = cobs::try_encode_including_sentinels(&plain, &mut bytes).expect("room");
    bytes[..used].to_vec()
}

fn total(dropped: Dropped) -> u32 {
    dropped.garbled + dropped.too_long + dropped.bad_crc + dropped.wrong_version
}

fn payloads() -> impl Strategy<Value = Vec<u8>> {
    // Many zeros and long runs without one: both ends of the stuffing.
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..=MAX_PAYLOAD),
        prop::collection::vec(prop_oneof![Just(0_u8), any::<u8>()], 0..=MAX_PAYLOAD),
        (0..=MAX_PAYLOAD).prop_map(|n| vec![0xff; n]),
    ]
}

proptest! {
    /// Situation: any frames, one after the other.
    /// Action: decode them byte by byte.
    /// Must hold: the same frames; nothing dropped; the byte 0 occurs only at the ends of each.
    #[test]
    fn frames_come_through(frames in prop::collection::vec((any::<u8>(), any::<u16>(), payloads()), 1..5)) {
        let mut decoder = Decoder::default();
        for (kind, sequence, payload) in frames {
            let bytes = line(kind, sequence, &payload);
            prop_assert!(bytes.len() <= MAX_FRAME && !bytes[1..bytes.len() - 1].contains(&0));
            prop_assert_eq!(feed(&mut decoder, &bytes), vec![Got::Frame(kind, sequence, payload)]);
        }
        prop_assert_eq!(decoder.dropped(), Dropped::default());
    }

    /// Situation: frames with any bytes before, between and in them, cut into pieces anywhere.
    /// Action: decode them byte by byte, and piece by piece.
    /// Must hold: the same frames, and the same drop counts of each kind.
    #[test]
    fn pieces_are_decoded_like_their_bytes(
        parts in prop::collection::vec((prop::collection::vec(any::<u8>(), 0..400), payloads()), 1..5),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
        cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..6),
    ) {
        let mut bytes: Vec<u8> =
            parts.iter().flat_map(|(garbage, payload)| [&garbage[..], &line(7, 9, payload)].concat()).collect();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let (mut one, mut other) = (Decoder::default(), Decoder::default());
        let mut ends: Vec<usize> = cuts.iter().map(|cut| cut.index(bytes.len())).chain([bytes.len()]).collect();
        ends.sort_unstable();
        let mut start = 0;
        for end in ends {
            let piece = &bytes[start..end];
            prop_assert_eq!(feed(&mut one, piece), take(&mut other, piece));
            prop_assert_eq!(one.dropped(), other.dropped());
            start = end;
        }
    }

    /// Situation: any bytes, then a frame.
    /// Action: decode them.
    /// Must hold: no panic; no frame from the bytes (they contain none); the frame after them is received.
    #[test]
    fn a_frame_is_found_after_any_garbage(garbage in prop::collection::vec(any::<u8>(), 0..2000), payload in payloads()) {
        let mut decoder = Decoder::default();
        prop_assert_eq!(feed(&mut decoder, &garbage), vec![]);
        prop_assert_eq!(feed(&mut decoder, &line(7, 9, &payload)), vec![Got::Frame(7, 9, payload)]);
        let some = garbage.iter().any(|byte| *byte != 0);
        prop_assert_eq!(total(decoder.dropped()) > 0, some);
    }

    /// Situation: a frame of which any bytes are replaced, lost or added, and then another.
    /// Action: decode both.
    /// Must hold: of the first only the original is accepted; the next is received.
    #[test]
    fn a_damaged_frame_is_never_another(
        payload in payloads(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..3_u8, any::<u8>()), 1..8),
    ) {
        let mut bytes = line(7, 9, &payload);
        for (at, how, byte) in changes {
            let at = at.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 if bytes.len() > 1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, byte),
            }
        }
        bytes.extend_from_slice(&line(8, 10, b"next"));
        let mut got = feed(&mut Decoder::default(), &bytes);
        prop_assert_eq!(got.pop(), Some(Got::Frame(8, 10, b"next".to_vec())));
        prop_assert!(got.is_empty() || got == vec![Got::Frame(7, 9, payload)], "{:?}", got);
    }

    /// Situation: a frame that is cut anywhere within: the decoder starts there, or the sender stops there.
    /// Action: decode the part and then a complete one.
    /// Must hold: only the complete one is received.
    #[test]
    fn part_of_a_frame_is_none(payload in payloads(), at in any::<prop::sample::Index>(), front in any::<bool>()) {
        let whole = line(7, 9, &payload);
        let (head, tail) = whole.split_at(2 + at.index(whole.len() - 3));
        let mut decoder = Decoder::default();
        prop_assert_eq!(feed(&mut decoder, if front { head } else { tail }), vec![]);
        prop_assert_eq!(feed(&mut decoder, &line(8, 10, b"next")), vec![Got::Frame(8, 10, b"next".to_vec())]);
    }
}

/// Situation: a frame of every size, with each single bit flipped in turn.
/// Action: decode it, then another.
/// Must hold: nothing of the first is accepted; it is counted once; the next is received.
#[test]
fn no_flipped_bit_is_accepted() {
    for size in [0, 1, 7, 81, MAX_PAYLOAD] {
        let payload: Vec<u8> = (0..size).map(|i| (i % 5) as u8).collect();
        let whole = line(7, 9, &payload);
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            let mut decoder = Decoder::default();
            let got = feed(&mut decoder, &bytes);
            assert_eq!(got, vec![], "bit {bit} of {size}");
            assert_eq!(feed(&mut decoder, &line(8, 10, b"next")), vec![Got::Frame(8, 10, b"next".to_vec())]);
            assert!(
                (1..=2).contains(&total(decoder.dropped())),
                "bit {bit} of {size}: {:?}",
                decoder.dropped()
            );
        }
    }
}

/// Situation: only bytes without a 0; a frame of another version; invalid COBS encoding; a wrong CRC.
/// Action: decode each.
/// Must hold: each is counted under its kind.
#[test]
fn dropped_bytes_are_counted_by_kind() {
    let mut decoder = Decoder::default();
    feed(&mut decoder, &[1; 5000]);
    feed(&mut decoder, &[0]);
    assert_eq!(decoder.dropped(), Dropped { too_long: 1, ..Dropped::default() });
    assert_eq!(feed(&mut decoder, &foreign(VERSION + 1)), vec![Got::Wrong(VERSION + 1)]);
    assert_eq!(feed(&mut decoder, &foreign(0)), vec![Got::Wrong(0)]);
    assert_eq!(feed(&mut decoder, &foreign(VERSION)), vec![Got::Frame(1, 0x0302, vec![4, 5])]);
    feed(&mut decoder, &[9, 1, 1, 0]);
    feed(&mut decoder, &[2, 1, 0]);
    let mut other = line(1, 2, b"abc");
    other[6] ^= 1;
    feed(&mut decoder, &other);
    assert_eq!(decoder.dropped(), Dropped { too_long: 1, wrong_version: 2, garbled: 2, bad_crc: 1 });
}

/// Situation: a payload that is too long; a buffer that is too small.
/// Action: encode.
/// Must hold: rejected; the longest payload in the largest frame is accepted, and decodes to itself.
#[test]
fn a_frame_that_does_not_fit_is_rejected() {
    let mut bytes = [0; MAX_FRAME];
    assert_eq!(encode(1, 2, &[1; MAX_PAYLOAD + 1], &mut bytes), None);
    assert_eq!(encode(1, 2, &[1; MAX_PAYLOAD], &mut bytes), Some(MAX_FRAME));
    for room in 0..14 {
        assert_eq!(encode(1, 2, &[1, 2, 3], &mut bytes[..room]), None, "{room}");
    }
    assert_eq!(encode(1, 2, &[1, 2, 3], &mut bytes[..14]), Some(14));
}
