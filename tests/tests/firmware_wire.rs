//! The configuration record that images are told their configuration with.

use control::history::Latency;
use control::wire::{CONFIG_BYTES, decode_config, encode_config};
use control::{Config, InputConfig, Law, LawTable, Limits, Taper, Wheel};
use proptest::prelude::*;

fn laws() -> impl Strategy<Value = Law> {
    // Gaps of 0.2 m/s keep the speeds rising and within 30 m/s.
    let table =
        (-20.0_f32..20.0, prop::collection::vec(-200.0_f32..200.0, 1..=32)).prop_map(|(start, gains)| {
            let points: Vec<_> =
                (0_u8..).zip(gains).map(|(i, gain)| (start + 0.2 * f32::from(i), gain)).collect();
            Law::Table(LawTable::new(&points).expect("a valid table"))
        });
    prop_oneof![
        Just(Law::None),
        any::<bool>().prop_map(|cut| Law::H { cut }),
        Just(Law::F),
        Just(Law::G),
        Just(Law::Cl1),
        any::<f32>().prop_map(|k| Law::Cl2 { k }),
        table,
    ]
}

fn configurations() -> impl Strategy<Value = Config> {
    let input =
        (any::<bool>(), any::<(f32, f32, u16, u16)>()).prop_map(|(rear, (roll, speed, a, b))| InputConfig {
            wheel: if rear { Wheel::Rear } else { Wheel::Front },
            roll_rate_max_rad_s: roll,
            speed_max_m_s: speed,
            roll_rate_max_age_ticks: a,
            speed_max_age_ticks: b,
        });
    let latency = any::<(u16, u16)>().prop_map(|(a, b)| Latency { roll_rate_ticks: a, speed_ticks: b });
    let shape =
        any::<(Option<f32>, Option<f32>, Option<(f32, f32)>)>().prop_map(|(torque, rate, taper)| Limits {
            max_torque_nm: torque,
            rise_nm_s: rate,
            fall_nm_s: rate,
            taper: taper.map(|(zero_m_s, full_m_s)| Taper { zero_m_s, full_m_s }),
            ..Limits::default()
        });
    (any::<f32>(), laws(), input, latency, shape).prop_map(|(rate_hz, law, input, latency, shape)| Config {
        rate_hz,
        law,
        input,
        latency,
        shape,
    })
}

proptest! {
    /// Situation: any configuration, valid or not.
    /// Action: to bytes and back.
    /// Must hold: the same configuration.
    #[test]
    fn a_configuration_survives_its_bytes(config in configurations()) {
        prop_assert_eq!(decode_config(&encode_config(&config)), Ok(config));
    }

    /// Situation: a valid record with any byte changed to any other.
    /// Action: decode it.
    /// Must hold: an error, or a configuration that survives its bytes in every bit.
    #[test]
    fn a_damaged_record_is_refused_or_read(
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

/// Situation: the published and the flashed configuration.
/// Action: bytes, back, plan.
/// Must hold: accepted, unchanged; another length of the record would not have been.
#[test]
fn the_product_survives_its_bytes() {
    for config in [Config::product(), Config::thesis(Law::H { cut: false })] {
        let plan = decode_config(&encode_config(&config)).and_then(Config::plan).expect("accepted");
        assert_eq!(*plan.config(), config);
    }
    assert_ne!(encode_config(&Config::product())[CONFIG_BYTES - 3..], [0; 3], "the taper is the last field");
}
