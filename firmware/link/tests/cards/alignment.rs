//! The encoder's offset in flash: a stored one is found again, an invalid one is not used.

use crate::flash::{Flash, PAGE, PAGES, load, load_alignment, save, save_alignment};
use control::Config;
use link::alignment::{Alignment, LAYOUT, Offset};
use link::record::{InvalidRecord, NoRecord};
use proptest::prelude::*;

const MOTOR: u32 = 0x89ab_cdef;

fn found(offset_turns: f32) -> Alignment {
    Alignment { offset_turns, motor_id: MOTOR }
}

/// A configuration that is not the defaults.
fn own() -> Config {
    let mut config = Config::product();
    config.permit.ramp_in_ticks = 777;
    config
}

/// Situation: empty flash; then a configuration, an alignment, another configuration and a reset to the defaults,
/// each stored. Action: start after each.
/// Must hold: no alignment, then the stored one; a reset of the parameters does not change it.
#[test]
fn an_alignment_survives_every_store_of_parameters() {
    let (none, flash) = load_alignment(Flash::new());
    assert_eq!(none, Ok(None));
    let flash = save(flash, &own()).1;
    assert_eq!(load_alignment(flash.clone()).0, Ok(None));
    let (done, mut flash) = save_alignment(flash, &found(0.3123));
    assert_eq!(done, Ok(()));
    for _ in 0..12 {
        for config in [own(), Config::product()] {
            flash = save(flash, &config).1;
            assert_eq!(load_alignment(flash.clone()).0, Ok(Some(found(0.3123))));
            assert_eq!(load(flash.clone(), &Config::product()).0, config);
        }
    }
    assert!(flash.erases >= 2, "{}", flash.erases);
}

/// Situation: flash filled by another program, such as the VESC firmware.
/// Action: store an alignment; store a configuration.
/// Must hold: both succeed and are found.
#[test]
fn an_alignment_is_stored_over_anything() {
    for byte in [0x00, 0x5a] {
        let mut flash = Flash::new();
        flash.bytes = vec![byte; PAGE * PAGES];
        let (done, flash) = save_alignment(flash, &found(-0.2));
        assert_eq!(done, Ok(()));
        let (done, flash) = save(flash, &own());
        assert_eq!(done, Ok(()));
        assert_eq!(load_alignment(flash.clone()).0, Ok(Some(found(-0.2))));
        assert_eq!(load(flash, &Config::product()).0, own());
    }
}

/// Situation: a configuration and an alignment in flash that is full and needs an erase.
/// Action: store another alignment; from the same flash, another configuration.
/// Must hold: after the erase, the item that was not being stored is unchanged.
#[test]
fn an_erase_leaves_the_other_item_unchanged() {
    let stored = save_alignment(save(Flash::new(), &own()).1, &found(0.1)).1;
    // The pages' marks, in their first and last words, are as they were; what lies free between them holds zeros.
    let mut full = stored.clone();
    for (at, byte) in full.bytes.iter_mut().enumerate() {
        let (word, words) = (at % PAGE / 4, PAGE / 4);
        if word != 0 && word != words - 1 && stored.bytes[at / 4 * 4..][..4] == [0xff; 4] {
            *byte = 0;
        }
    }
    assert_eq!(load_alignment(full.clone()).0, Ok(Some(found(0.1))));
    assert_eq!(load(full.clone(), &Config::product()).0, own());
    let (done, after) = save_alignment(full.clone(), &found(0.2));
    assert_eq!(done, Ok(()));
    assert_eq!(load_alignment(after.clone()).0, Ok(Some(found(0.2))));
    assert!(after.erases >= 3, "{}", after.erases);
    assert_eq!(load(after, &Config::product()).0, own());
    let (done, after) = save(full, &Config::product());
    assert_eq!(done, Ok(()));
    assert_eq!(load(after.clone(), &own()).0, Config::product());
    assert!(after.erases >= 3, "{}", after.erases);
    assert_eq!(load_alignment(after).0, Ok(Some(found(0.1))));
}

/// Situation: two alignments were stored, the later after the encoder was moved.
/// Action: damage any bit of the later one, or of its number; start.
/// Must hold: never the earlier offset: the later one, or an invalid record without an offset.
#[test]
fn an_older_offset_never_replaces_a_damaged_one() {
    let older = save_alignment(Flash::new(), &found(0.3)).1;
    let newer = save_alignment(older.clone(), &found(-0.1)).1;
    let changed: Vec<usize> =
        (0..newer.bytes.len()).filter(|at| older.bytes[*at] != newer.bytes[*at]).collect();
    let (mut invalid, mut read) = (0, 0);
    for at in changed {
        for bit in 0..8 {
            let mut damaged = newer.clone();
            damaged.bytes[at] ^= 1 << bit;
            let (stored, _) = load_alignment(damaged);
            let offset = Offset::choose(None, stored, MOTOR);
            match offset.turns() {
                Some(turns) => assert_eq!(turns, -0.1, "byte {at}, bit {bit}"),
                None => assert!(matches!(offset, Offset::Invalid(_)), "byte {at}, bit {bit}: {offset}"),
            }
            if offset.turns().is_some() { read += 1 } else { invalid += 1 }
        }
    }
    assert!(invalid > 100 && read > 50, "{invalid} {read}");
}

/// Situation: an offset in the program or not; in flash one of this motor, one of another motor, none, or an invalid
/// one. Action: choose the offset.
/// Must hold: the program's has priority, then that of this motor; no other is used, and the text says which and why.
#[test]
fn the_programs_own_offset_ranks_first() {
    let (mine, other) = (found(0.25), Alignment { motor_id: MOTOR ^ 1, ..found(0.25) });
    let invalid = [
        (InvalidRecord::Lost, "the newest one is lost"),
        (InvalidRecord::Unreadable, "flash can't be read"),
        (InvalidRecord::NoRecord(NoRecord::Malformed), "the stored one is damaged"),
        (InvalidRecord::NoRecord(NoRecord::Layout(9)), "stored in layout 9, which is not known"),
    ];
    let mut cases = vec![
        (Ok(Some(mine)), Some(0.25), "0.2500 turns, from flash"),
        (Ok(Some(other)), None, "the stored one is of another motor, not used"),
        (Ok(None), None, "none stored"),
    ];
    cases.extend(invalid.map(|(reason, text)| (Err(reason), None, text)));
    for (stored, turns, text) in cases {
        let chosen = Offset::choose(None, stored, MOTOR);
        assert_eq!((chosen.turns(), chosen.to_string().as_str()), (turns, text));
        let program = Offset::choose(Some(-0.125), stored, MOTOR);
        assert_eq!(program.turns(), Some(-0.125));
        assert_eq!(program.to_string(), "-0.1250 turns, from the program");
    }
}

proptest! {
    /// Situation: any bytes in place of an alignment.
    /// Action: decode them.
    /// Must hold: no offset outside half a turn, and only of the known layout; encoding a decoded alignment gives the
    /// same.
    #[test]
    fn any_bytes_give_an_offset_within_half_a_turn(
        bytes in prop::collection::vec(any::<u8>(), 0..20), offset_turns in -0.5_f32..=0.5, number in any::<u32>()
    ) {
        if let Ok((_, alignment)) = Alignment::decode(&bytes) {
            prop_assert!(alignment.offset_turns.abs() <= 0.5 && bytes[0] == LAYOUT);
        }
        prop_assert_eq!(Alignment::decode(&found(offset_turns).encode(number)), Ok((number, found(offset_turns))));
        for wrong in [0.501, -0.501, f32::NAN, f32::INFINITY] {
            prop_assert_eq!(Alignment::decode(&found(wrong).encode(number)), Err(NoRecord::Malformed));
        }
    }
}
