//! The lockstep exchange of host and board.

use link::lockstep::{FromBoard, MAX_CHUNK, ToBoard};
use proptest::prelude::*;

fn bytes() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(any::<u8>(), 0..600)
}

proptest! {
    /// Situation: any bytes for loop and line, any time.
    /// Action: encode and decode, in both directions; then with a byte more and a byte less.
    /// Must hold: the same; any other length is rejected.
    #[test]
    fn loop_and_line_stay_apart(first in bytes(), second in bytes(), time_ms in any::<u32>(), starts in any::<u16>()) {
        let mut room = [0; MAX_CHUNK];
        let board = FromBoard { time_ms, starts, motor: &first, line: &second };
        let used = board.encode(&mut room).expect("room");
        prop_assert_eq!(FromBoard::decode(&room[..used]), Some(board));
        prop_assert_eq!(FromBoard::decode(&room[..used + 1]), None);
        prop_assert_eq!(FromBoard::decode(&room[..used - 1]), None);
        let host = ToBoard { sensors: &first, line: &second };
        let used = host.encode(&mut room).expect("room");
        prop_assert_eq!(ToBoard::decode(&room[..used]), Some(host));
        prop_assert_eq!(ToBoard::decode(&room[..used + 1]), None);
        prop_assert_eq!(ToBoard::decode(&room[..used - 1]), None);
        prop_assert_eq!(host.encode(&mut room[..used - 1]), None);
    }

    /// Situation: any bytes at all.
    /// Action: decode them in either direction.
    /// Must hold: no panic; a decoded exchange uses exactly these bytes.
    #[test]
    fn any_bytes_are_decoded_or_rejected(any in bytes()) {
        if let Some(board) = FromBoard::decode(&any) {
            prop_assert_eq!(board.encode(&mut [0; MAX_CHUNK]), Some(any.len()));
        }
        if let Some(host) = ToBoard::decode(&any) {
            prop_assert_eq!(host.encode(&mut [0; MAX_CHUNK]), Some(any.len()));
        }
    }
}
