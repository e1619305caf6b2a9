//! Wheel pulses to samples with ages.

use control::sensors::frame::Sample;
use control::sensors::wheel_speed::WheelPulsesConfig;
use devices::wheel::{WheelState, step};
use std::f64::consts::TAU;

/// A turning wheel, and the board's state of it.
struct RollingWheel {
    config: WheelPulsesConfig,
    state: WheelState,
    distance_m: f64,
    pulses: f64,
}

impl RollingWheel {
    fn new() -> Self {
        Self {
            config: WheelPulsesConfig::default(),
            state: WheelState::default(),
            distance_m: 0.01,
            pulses: 0.0,
        }
    }

    /// A millisecond at `speed`.
    fn roll(&mut self, speed_m_s: f64) -> Sample {
        let pulse_m = TAU * f64::from(self.config.radius_m) / f64::from(self.config.pulses_per_turn);
        self.distance_m += 1e-3 * speed_m_s;
        let pulses = (self.distance_m / pulse_m).floor();
        let edge = (pulses > self.pulses).then(|| {
            let since_s = (self.distance_m - pulses * pulse_m) / speed_m_s;
            (1e6 * since_s) as u32
        });
        self.pulses = pulses;
        step(&self.config, &mut self.state, edge, 1000)
    }
}

/// Situation: from standstill to 4 m/s at 1 m/s^2, then constant. Must hold: the speed is accurate to 2 %; the sample
/// is new with each pulse and ages between two, never by more than their distance.
#[test]
fn the_speed_is_accurate_and_fresh() {
    let mut wheel = RollingWheel::new();
    (0..4000).for_each(|ms| _ = wheel.roll(1e-3 * f64::from(ms)));
    let samples: Vec<_> = (0..1000).map(|_| wheel.roll(4.0)).collect();
    let settled = &samples[100..];
    assert!(settled.iter().all(|sample| (sample.value - 4.0).abs() < 0.08), "{settled:?}");
    let fresh = settled.iter().filter(|sample| sample.age_ticks == 0).count();
    let oldest = settled.iter().map(|sample| sample.age_ticks).max();
    assert!((26..40).contains(&fresh), "{fresh} new samples in 0.9 s, of 26 pulses");
    assert!(oldest.is_some_and(|age| (30..=35).contains(&age)), "{oldest:?}");
}

/// Situation: braked from 4 m/s to standstill at once. Must hold: the missing pulses lower the speed, those samples
/// are new, and the speed is zero within 1 s; the sample of a standing wheel is always fresh.
#[test]
fn missing_pulses_lower_the_speed() {
    let mut wheel = RollingWheel::new();
    (0..2000).for_each(|_| _ = wheel.roll(4.0));
    let stopped: Vec<_> = (0..2000).map(|_| wheel.roll(0.0)).collect();
    let old = stopped.iter().rposition(|sample| sample.age_ticks > 0);
    assert!(old.is_some_and(|ms| ms < 60), "old at {old:?}: {:?}", &stopped[..100]);
    let zero_at = stopped.iter().position(|sample| sample.value == 0.0);
    assert!(zero_at.is_some_and(|ms| (100..1000).contains(&ms)), "{zero_at:?}");
    assert!(stopped[1000..].iter().all(|sample| *sample == Sample::fresh(0.0)));
}

/// Situation: a wheel that never turned. Must hold: speed zero, fresh from the first period on.
#[test]
fn a_wheel_that_never_turned_has_speed_zero() {
    let mut state = WheelState::default();
    for _ in 0..100 {
        assert_eq!(step(&WheelPulsesConfig::default(), &mut state, None, 1000), Sample::fresh(0.0));
    }
    assert_eq!(state.count(), 0);
}

/// Situation: at 4 m/s each pulse is followed by a disturbance edge, 1 ms later. Must hold: those are not counted,
/// and the speed is the same as without them.
#[test]
fn edges_too_close_are_no_pulses() {
    let config = WheelPulsesConfig::default();
    let (mut clean, mut disturbed) = (WheelState::default(), WheelState::default());
    for ms in 0..3400_u32 {
        let pulse = (ms % 34 == 0).then_some(300);
        let echo = (ms % 34 == 1).then_some(300);
        let (a, b) =
            (step(&config, &mut clean, pulse, 1000), step(&config, &mut disturbed, pulse.or(echo), 1000));
        assert_eq!(a, b, "at {ms} ms");
    }
    assert_eq!((clean.count(), disturbed.count()), (100, 100));
    let speed = step(&config, &mut disturbed, None, 1000).value;
    assert!((4.0..4.1).contains(&speed), "{speed}");
}

/// A halt of the chip of 500 ms, in which the wheel rolls, and an edge is captured by a 16-bit timer `edge_age_us` ago.
fn halt(wheel: &mut RollingWheel, distance_m: f64, edge_age_us: Option<u32>) -> Sample {
    let pulse_m = TAU * f64::from(wheel.config.radius_m) / f64::from(wheel.config.pulses_per_turn);
    wheel.distance_m += distance_m;
    wheel.pulses = (wheel.distance_m / pulse_m).floor();
    step(&wheel.config, &mut wheel.state, edge_age_us, 500_000)
}

/// Situation: rolling at 4 m/s, the chip halts for 0.5 s, 14 pulses long, and then finds one edge. Must hold: there
/// is no speed until two more pulses; from then on it is that of the wheel, and never a wrong one in between.
#[test]
fn an_edge_during_a_halt_has_no_age() {
    for edge_age_us in [0, 900, 33_000, 65_000] {
        let mut wheel = RollingWheel::new();
        (0..2000).for_each(|_| _ = wheel.roll(4.0));
        assert_eq!(halt(&mut wheel, 2.0, Some(edge_age_us)).age_ticks, control::sensors::frame::MISSING);
        let after: Vec<_> = (0..300).map(|_| wheel.roll(4.0)).collect();
        let valid = after.iter().position(|sample| sample.age_ticks != control::sensors::frame::MISSING);
        assert!(valid.is_some_and(|ms| (30..=75).contains(&ms)), "{valid:?}");
        let settled = &after[valid.unwrap_or_default()..];
        assert!(settled.iter().all(|sample| (sample.value - 4.0).abs() < 0.2), "{settled:?}");
    }
}

/// Situation: the same, but the wheel was braked meanwhile and stands from then on; and a wheel that stood all the
/// time. Must hold: the first is missing for 1 s, then has speed zero; the other has speed zero at once.
#[test]
fn a_wheel_at_rest_after_a_halt_has_speed_zero() {
    let mut wheel = RollingWheel::new();
    (0..2000).for_each(|_| _ = wheel.roll(4.0));
    halt(&mut wheel, 0.5, Some(100));
    let after: Vec<_> = (0..2000).map(|_| wheel.roll(0.0)).collect();
    let valid = after.iter().position(|sample| sample.age_ticks != control::sensors::frame::MISSING);
    assert!(valid.is_some_and(|ms| (990..=1000).contains(&ms)), "{valid:?}");
    assert!(after[1000..].iter().all(|sample| *sample == Sample::fresh(0.0)));
    let mut standing = RollingWheel::new();
    assert_eq!(halt(&mut standing, 0.0, None), Sample::fresh(0.0));
    assert_eq!(standing.roll(0.0), Sample::fresh(0.0));
}
