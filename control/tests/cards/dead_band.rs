//! The dead band of the roll rate, in front of any law.

use control::{Config, DeadBand, Law, Sample, SensorFrame, State, Triple, step};
use proptest::prelude::*;

/// Torques of 0.2 s at constant roll rate and speed, every sample fresh \[N m\].
fn torques(config: &Config, roll_rate_rad_s: f32, speed_m_s: f32) -> Vec<f32> {
    let plan = config.clone().plan().expect("a valid configuration");
    let mut state = State::default();
    let frame = |tick: u32| SensorFrame {
        now_us: 1000 * tick,
        gyro_rad_s: Triple::fresh([roll_rate_rad_s, 0.0, 0.0]),
        front_wheel_m_s: Sample::fresh(speed_m_s),
        rear_wheel_m_s: Sample::fresh(speed_m_s),
        engage: tick > 10,
        ..SensorFrame::missing()
    };
    (0..200).map(|tick| step(&plan, &mut state, &frame(tick)).torque_nm).collect()
}

fn with_band(law: Law, roll_rate_rad_s: f32) -> Config {
    Config { dead_band: DeadBand { roll_rate_rad_s }, ..Config::thesis(law) }
}

proptest! {
    /// Situation: any band, any two roll rates.
    /// Action: apply the band, in f32 and in f64.
    /// Must hold: zero inside; outside the roll rate less the band, with its sign; never a larger change than that of the
    /// roll rate, so no step at the edge; the two number types differ by less than their rounding.
    #[test]
    fn the_band_is_removed_without_a_step(band in 0.001_f32..1.0, one in -5.0_f32..5.0, other in -5.0_f32..5.0) {
        let dead_band = DeadBand { roll_rate_rad_s: band };
        let (a, b) = (dead_band.excess(one), dead_band.excess(other));
        prop_assert_eq!(a == 0.0, one.abs() <= band);
        prop_assert_eq!(a, if a == 0.0 { 0.0 } else { one - band.copysign(one) });
        prop_assert_eq!(dead_band.excess(-one), -a);
        prop_assert!((a - b).abs() <= (one - other).abs() + 1e-6);
        prop_assert!((f64::from(a) - dead_band.excess(f64::from(one))).abs() < 1e-6);
    }

    /// Situation: no band, any bits of a roll rate.
    /// Action: apply it.
    /// Must hold: the same bits, of -0 and of NaN too.
    #[test]
    fn without_a_band_every_bit_stays(bits in any::<u32>()) {
        let off = DeadBand::default();
        prop_assert_eq!(off.excess(f32::from_bits(bits)).to_bits(), bits);
        let wide = f64::from(f32::from_bits(bits));
        prop_assert_eq!(off.excess(wide).to_bits(), wide.to_bits());
    }
}

/// Situation: law h at 4 m/s, 8.663 N m s/rad, without limits; bands of 0 and 0.05 rad/s.
/// Action: roll at constant rates, to both sides.
/// Must hold: gain times the roll rate outside the band: none at 0.04 rad/s, 0.087 N m at 0.06, 3.898 at 0.5; without a band
/// gain times the roll rate.
#[test]
fn the_law_acts_outside_the_band() {
    let law = || Law::H { cut: false };
    for (band, roll_rate, expected_nm) in [
        (0.05, 0.04, 0.0),
        (0.05, 0.06, 0.0866),
        (0.05, 0.5, 3.8983),
        (0.0, 0.04, 0.3465),
        (0.0, 0.5, 4.3315),
    ] {
        for sign in [1.0, -1.0] {
            let got = torques(&with_band(law(), band), sign * roll_rate, 4.0)[199];
            assert!((got - sign * expected_nm).abs() < 1e-3, "{band} {roll_rate}: {got} N m");
        }
    }
}

/// Situation: the laws h, cl2 and a balance assist, each with a band of 0.1 rad/s, with the flashed limits.
/// Action: roll at rates from 0 to 3 rad/s, at 2 and 4 m/s.
/// Must hold: the torque with the band is the one without it at the roll rate less the band; the guard finds nothing.
#[test]
fn any_law_has_the_same_band() {
    for law in [Law::H { cut: true }, Law::Cl2 { k: 3.7 }, Law::BalanceAssist { kappa: 5.2 }] {
        let limits = Config::product().limits;
        let with = Config { limits, ..with_band(law.clone(), 0.1) };
        let without = Config { limits, ..Config::thesis(law) };
        for (i, speed) in (0..=30_u8).zip([2.0, 4.0].into_iter().cycle()) {
            let roll_rate = 0.1 * f32::from(i);
            let (got, expected) =
                (torques(&with, roll_rate, speed), torques(&without, (roll_rate - 0.1).max(0.0), speed));
            for (got, expected) in got.iter().zip(&expected) {
                assert!((got - expected).abs() < 1e-4, "{roll_rate} rad/s: {got}, not {expected} N m");
            }
            assert!(expected[199] <= 7.0 && (i < 2) == (expected[199] == 0.0), "{}", expected[199]);
        }
    }
}

/// Situation: a band that is negative, too wide, or not a number.
/// Action: plan.
/// Must hold: rejected with the parameter and its range.
#[test]
fn a_band_out_of_range_is_rejected() {
    for band in [-0.1, 1.1, f32::NAN] {
        let error = with_band(Law::F, band).plan().expect_err("out of range").to_string();
        assert_eq!(error, format!("dead_band.roll_rate_rad_s = {band} is outside 0 to 1"));
    }
    assert!(with_band(Law::F, 1.0).plan().is_ok());
}

/// Situation: the polarity check of the flashed configuration is due; a band of 0.1 rad/s.
/// Action: roll at 0.05 and at 0.3 rad/s to the right, at rest.
/// Must hold: the torque shown by the check is that of the law behind its band, at 4 m/s: none, and 1.73 N m.
#[test]
fn the_polarity_check_shows_the_torque_behind_the_band() {
    for (roll_rate, expected_nm) in [(0.05, 0.0), (0.3, 1.7326)] {
        let config = Config { dead_band: DeadBand { roll_rate_rad_s: 0.1 }, ..Config::product() };
        let plan = config.plan().expect("a valid configuration");
        let mut state = State::default();
        for tick in 0..200 {
            let frame = SensorFrame {
                now_us: 1000 * tick,
                gyro_rad_s: Triple::fresh([roll_rate + 1e-5 * tick as f32, 0.0, 0.0]),
                front_wheel_m_s: Sample::fresh(0.0),
                rear_wheel_m_s: Sample::fresh(0.0),
                ..SensorFrame::missing()
            };
            let _ = step(&plan, &mut state, &frame);
        }
        assert!(
            (state.polarity_torque_nm() - expected_nm).abs() < 0.02,
            "{} N m",
            state.polarity_torque_nm()
        );
    }
}
