//! Which movement of the switch's contact is a deliberate press.

use control::safety::press::{Press, PressConfig, PressState};
use proptest::prelude::*;

/// Open for 1 s, closed for 0.1 s.
const HELD: PressConfig = PressConfig { release_ticks: 1000, press_ticks: 100 };

/// State of the switch after `ticks` periods with the contact closed or open.
fn hold(state: &mut PressState, closed: bool, ticks: u32) -> Press {
    (0..ticks).map(|_| state.step(&HELD, closed)).last().expect("at least one")
}

/// Situation: the switch open from boot.
/// Action: open for 1 s, closed for 0.1 s, one period more each; then open.
/// Must hold: each phase to the period; a press that is not consumed remains while the switch is closed.
#[test]
fn open_for_1_s_and_closed_for_100_ms_is_a_press() {
    let mut switch = PressState::default();
    assert_eq!(hold(&mut switch, false, 1000), Press::Opened);
    assert_eq!(hold(&mut switch, false, 1), Press::Released);
    assert_eq!(hold(&mut switch, true, 100), Press::Pressing);
    assert_eq!(hold(&mut switch, true, 1), Press::Pressed);
    assert_eq!(hold(&mut switch, true, 100_000), Press::Pressed, "no count overflows");
    assert_eq!(hold(&mut switch, false, 1), Press::Opened);
    assert_eq!(hold(&mut switch, true, 1), Press::Held);
    hold(&mut switch, false, 100_000);
    assert_eq!(hold(&mut switch, true, 101), Press::Pressed);
    switch.consume();
    assert_eq!(hold(&mut switch, true, 5000), Press::Held, "consumed");
}

/// Situation: the switch released for more than 1 s.
/// Action: the contact bounces before it stays closed.
/// Must hold: no press, neither while it bounces nor after; another full release is needed.
#[test]
fn an_interrupted_press_does_not_count() {
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

    /// Situation: a loose contact: an arbitrary sequence of openings of up to 1 s and closings of any length.
    /// Action: step.
    /// Must hold: never a press.
    #[test]
    fn a_loose_contact_makes_no_press(
        held in any::<bool>(),
        movements in prop::collection::vec((1_u32..=1000, 1_u32..2000), 1..20),
    ) {
        let mut switch = PressState::default();
        if held {
            hold(&mut switch, true, 100);
        }
        for (open, closed) in movements {
            for (closed, ticks) in [(false, open), (true, closed)] {
                for _ in 0..ticks {
                    prop_assert_ne!(switch.step(&HELD, closed), Press::Pressed);
                }
            }
        }
    }

    /// Situation: arbitrary movement of the contact.
    /// Action: a deliberate press.
    /// Must hold: it counts.
    #[test]
    fn a_deliberate_press_counts_after_anything(movements in prop::collection::vec((any::<bool>(), 1_u32..3000), 0..10)) {
        let mut switch = PressState::default();
        for (closed, ticks) in movements {
            hold(&mut switch, closed, ticks);
        }
        hold(&mut switch, false, 1001);
        prop_assert_eq!(hold(&mut switch, true, 101), Press::Pressed);
    }
}
