//! The dead band of the roll rate on the nonlinear bicycle, in the flashed code and in the ideal law.

use control::{Config, DeadBand};
use sim_host::ride::{Assist, Conditions, IdealLaw, Start, TracePoint, traced};
use tests::basins::{H, alone, configured};

const BAND: DeadBand = DeadBand { roll_rate_rad_s: 0.05 };

/// The law h behind the band, without limits: in the control crate, and in f64.
fn both() -> [Conditions; 2] {
    let ideal = IdealLaw { law: H, dead_band: BAND };
    [
        configured(Config { dead_band: BAND, ..Config::thesis(H) }),
        Conditions { assist: Assist::Ideal(Box::new(ideal)), ..alone() },
    ]
}

fn ridden(conditions: Conditions, steer_rate_rad_s: f64, time_limit_s: f64) -> Vec<TracePoint> {
    let start = Start { speed_m_s: 4.0, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
    let (ride, trace) = traced(&Conditions { time_limit_s, ..conditions }, start);
    assert!(!ride.fell());
    trace
}

/// Situation: 4 m/s, a steer rate of 2 rad/s at once.
/// Action: ride 3 s, with the control crate and with the ideal law.
/// Must hold: at every step the torque is the gain at the measured speed times the measured roll rate outside the band,
/// zero in some steps and above 5 N m in others; the two rides, one sampled and one continuous, differ by less than 0.1 N m.
#[test]
fn the_flashed_and_the_ideal_law_have_the_same_band() {
    let [flashed, ideal] = both().map(|conditions| ridden(conditions, 2.0, 3.0));
    for trace in [&flashed, &ideal] {
        for p in trace {
            let outside = p.measured_roll_rate - p.measured_roll_rate.clamp(-0.05, 0.05);
            let expected = H.gain(p.measured_speed) * outside;
            assert!((p.torque - expected).abs() < 1e-4, "{} s: {}, not {expected} N m", p.t, p.torque);
        }
        assert!(trace.iter().filter(|p| p.torque == 0.0).count() > 50);
        assert!(trace.iter().any(|p| p.torque.abs() > 5.0));
    }
    let largest = flashed.iter().zip(&ideal).map(|(a, b)| (a.torque - b.torque).abs()).fold(0.0, f64::max);
    assert!((1e-6..0.1).contains(&largest), "{largest} N m");
}

/// Situation: 4 m/s, below the weave speed, hands off; a steer rate of 0.1 rad/s at once.
/// Action: ride 30 s, with the band and without.
/// Must hold: without it the motion dies out; with it the bicycle oscillates, in the last 5 s between one and four times the
/// band.
#[test]
fn inside_the_band_an_unstable_bicycle_oscillates() {
    let last = |trace: &[TracePoint]| {
        trace.iter().filter(|p| p.t > 25.0).map(|p| p.roll_rate.abs()).fold(0.0, f64::max)
    };
    let without = last(&ridden(configured(Config::thesis(H)), 0.1, 30.0));
    assert!(without < 1e-4, "{without} rad/s");
    for conditions in both() {
        let with = last(&ridden(conditions, 0.1, 30.0));
        assert!((0.05..0.2).contains(&with), "{with} rad/s");
    }
}
