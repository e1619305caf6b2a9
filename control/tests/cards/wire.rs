//! The binary record that carries a configuration to an image.

use control::param::{ParamSpec, ParamVisitor};
use control::wire::{
    CONFIG_BYTES, config_bytes_used, decode_causes, decode_config, encode_causes, encode_config,
};
use control::{CAUSES, Causes, Config, GainSchedule, Law};
use proptest::prelude::*;
use proptest::test_runner::TestRng;

fn laws() -> impl Strategy<Value = Law> {
    // Gaps of 0.2 m/s keep the speeds rising and within 30 m/s.
    let table =
        (-20.0_f32..20.0, prop::collection::vec(-200.0_f32..200.0, 1..=32)).prop_map(|(start, gains)| {
            let points: Vec<_> =
                (0_u8..).zip(gains).map(|(i, gain)| (start + 0.2 * f32::from(i), gain)).collect();
            Law::Table(GainSchedule::new(&points).expect("a valid table"))
        });
    prop_oneof![
        Just(Law::None),
        any::<bool>().prop_map(|cut| Law::H { cut }),
        Just(Law::F),
        Just(Law::G),
        Just(Law::Cl1),
        prop::num::f32::NORMAL.prop_map(|k| Law::Cl2 { k }),
        prop::num::f32::NORMAL.prop_map(|kappa| Law::BalanceAssist { kappa }),
        table,
    ]
}

/// Sets every parameter to an arbitrary value that the bytes can hold, valid or not.
struct Scramble(TestRng);

impl Scramble {
    fn number(&mut self) -> f32 {
        // Any float but NaN, which is not equal to itself.
        let x = f32::from_bits(self.0.random());
        if x.is_nan() { 0.0 } else { x }
    }
}

impl ParamVisitor for Scramble {
    fn number(&mut self, _: &ParamSpec, value: &mut f32) {
        *value = self.number();
    }
    fn optional_number(&mut self, _: &ParamSpec, value: &mut Option<f32>) {
        *value = self.0.random::<bool>().then(|| self.number());
    }
    fn count(&mut self, _: &ParamSpec, value: &mut u16) {
        *value = self.0.random();
    }
    fn switch(&mut self, _: &ParamSpec, value: &mut bool) {
        *value = self.0.random();
    }
    fn choice(&mut self, _: &ParamSpec, names: &'static [&'static str], value: &mut u8) {
        *value = self.0.random_range(0..names.len()) as u8;
    }
}

fn configurations() -> impl Strategy<Value = Config> {
    laws().prop_perturb(|law, rng| {
        let mut config = Config::thesis(law);
        config.visit_params(&mut Scramble(rng));
        config
    })
}

proptest! {
    /// Situation: an arbitrary configuration, valid or not.
    /// Action: encode and decode.
    /// Must hold: the same configuration.
    #[test]
    fn a_configuration_survives_its_bytes(config in configurations()) {
        prop_assert_eq!(decode_config(&encode_config(&config)), Ok(config));
    }

    /// Situation: a valid record with any byte changed to any other.
    /// Action: decode.
    /// Must hold: an error, or a configuration that is unchanged to the bit by encoding and decoding.
    #[test]
    fn a_damaged_record_is_rejected_or_read(
        config in configurations(), at in 0..CONFIG_BYTES, byte in any::<u8>()
    ) {
        let mut record = encode_config(&config);
        record[at] = byte;
        if let Ok(read) = decode_config(&record) {
            let again = encode_config(&read);
            prop_assert_eq!(decode_config(&again).map(|c| encode_config(&c)), Ok(again));
        }
    }
}

/// Situation: every cause alone, and all.
/// Action: encode and decode.
/// Must hold: 16 bytes, the bit of the cause's number; the same set again.
#[test]
fn causes_have_the_bits_of_their_numbers() {
    for cause in CAUSES {
        let bytes = encode_causes(Causes::of(cause));
        assert_eq!(u128::from_le_bytes(bytes), 1 << cause.code(), "{}", cause.name());
    }
    let all = Causes::all(&CAUSES);
    assert_eq!(decode_causes(&encode_causes(all)), all);
    assert_eq!(decode_causes(&[0xff; 16]), Causes(u64::MAX), "numbers from 64 on are left out");
}

/// Situation: the published and the flashed configuration.
/// Action: encode, decode, plan.
/// Must hold: accepted and unchanged; every byte of the record is used.
#[test]
fn the_product_survives_its_bytes() {
    for config in [Config::product(), Config::thesis(Law::H { cut: false })] {
        let plan = decode_config(&encode_config(&config)).and_then(Config::plan).expect("accepted");
        assert_eq!(*plan.config(), config);
    }
    assert_eq!(config_bytes_used(), CONFIG_BYTES);
}
