//! Identification of a closed loop whose law and bicycle are known.

use sim_host::bicycle::{Parameters, catalogue, linear::Linear};
use sim_host::closed_loop::{
    Channel, Gain, Geometry, Identified, Law, Record, RecordError, Signal, identify,
};
use tests::closed_loop::{Loop, PERIOD_S, ride};

fn bicycle() -> Parameters {
    catalogue::load("benchmark").expect("a bicycle").parameters
}

fn identified(record: &Record) -> Identified {
    let Parameters { w, lam, .. } = bicycle();
    identify(record, Some(&Geometry { wheelbase_m: w, tilt_rad: lam })).expect("a usable recording")
}

fn gain(law: &Law, signal: Signal) -> &Gain {
    law.gains.iter().find(|gain| gain.signal == signal).unwrap_or_else(|| panic!("{signal:?}: {law:?}"))
}

/// Situation: a law of roll rate, speed and steer angle, two samples late, without any noise; for a third of the ride it is
/// off by a constant.
/// Must hold: lag, gains, slope and the speed at which the gain vanishes are exact to 1e-6, and the third is left out.
#[test]
fn a_law_is_found_exactly() {
    let how = Loop { steer: -3.0, lag: 2, seconds: 30.0, ..Loop::default() };
    let mut record = ride(&how, &bicycle(), 1);
    record.torque_nm[1000..2000].iter_mut().for_each(|torque| *torque += 2.0);
    let all = identified(&record);
    let law = all.law.found().expect("a law");
    assert!((law.lag_s - 2.0 * PERIOD_S).abs() < 1e-9, "{}", law.lag_s);
    let [rate, steer] = [Signal::RollRate, Signal::Steer].map(|signal| gain(law, signal));
    let should = 8.0 - 2.0 * (law.speed_m_s - 4.0);
    assert!((rate.gain.value - should).abs() < 1e-6, "{rate:?}, {should}");
    assert!((rate.per_speed.expect("a slope").value + 2.0).abs() < 1e-6, "{rate:?}");
    assert!((steer.gain.value + 3.0).abs() < 1e-6 && rate.acts && steer.acts, "{steer:?}");
    assert!(!gain(law, Signal::Roll).acts, "{law:?}");
    assert!((law.vanishes_m_s.expect("a speed").value - 8.0).abs() < 1e-5, "{law:?}");
    assert!((0.6..0.7).contains(&law.followed) && law.vaf_followed > 0.999_999, "{law:?}");
}

/// Situation: the same law, its recorded torque with an error, twenty rides.
/// Must hold: every gain within four standard errors, and 85 to 100 % of the 95 % intervals hold it; that of the roll rate is
/// narrower than 10 % of the gain.
#[test]
fn intervals_of_a_law_hold_it() {
    let how = Loop { steer: -3.0, error_nm: 0.1, ..Loop::default() };
    let (mut held, mut all) = (0, 0);
    for seed in 1..=20 {
        let identified = identified(&ride(&how, &bicycle(), seed));
        let law = identified.law.found().expect("a law");
        let should = 8.0 - 2.0 * (law.speed_m_s - 4.0);
        for (signal, should, widest) in
            [(Signal::RollRate, should, 0.8), (Signal::Steer, -3.0, 20.0), (Signal::Roll, 0.0, 20.0)]
        {
            let estimate = gain(law, signal).gain;
            let off = (estimate.value - should).abs();
            assert!(off <= 4.0 * estimate.standard_error, "{seed}, {signal:?}: {estimate:?}, {should}");
            assert!(estimate.high - estimate.low < widest, "{signal:?}: {estimate:?}");
            held += usize::from(estimate.holds(should));
            all += 1;
        }
    }
    assert!(held * 100 >= 85 * all, "{held} of {all}");
}

/// Situation: a signal that is a multiple of another, and one that stands still.
/// Must hold: both are refused with the reason; the other gains stay right.
#[test]
fn signals_that_cannot_be_separated_are_refused() {
    let mut record = ride(&Loop { error_nm: 0.05, ..Loop::default() }, &bicycle(), 3);
    let copy = record.channel(Signal::RollRate).expect("a roll rate").iter().map(|x| 0.3 * x).collect();
    record.channels.push(Channel { signal: Signal::SteerRate, values: copy });
    record.channels.push(Channel { signal: Signal::RiderTorque, values: vec![0.7; record.times_s.len()] });
    let all = identified(&record);
    let law = all.law.found().expect("a law");
    let why = |signal| {
        let refused = law.refused.iter().find(|refused| refused.signal == signal && !refused.per_speed);
        refused.map(|refused| refused.why.as_str()).unwrap_or_default()
    };
    assert!(why(Signal::SteerRate).contains("above all of roll-rate"), "{law:?}");
    assert!(why(Signal::RiderTorque).contains("does not change"), "{law:?}");
    assert!(gain(law, Signal::RollRate).gain.holds(8.0 - 2.0 * (law.speed_m_s - 4.0)), "{law:?}");
}

/// Situation: the steer sensor says too little by 1.6, and 0.05 rad beside; another ride with the right scale.
/// Must hold: both scales and offsets are in their intervals, which are narrower than 10 %; the trail is the bicycle's.
#[test]
fn a_wrong_steer_scale_is_found() {
    for scale in [(1.6, 0.05), (1.0, 0.0)] {
        let record = ride(&Loop { scale, gyro_rad_s: 0.02, ..Loop::default() }, &bicycle(), 5);
        let all = identified(&record);
        let found = all.steer_scale.found().unwrap_or_else(|| panic!("{:?}", all.steer_scale));
        assert!(found.scale.holds(scale.0) && found.scale.high < 1.1 * found.scale.low, "{found:?}");
        assert!(found.offset_rad.holds(scale.1), "{found:?}");
        assert!((found.trail_m.expect("a trail").value - bicycle().c).abs() < 0.02, "{found:?}");
    }
}

/// Situation: a yaw rate without noise: it was computed from the steer angle.
/// Must hold: the scale is refused with this reason.
#[test]
fn a_computed_yaw_rate_says_nothing() {
    let all = identified(&ride(&Loop::default(), &bicycle(), 2));
    assert!(all.steer_scale.reason().is_some_and(|why| why.contains("computed from it")), "{all:?}");
}

/// Situation: a law behind a low-pass of 100 ms, with a noisy gyro.
/// Must hold: internal states are found, and the response at 2 and 8 Hz is that of the low-pass; the law of one instant is
/// refused.
#[test]
fn a_law_with_memory_is_found() {
    let how =
        Loop { roll_rate: (8.0, 0.0), filter_s: 0.1, error_nm: 0.02, gyro_rad_s: 0.05, ..Loop::default() };
    let all = identified(&ride(&how, &bicycle(), 4));
    let found = all.memory.found().unwrap_or_else(|| panic!("{:?}", all.memory));
    assert!(found.states >= 1 && found.vaf > 0.99 && found.vaf_without < found.vaf, "{found:?}");
    for frequency in [2.0, 8.0] {
        let same =
            |r: &&sim_host::closed_loop::Response| r.input == Signal::RollRate && r.frequency_hz == frequency;
        let response = found.responses.iter().find(same).expect("a response");
        let (share, turn) = (PERIOD_S / how.filter_s, std::f64::consts::TAU * frequency * PERIOD_S);
        let past = 1.0 - share;
        let should = 8.0 * share / (1.0 - 2.0 * past * turn.cos() + past * past).sqrt();
        assert!((response.magnitude.value / should - 1.0).abs() < 0.03, "{response:?}, {should}");
        assert!(
            response.magnitude.low <= should && should <= response.magnitude.high,
            "{response:?}, {should}"
        );
    }
    assert!(all.law.reason().is_some_and(|why| why.contains("past")), "{:?}", all.law);
}

/// Situation: viscous friction of 1.5 N m s/rad; the torque has a part of its own beside the law. Another ride without that
/// part.
/// Must hold: inertia and friction lie between the two regressions, at most 2 apart; without the part both are refused,
/// with the closed loop as the reason.
#[test]
fn inertia_needs_a_torque_beside_the_law() {
    let bicycle = bicycle();
    let how = Loop { dither_nm: 3.0, viscous: 1.5, gyro_rad_s: 0.002, ..Loop::default() };
    let all = identified(&ride(&how, &bicycle, 6));
    let found = all.steer_dynamics.found().unwrap_or_else(|| panic!("{:?}", all.steer_dynamics));
    let inertia = found.inertia_kg_m2;
    let should = Linear::new(&bicycle).m[(1, 1)];
    assert!(
        inertia.low < should && should < inertia.high && inertia.high < 2.0 * inertia.low,
        "{inertia:?}, {should}"
    );
    let alone = identified(&ride(&Loop { dither_nm: 0.0, ..how }, &bicycle, 6));
    assert!(
        alone.steer_dynamics.reason().is_some_and(|why| why.contains("the controller made")),
        "{:?}",
        alone.steer_dynamics
    );
}

/// Situation: recordings that are too short, out of order, idle, empty or of unequal length.
/// Must hold: each is refused with its own error.
#[test]
fn unusable_recordings_are_named() {
    let good = ride(&Loop { seconds: 10.0, ..Loop::default() }, &bicycle(), 1);
    let changed = |change: fn(&mut Record)| {
        let mut record = good.clone();
        change(&mut record);
        identify(&record, None).expect_err("an error")
    };
    assert!(matches!(changed(|r| r.times_s[500] = 0.0), RecordError::Unsorted { sample: 500, .. }));
    assert!(matches!(changed(|r| r.torque_nm.fill(1.0)), RecordError::Idle { .. }));
    assert!(matches!(changed(|r| r.torque_nm.fill(f64::NAN)), RecordError::NoTorque));
    assert!(matches!(changed(|r| r.speed_m_s.truncate(9)), RecordError::Lengths));
    let short = ride(&Loop { seconds: 1.0, ..Loop::default() }, &bicycle(), 1);
    assert!(matches!(identify(&short, None), Err(RecordError::Short { .. })));
    let mut standing = good.clone();
    standing.speed_m_s.fill(0.0);
    let all = identified(&standing);
    assert!(all.steer_scale.reason().is_some_and(|why| why.contains("rides for 0.0 s")), "{all:?}");
    assert!(all.steer_dynamics.reason().is_some() && all.memory.reason().is_some(), "{all:?}");
}
