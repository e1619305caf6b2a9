//! Compensation of late sensors and a slow actuator.

use control::Law;
use control::estimate::predict::{PredictConfig, step};
use control::estimate::{EstimateConfig, Motion, Source};
use proptest::prelude::*;
use sim_host::bicycle::Geometry;
use sim_host::bicycle::onboard::estimator_parameters;
use sim_host::ride::Start;
use tests::late::{Late, PredictedMotion};
use tests::model::{LinearBicycle, Model, OnTheWay};
use tests::rides::shipped;

fn any_motion() -> impl Strategy<Value = Motion> {
    (-1.5_f32..1.5, any::<u32>(), -1e5_f32..1e5).prop_map(|(roll_rad, rate, roll_accel_rad_s2)| {
        let rate = f32::from_bits(rate);
        let roll_rate_rad_s = if rate.is_finite() { rate % 100.0 } else { 0.0 };
        Motion { roll_rad, roll_rate_rad_s, roll_accel_rad_s2, ..Motion::default() }
    })
}

proptest! {
    /// Situation: any motion.
    /// Action: predict with the default configuration.
    /// Must hold: unchanged to the bit.
    #[test]
    fn off_changes_no_bit(now in any_motion()) {
        let ahead = step(&PredictConfig::default(), &now);
        prop_assert_eq!(ahead.roll_rate_rad_s.to_bits(), now.roll_rate_rad_s.to_bits());
        prop_assert_eq!(ahead.roll_rad.to_bits(), now.roll_rad.to_bits());
    }

    /// Situation: any motion and its mirror image.
    /// Action: predict.
    /// Must hold: the correction is mirrored to the bit, finite, within its limit, and equal to linear extrapolation
    /// where that is less.
    #[test]
    fn a_lead_is_bounded_and_mirrors(now in any_motion(), lead_s in 0.001_f32..0.1) {
        let config = PredictConfig { lead_s, ..PredictConfig::default() };
        let ahead = step(&config, &now);
        let mirrored = Motion {
            roll_rad: -now.roll_rad,
            roll_rate_rad_s: -now.roll_rate_rad_s,
            roll_accel_rad_s2: -now.roll_accel_rad_s2,
            ..now
        };
        let left = step(&config, &mirrored);
        prop_assert_eq!((ahead.roll_rad, ahead.roll_rate_rad_s), (-left.roll_rad, -left.roll_rate_rad_s));
        let added = ahead.roll_rate_rad_s - now.roll_rate_rad_s;
        let line = lead_s * now.roll_accel_rad_s2;
        prop_assert!(added.abs() <= config.max_rad_s + 1e-4 && ahead.roll_rad.is_finite());
        prop_assert!((added - line.clamp(-config.max_rad_s, config.max_rad_s)).abs() < 1e-4);
    }
}

fn jason() -> (Geometry, LinearBicycle, EstimateConfig) {
    let parameters = shipped("rigid_jason").parameters;
    let b = Geometry::new(&parameters);
    let estimate = EstimateConfig { roll_rate: Source::Estimate, ..estimator_parameters(&b) };
    (b, LinearBicycle::new(&parameters), estimate)
}

/// Situation: sensors 30 ms late at 4.5 m/s, the law h.
/// Action: search the border without and with a lead of the delay.
/// Must hold: the lead regains most of the height lost to the delay; half a lead and one half longer still regain
/// more than half.
#[test]
fn a_lead_regains_the_basin() {
    let (b, _, estimate) = jason();
    let law = Law::H { cut: false };
    let height = |sensors_ms, ahead| {
        let late = Late {
            bicycle: &b,
            rider: None,
            law: &law,
            sensors_ms,
            actuator_s: 0.0,
            estimate,
            ahead,
            noise: None,
            seconds: 6.0,
        };
        late.height(4.5, 12.0)
    };
    let (prompt, late) = (height(0, PredictedMotion::Off), height(30, PredictedMotion::Off));
    let won = |lead| (height(30, PredictedMotion::Lead(lead)) - late) / (prompt - late);
    let (half, whole, more) = (won(0.015), won(0.03), won(0.045));
    println!("prompt {prompt:.2}, late {late:.2} rad/s; won back {half:.2}, {whole:.2}, {more:.2}");
    assert!(prompt - late > 1.5, "{prompt} {late}");
    assert!((0.6..1.0).contains(&whole) && half > 0.4 && more > 0.6, "{half} {whole} {more}");
}

/// Situation: calm riding with the noise of a consumer IMU.
/// Action: lead by 30 ms.
/// Must hold: the noise in the torque grows, but not beyond the threshold of a rider's perception (half a newton
/// metre) or beyond a change that a rate limit of 100 N m/s limits half the time.
#[test]
fn a_lead_costs_noise() {
    let (b, _, estimate) = jason();
    let law = Law::H { cut: false };
    let calm = |ahead| {
        let late = Late {
            bicycle: &b,
            rider: None,
            law: &law,
            sensors_ms: 0,
            actuator_s: 0.0,
            estimate,
            ahead,
            noise: Some(1),
            seconds: 6.0,
        };
        late.ride(Start { speed_m_s: 5.0, ..Start::default() })
    };
    let (without, with) = (calm(PredictedMotion::Off), calm(PredictedMotion::Lead(0.03)));
    println!("{without:?} {with:?}");
    assert!(with.rms_nm > 1.2 * without.rms_nm && with.rms_nm < 0.6, "{with:?}");
    assert!(with.rms_nm_s > 1.5 * without.rms_nm_s && with.rms_nm_s < 3.0 * without.rms_nm_s, "{with:?}");
}

/// Situation: the linear bicycle of the comparison, a continually changing torque.
/// Action: predict over 40 ms and then integrate those with fine steps.
/// Must hold: roll and roll rate agree.
#[test]
fn the_model_of_the_comparison_predicts_the_linear_bicycle() {
    let (_, bicycle, _) = jason();
    let model = Model::new(&bicycle, 0.04, 1e-3);
    let mut torques = OnTheWay::default();
    let torque = |i: usize| (0.05 * i as f32).sin();
    (0..40).for_each(|i| torques.commanded(&model, torque(i)));
    let v = 4.3;
    let now = Motion {
        roll_rad: 0.4,
        steer_rad: -0.05,
        roll_rate_rad_s: 0.3,
        steer_rate_rad_s: 0.8,
        speed_m_s: v,
        ..Motion::default()
    };
    let ahead = model.ahead(&torques, &now);
    let mut x = [now.roll_rad, now.steer_rad, now.roll_rate_rad_s, now.steer_rate_rad_s];
    for i in 0..40 {
        x = bicycle.moved(v, torque(i), x, 1e-3);
    }
    println!("{} {} against {x:?}", ahead.roll_rad, ahead.roll_rate_rad_s);
    assert!((ahead.roll_rad - x[0]).abs() < 5e-4 && (ahead.roll_rate_rad_s - x[2]).abs() < 0.01);
    assert!((x[2] - now.roll_rate_rad_s).abs() > 0.05);
}
