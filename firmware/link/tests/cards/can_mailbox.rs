//! Counting of CAN frames.

use link::can_mailbox::{Action, Counts, Mailbox};
use proptest::prelude::*;

/// Model of the chip's mailbox: at most one frame, one attempt.
#[derive(Default)]
struct Chip {
    waits: bool,
    completed: bool,
    acknowledged: bool,
}

impl Chip {
    fn step(&mut self, counts: &mut Counts) {
        let &mut Self { waits, completed, acknowledged } = self;
        match counts.step(Mailbox { empty: !waits, completed, acknowledged }) {
            Action::Put => *self = Self { waits: true, ..Self::default() },
            Action::Abort => *self = Self { completed: true, ..Self::default() },
        }
    }

    /// The frame is acknowledged, or not.
    fn try_once(&mut self, acknowledged: bool) {
        if self.waits {
            *self = Self { waits: false, completed: true, acknowledged };
        }
    }
}

/// Situation: 100 frames on a bus with a listener, then 100 without one, then 100 on a bus that is off, then a listener
/// again. Must hold: all of the first are sent, none of the others until the last; no pending frame is sent late.
#[test]
fn without_a_listener_frames_are_lost() {
    let (mut chip, mut counts) = (Chip::default(), Counts::default());
    let mut send = |frames: u32, bus: Option<bool>| {
        for _ in 0..frames {
            chip.step(&mut counts);
            if let Some(acknowledged) = bus {
                chip.try_once(acknowledged);
            }
        }
        counts
    };
    // The newest frame is counted when the next is due.
    assert_eq!(send(100, Some(true)), Counts { sent: 99, lost: 0 });
    assert_eq!(send(100, Some(false)), Counts { sent: 100, lost: 99 });
    assert_eq!(send(100, None), Counts { sent: 100, lost: 199 });
    let after = send(100, Some(true));
    assert!((198..=200).contains(&after.sent) && (200..=201).contains(&after.lost), "{after:?}");
}

proptest! {
    /// Situation: a bus with any behaviour. Must hold: every frame is counted once, except one that is pending or was
    /// just tried.
    #[test]
    fn every_frame_is_counted_once(bus in prop::collection::vec(prop::option::of(any::<bool>()), 1..200)) {
        let (mut chip, mut counts) = (Chip::default(), Counts::default());
        for frames in 1..=bus.len() {
            chip.step(&mut counts);
            let pending = u32::from(chip.waits || chip.completed);
            prop_assert_eq!(counts.sent + counts.lost + pending, frames as u32);
            if let Some(acknowledged) = bus[frames - 1] {
                chip.try_once(acknowledged);
            }
        }
    }
}
