//! The flashed code's parameters by name.

use control::{Config, Law};
use proptest::prelude::*;
use sim_host::parameters::{departing, list, set};

/// Situation: a parameter of each kind.
/// Action: set it.
/// Must hold: it has the value; a wrong name, value or range is rejected with the allowed ones.
#[test]
fn each_kind_is_set() {
    let mut config = Config::thesis(Law::None);
    for (key, value) in [
        ("rate_hz", "500"),
        ("limits.end_stop", "on"),
        ("limits.end_stop.soft_rad", "0.7"),
        ("limits.max_torque_nm", "4"),
        ("input.wheel", "rear"),
        ("input.gyro.timeout_ticks", "7"),
    ] {
        set(&mut config, key, value).unwrap();
        assert!(list(&config).contains(&(key.into(), value.into())), "{key}");
    }
    assert_eq!((config.rate_hz, config.limits.max_torque_nm), (500.0, Some(4.0)));
    assert_eq!(config.limits.end_stop.map(|e| e.soft_rad), Some(0.7));
    assert_eq!((config.input.wheel, config.input.gyro.timeout_ticks), (control::Wheel::Rear, 7));
    set(&mut config, "limits.max_torque_nm", "none").unwrap();
    assert_eq!(config.limits.max_torque_nm, None);
    for (key, value, why) in [
        ("rate", "3", "no parameter rate; nearest are rate_hz, "),
        (
            "cross.yaw_rad",
            "3",
            "nearest are cross.yaw_rad_s, cross.yaw_slow_rad_s, cross.yaw_slope; `sim-host param list",
        ),
        ("rate_hz", "x", "not a number"),
        ("rate_hz", "1e9", "outside 100 to 10000"),
        ("input.gyro.timeout_ticks", "1.5", "whole"),
        ("input.wheel", "left", "front, rear"),
        ("limits.end_stop", "2", "off, on"),
    ] {
        let error = set(&mut config, key, value).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}

/// Situation: the flashed configuration.
/// Action: set its differences from the published one, on that.
/// Must hold: the same except for the law.
#[test]
fn a_list_reproduces_the_configuration() {
    let (product, mut config) = (Config::product(), Config::thesis(Law::H { cut: true }));
    let departing = departing(&product, &config);
    assert!((30..200).contains(&departing.len()), "{}", departing.len());
    for (key, value) in &departing {
        set(&mut config, key, value).unwrap();
    }
    assert_eq!(config, product);
}

proptest! {
    /// Situation: any texts.
    /// Action: set.
    /// Must hold: a result or an error, never a panic.
    #[test]
    fn any_text_is_answered(key in "\\PC*", value in "\\PC*") {
        let mut config = Config::thesis(Law::None);
        prop_assert!(set(&mut config, &key, &value).is_err());
        let _ = set(&mut config, "limits.rise_nm_s", &value);
    }
}
