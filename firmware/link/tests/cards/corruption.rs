//! Corrupted flash.

use crate::flash::{Flash, PAGE, PAGES, load, random, save};
use control::Config;
use link::record::InvalidRecord;
use link::store::Found;
use proptest::prelude::*;

const SIZE: usize = PAGE * PAGES;

fn numbered(i: u16) -> Config {
    let mut config = Config::product();
    config.calibration.motor_reversed = i.is_multiple_of(2);
    config.calibration.polarity_checked = true;
    config.permit.ramp_in_ticks = 500 + i;
    config
}

/// Situation: an older and a newest configuration in flash, both passed their polarity check.
/// Action: turn one bit of every byte of both; start.
/// Must hold: the newest configuration, or the defaults with the check not passed; never the older one, whose
/// calibration can differ, and never anything else.
#[test]
fn a_flipped_bit_never_restores_an_older_configuration() {
    let flash = save(save(Flash::new(), &numbered(1)).1, &numbered(2)).1;
    let end = flash.bytes.iter().rposition(|byte| *byte != 0xff).expect("something was written");
    let (mut whole, mut lost, mut other) = (0, 0, 0);
    for at in 0..=end {
        let mut turned = flash.clone();
        turned.bytes[at] ^= 1 << (at % 8);
        let (found, result, _) = load(turned, &Config::product());
        match result {
            Found::Record(_) => {
                assert_eq!(found, numbered(2), "byte {at}");
                whole += 1;
            }
            result => {
                assert_eq!(found, Config::product(), "byte {at}");
                if result == Found::Invalid(InvalidRecord::Lost) { lost += 1 } else { other += 1 }
            }
        }
    }
    println!("{end} bytes: newest {whole}, lost {lost}, otherwise {other}");
    assert!(whole > end / 3 && lost > end / 3 && other < 20, "{whole} {lost} {other}");
}

proptest! {
    /// Situation: flash with any content, or a good store with a corrupted range.
    /// Action: start; store; start again.
    /// Must hold: no panic; the configuration passes `plan`; if it is not the stored one, the check is not passed;
    /// storing reports its success correctly, and succeeds on a good store with a corrupted range.
    #[test]
    fn any_flash_is_survived(
        good in any::<bool>(), from in 0..SIZE, length in 1..SIZE, seed in any::<u64>()
    ) {
        let mut flash = if good { save(Flash::new(), &numbered(1)).1 } else { Flash::new() };
        let mut seed = seed;
        let (from, length) = if good { (from, length) } else { (0, SIZE) };
        flash.bytes.iter_mut().skip(from).take(length).for_each(|byte| *byte = random(&mut seed) as u8);
        let (found, _, flash) = load(flash, &Config::product());
        prop_assert!(found.clone().plan().is_ok());
        prop_assert!(found == numbered(1) || !found.calibration.polarity_checked);
        let (done, flash) = save(flash, &numbered(3));
        prop_assert_eq!(done, Ok(()));
        prop_assert_eq!(load(flash, &Config::product()).0, numbered(3));
    }
}
