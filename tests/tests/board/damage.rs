//! Connections that damage, drop and delay bytes, in both directions.

use crate::client::SHORT;
use control::Config;
use proptest::prelude::*;
use sim_host::board::client::{Client, ClientError};
use tests::link_board::{Fate, LinkBoard, LinkChannel, Wire, lock, shared};

/// Damage to the bytes of a line, one after the other, then from the start.
#[derive(Clone, Debug)]
enum LinkFaultKind {
    None,
    /// A byte is changed.
    Turned {
        at: usize,
        by: u8,
    },
    /// It ends early.
    Cut {
        at: usize,
    },
    /// An additional byte.
    Grown {
        at: usize,
        byte: u8,
    },
    Dropped,
    Late,
}

fn kinds() -> impl Strategy<Value = Vec<LinkFaultKind>> {
    let at = 0..40_usize;
    let kind = prop_oneof![
        4 => Just(LinkFaultKind::None),
        1 => (at.clone(), 1..=255_u8).prop_map(|(at, by)| LinkFaultKind::Turned { at, by }),
        1 => at.clone().prop_map(|at| LinkFaultKind::Cut { at }),
        1 => (at, any::<u8>()).prop_map(|(at, byte)| LinkFaultKind::Grown { at, byte }),
        1 => Just(LinkFaultKind::Dropped),
        1 => Just(LinkFaultKind::Late),
    ];
    prop::collection::vec(kind, 7..=11)
}

fn fate(kinds: Vec<LinkFaultKind>) -> Fate {
    let mut next = kinds.into_iter().cycle();
    Box::new(move |mut bytes: Vec<u8>| {
        let inside = |at: usize, length: usize| at.min(length.saturating_sub(1));
        match next.next().unwrap_or(LinkFaultKind::None) {
            _ if bytes.is_empty() => {}
            LinkFaultKind::None => {}
            LinkFaultKind::Turned { at, by } => {
                let at = inside(at, bytes.len());
                bytes[at] ^= by;
            }
            LinkFaultKind::Cut { at } => bytes.truncate(at),
            LinkFaultKind::Grown { at, byte } => bytes.insert(inside(at, bytes.len()), byte),
            LinkFaultKind::Dropped => bytes.clear(),
            LinkFaultKind::Late => return LinkChannel::Late(bytes),
        }
        LinkChannel::Arrives(bytes)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// Situation: half of the transfers are damaged, cut, dropped or late, in both directions.
    /// Action: set and get a parameter repeatedly, to another value each time.
    /// Must hold: a set or get that succeeds is true of the board; one that fails reports that nothing answered,
    /// never a rejection; a failed set leaves the old or the new value.
    #[test]
    fn an_answer_is_true_or_there_is_none(there in kinds(), back in kinds()) {
        let board = shared(LinkBoard::default());
        let mut client = Client::new(Box::new(Wire::new(&board, fate(there), fate(back))), SHORT);
        let now = || lock(&board).config.limits.max_torque_nm;
        for i in 1..=12_u8 {
            let (before, expected) = (now(), Some(f32::from(i)));
            match client.set("limits.max_torque_nm", expected) {
                Ok(value) => prop_assert!(value == expected && now() == expected),
                Err(error) => {
                    prop_assert!(matches!(error, ClientError::Silent { .. }), "{error}");
                    prop_assert!(now() == expected || now() == before);
                }
            }
            match client.get("limits.max_torque_nm") {
                Ok(value) => prop_assert_eq!(value, now()),
                Err(error) => prop_assert!(matches!(error, ClientError::Silent { .. }), "{error}"),
            }
        }
    }
}

/// Situation: every third frame to the board is damaged, every fourth from it is dropped.
/// Action: list all parameters, and set ten.
/// Must hold: all of it succeeds, with 1.1 to 1.7 times as many requests as over a good connection.
#[test]
fn lost_requests_are_repeated() {
    let count = |board: &tests::link_board::Shared, wire: Wire| {
        let mut client = Client::new(Box::new(wire), SHORT);
        let listed = client.list().expect("a list");
        for i in 1..=10_u8 {
            assert_eq!(
                client.set("limits.max_torque_nm", Some(f32::from(i))).expect("set"),
                Some(f32::from(i))
            );
        }
        (listed, lock(board).requests)
    };
    let good = shared(LinkBoard::default());
    let (listed, few) = count(&good, Wire::good(&good));
    let turned = vec![LinkFaultKind::Turned { at: 5, by: 9 }, LinkFaultKind::None, LinkFaultKind::None];
    let dropped = vec![LinkFaultKind::None, LinkFaultKind::Dropped, LinkFaultKind::None, LinkFaultKind::None];
    let bad = shared(LinkBoard::default());
    let (heard, many) = count(&bad, Wire::new(&bad, fate(turned), fate(dropped)));
    assert_eq!(heard, listed);
    let expected = Config { limits: lock(&good).config.limits, ..Config::product() };
    assert_eq!(lock(&bad).config, expected);
    let ratio = f64::from(many) / f64::from(few);
    assert!((1.1..=1.7).contains(&ratio), "{few} {many}");
}
