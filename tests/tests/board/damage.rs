//! Lines that damage, drop and hold up bytes, both ways.

use crate::client::SHORT;
use control::Config;
use proptest::prelude::*;
use sim_host::board::client::{Client, ClientError};
use tests::link_board::{Fate, LinkBoard, Passage, Wire, lock, shared};

/// What a line does to what goes over it, one after the other, then from the start.
#[derive(Clone, Debug)]
enum Harm {
    None,
    /// A byte is another.
    Turned {
        at: usize,
        by: u8,
    },
    /// It ends early.
    Cut {
        at: usize,
    },
    /// A byte more.
    Grown {
        at: usize,
        byte: u8,
    },
    Dropped,
    Late,
}

fn harms() -> impl Strategy<Value = Vec<Harm>> {
    let at = 0..40_usize;
    let harm = prop_oneof![
        4 => Just(Harm::None),
        1 => (at.clone(), 1..=255_u8).prop_map(|(at, by)| Harm::Turned { at, by }),
        1 => at.clone().prop_map(|at| Harm::Cut { at }),
        1 => (at, any::<u8>()).prop_map(|(at, byte)| Harm::Grown { at, byte }),
        1 => Just(Harm::Dropped),
        1 => Just(Harm::Late),
    ];
    prop::collection::vec(harm, 7..=11)
}

fn fate(harms: Vec<Harm>) -> Fate {
    let mut next = harms.into_iter().cycle();
    Box::new(move |mut bytes: Vec<u8>| {
        let inside = |at: usize, length: usize| at.min(length.saturating_sub(1));
        match next.next().unwrap_or(Harm::None) {
            _ if bytes.is_empty() => {}
            Harm::None => {}
            Harm::Turned { at, by } => {
                let at = inside(at, bytes.len());
                bytes[at] ^= by;
            }
            Harm::Cut { at } => bytes.truncate(at),
            Harm::Grown { at, byte } => bytes.insert(inside(at, bytes.len()), byte),
            Harm::Dropped => bytes.clear(),
            Harm::Late => return Passage::Late(bytes),
        }
        Passage::Arrives(bytes)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// Situation: half of what goes over the line is damaged, cut, dropped or late, there and back.
    /// Action: set and get a parameter again and again, to another value each time.
    /// Must hold: a set or get that succeeds is true of the board; one that does not tells that nothing answered, never
    /// a refusal; what a set that failed left is the old or the new value.
    #[test]
    fn an_answer_is_true_or_there_is_none(there in harms(), back in harms()) {
        let board = shared(LinkBoard::default());
        let mut client = Client::new(Box::new(Wire::new(&board, fate(there), fate(back))), SHORT);
        let now = || lock(&board).config.limits.max_torque_nm;
        for i in 1..=12_u8 {
            let (before, wanted) = (now(), Some(f32::from(i)));
            match client.set("limits.max_torque_nm", wanted) {
                Ok(value) => prop_assert!(value == wanted && now() == wanted),
                Err(error) => {
                    prop_assert!(matches!(error, ClientError::Silent { .. }), "{error}");
                    prop_assert!(now() == wanted || now() == before);
                }
            }
            match client.get("limits.max_torque_nm") {
                Ok(value) => prop_assert_eq!(value, now()),
                Err(error) => prop_assert!(matches!(error, ClientError::Silent { .. }), "{error}"),
            }
        }
    }
}

/// Situation: every third frame there is damaged, every fourth back is dropped.
/// Action: list all parameters, and set ten.
/// Must hold: all of it succeeds, with the board asked 1.1 to 1.7 times as often as over a good line.
#[test]
fn what_is_lost_is_asked_for_again() {
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
    let turned = vec![Harm::Turned { at: 5, by: 9 }, Harm::None, Harm::None];
    let dropped = vec![Harm::None, Harm::Dropped, Harm::None, Harm::None];
    let bad = shared(LinkBoard::default());
    let (heard, many) = count(&bad, Wire::new(&bad, fate(turned), fate(dropped)));
    assert_eq!(heard, listed);
    let expected = Config { limits: lock(&good).config.limits, ..Config::product() };
    assert_eq!(lock(&bad).config, expected);
    let ratio = f64::from(many) / f64::from(few);
    assert!((1.1..=1.7).contains(&ratio), "{few} {many}");
}
