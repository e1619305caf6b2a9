//! Which configurations make the controller estimate the motion.

use control::estimate::Source;
use control::law::path_tracking::PathTracking;
use control::sensors::sign_check::SteerModel;
use control::{Config, Law, Sample, SensorFrame, State, Triple, step};

/// Turns a function on.
type Change = fn(&mut Config);

/// Estimated roll angle after 0.5 s at a roll rate of 0.2 rad/s \[rad\].
fn roll_rad(config: Config) -> f32 {
    let plan = config.plan().expect("a valid configuration");
    let mut state = State::default();
    for ms in 0..500 {
        let frame = SensorFrame {
            now_us: 1000 * ms,
            gyro_rad_s: Triple::fresh([0.2, 0.0, 0.0]),
            front_wheel_m_s: Sample::fresh(4.0),
            ..SensorFrame::missing()
        };
        let _ = step(&plan, &mut state, &frame);
    }
    state.roll().angle_rad
}

/// Situation: the thesis configuration, in which nothing needs the estimated motion, and the same with one function on
/// that needs it.
/// Action: roll at 0.2 rad/s for 0.5 s.
/// Must hold: the roll angle is estimated, 0.05 to 0.15 rad, with each of the functions, and stays 0 without.
#[test]
fn each_function_that_needs_the_motion_has_it() {
    let with = |change: Change| {
        let mut config = Config::thesis(Law::H { cut: true });
        change(&mut config);
        roll_rad(config)
    };
    assert_eq!(with(|_| ()), 0.0);
    let functions: [(&str, Change); 11] = [
        ("estimate.roll_rate", |c| c.estimate.roll_rate = Source::Estimate),
        ("capsize", |c| c.capsize.k_c = 1.0),
        ("cross.wheels_m_s", |c| c.cross.wheels_m_s = Some(0.8)),
        ("cross.yaw_rad_s", |c| c.cross.yaw_rad_s = Some(2.0)),
        ("cross.yaw_slow_rad_s", |c| c.cross.yaw_slow_rad_s = Some(0.5)),
        ("cross.yaw_slope", |c| c.cross.yaw_slope = true),
        ("cross.roll_correlation", |c| c.cross.roll_correlation = true),
        ("response.motor", |c| c.response.motor = Some(SteerModel::default())),
        ("permit.fallen_rad", |c| c.permit.fallen_rad = Some(1.0)),
        ("permit.roll_unknown_rad", |c| c.permit.roll_unknown_rad = Some(0.5)),
        ("track", |c| c.track = Some(PathTracking::default())),
    ];
    for (name, change) in functions {
        assert!((0.05..0.15).contains(&with(change)), "{name}: {}", with(change));
    }
    assert!((0.05..0.15).contains(&with(|c| c.predict.lead_s = 0.01)), "predict.lead_s");
}
