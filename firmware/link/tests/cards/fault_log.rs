//! Faults stored through a reset.

use control::{CAUSES, Causes, Mode};
use link::fault_log::{LastStep, RING_BYTES, SLOTS, clear, faults, last_step, note, noted, start, stepped};
use link::report::{FaultKind, FaultRecord, ResetCause};
use proptest::prelude::*;

fn fault(steps: u32, text: &str) -> FaultRecord<'_> {
    FaultRecord {
        kind: FaultKind::Panic,
        boot: 3,
        reset: ResetCause::Watchdog,
        mode: Mode::Engaged,
        steps,
        frame_us: 99,
        causes: Causes::all(&CAUSES),
        exception: 0,
        registers: [1, 2, 3, 4, 5, 6],
        text,
    }
}

fn steps(memory: &[u8; RING_BYTES]) -> Vec<u32> {
    faults(memory).map(|fault| fault.steps).collect()
}

/// Situation: random memory, as after power-on.
/// Action: start, record more faults than there are slots, start again, clear.
/// Must hold: empty at first; then the newest faults in order, unchanged; all starts are counted.
#[test]
fn the_newest_faults_are_stored() {
    let mut memory = [0xa5; RING_BYTES];
    note(&mut memory, &fault(0, "too early"));
    assert_eq!(start(&mut memory), 1);
    assert_eq!(steps(&memory), []);
    for n in 1..=3 * SLOTS as u32 + 2 {
        note(&mut memory, &fault(n, "panicked at control.rs"));
        let expected: Vec<u32> = (1..=n).rev().take(SLOTS).collect();
        assert_eq!((steps(&memory), noted(&memory)), (expected, n as u16));
    }
    assert_eq!(start(&mut memory), 2);
    let newest = faults(&memory).next();
    assert_eq!(newest, Some(fault(3 * SLOTS as u32 + 2, "panicked at control.rs")));
    clear(&mut memory);
    assert_eq!((steps(&memory), noted(&memory)), (vec![], 0));
    assert_eq!(start(&mut memory), 3);
}

proptest! {
    /// Situation: any memory.
    /// Action: start; store the controller's state; start again; change any byte of it.
    /// Must hold: the state survives a start; after damage it is the same or absent.
    #[test]
    fn the_last_step_is_stored(
        fill in any::<u8>(), steps in any::<u32>(), frame_us in any::<u32>(), causes in any::<u64>(), at in 0..RING_BYTES
    ) {
        let mut memory = [fill; RING_BYTES];
        start(&mut memory);
        prop_assert_eq!(last_step(&memory), None);
        let last = LastStep { steps, frame_us, causes: Causes(causes), mode: Mode::Limp };
        stepped(&mut memory, &last);
        start(&mut memory);
        prop_assert_eq!(last_step(&memory), Some(last));
        memory[at] ^= 1;
        let step = last_step(&memory);
        prop_assert!(step == if at < RING_BYTES - 21 { Some(last) } else { None }, "{:?}", step);
    }

    /// Situation: any bytes in memory.
    /// Action: read them; start, record a fault with any text.
    /// Must hold: no panic; the fault is there, its text cut only between characters.
    #[test]
    fn any_memory_becomes_a_ring(seed in prop::collection::vec(any::<u8>(), 64), text in ".{0,300}") {
        let mut memory = core::array::from_fn(|i| seed[i % 64]);
        let _ = faults(&memory).count();
        prop_assert!(start(&mut memory) >= 1);
        note(&mut memory, &fault(7, &text));
        let stored = faults(&memory).next().expect("stored");
        prop_assert!(text.starts_with(stored.text) && stored.steps == 7);
    }

    /// Situation: a full ring.
    /// Action: change any byte; start.
    /// Must hold: every fault read is a recorded one, in order; at most one is lost, or all if the header was changed.
    #[test]
    fn damage_takes_one_fault_or_empties_the_ring(at in 0..RING_BYTES, to in any::<u8>()) {
        let mut memory = [0; RING_BYTES];
        start(&mut memory);
        let all: Vec<u32> = (1..=SLOTS as u32).rev().collect();
        all.iter().rev().for_each(|n| note(&mut memory, &fault(*n, "text")));
        prop_assert_eq!(steps(&memory), all.clone());
        memory[at] = to;
        start(&mut memory);
        let left = steps(&memory);
        let mut stored = all.iter();
        prop_assert!(left.iter().all(|n| stored.any(|m| m == n)), "{:?}", left);
        prop_assert!(left.len() >= SLOTS - 1 || (at < 14 && left.is_empty()), "{:?}", left);
    }
}
