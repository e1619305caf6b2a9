//! Flight cards: which movement of the switch's contact is a deliberate press.

use control::safety::press::{Press, PressConfig, PressState};
use proptest::prelude::*;

/// A second open and a tenth of a second closed.
const HELD: PressConfig = PressConfig { release_ticks: 1000, press_ticks: 100 };

/// The contact for so many periods; what it was in the last.
fn hold(state: &mut PressState, closed: bool, ticks: u32) -> Press {
    (0..ticks).map(|_| state.step(&HELD, closed)).last().expect("at least one")
}

/// Situation: the switch open from boot. Action: a second open, a tenth closed, one more; then open. Must hold: each phase
/// to the period; a press that is not spent stays one while the switch is closed.
#[test]
fn a_second_open_and_a_tenth_closed_are_a_press() {
    let mut switch = PressState::default();
    assert_eq!(hold(&mut switch, false, 1000), Press::Opened);
    assert_eq!(hold(&mut switch, false, 1), Press::Released);
    assert_eq!(hold(&mut switch, true, 100), Press::Pressing);
    assert_eq!(hold(&mut switch, true, 1), Press::Pressed);
    assert_eq!(hold(&mut switch, true, 100_000), Press::Pressed, "no count runs over");
    assert_eq!(hold(&mut switch, false, 1), Press::Opened);
    assert_eq!(hold(&mut switch, true, 1), Press::Held);
    hold(&mut switch, false, 100_000);
    assert_eq!(hold(&mut switch, true, 101), Press::Pressed);
    switch.consume();
    assert_eq!(hold(&mut switch, true, 5000), Press::Held, "spent");
}

/// Situation: the switch released for a second. Action: the contact bounces before it stays closed. Must hold: no press,
/// neither while it bounces nor after; another whole release is needed.
#[test]
fn a_press_that_breaks_off_is_none() {
    let mut switch = PressState::default();
    hold(&mut switch, false, 2000);
    assert_eq!(hold(&mut switch, true, 90), Press::Pressing);
    hold(&mut switch, false, 1);
    assert_eq!(hold(&mut switch, true, 5000), Press::Held);
    hold(&mut switch, false, 1001);
    assert_eq!(hold(&mut switch, true, 101), Press::Pressed);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Situation: a loose contact: any sequence of openings of up to a second and closings of any length. Must hold: never
    /// a press.
    #[test]
    fn a_loose_contact_makes_no_press(
        held in any::<bool>(),
        moves in prop::collection::vec((1_u32..=1000, 1_u32..2000), 1..20),
    ) {
        let mut switch = PressState::default();
        if held {
            hold(&mut switch, true, 100);
        }
        for (open, closed) in moves {
            for (closed, ticks) in [(false, open), (true, closed)] {
                for _ in 0..ticks {
                    prop_assert_ne!(switch.step(&HELD, closed), Press::Pressed);
                }
            }
        }
    }

    /// Situation: any movement of the contact, then a deliberate press. Must hold: it counts.
    #[test]
    fn a_deliberate_press_counts_after_anything(moves in prop::collection::vec((any::<bool>(), 1_u32..3000), 0..10)) {
        let mut switch = PressState::default();
        for (closed, ticks) in moves {
            hold(&mut switch, closed, ticks);
        }
        hold(&mut switch, false, 1001);
        prop_assert_eq!(hold(&mut switch, true, 101), Press::Pressed);
    }
}
