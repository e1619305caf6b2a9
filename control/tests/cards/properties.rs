//! Properties of the controller for every input.

use control::law::LAWS;
use control::sensors::latency::{Latency, MAX_LATENCY_TICKS};
use control::{
    ActiveLimits, Cause, Config, GainSchedule, Law, Plan, Sample, SensorFrame, State, Taper, Triple, step,
};
use proptest::prelude::*;
use proptest::sample::select;

fn any_sample() -> impl Strategy<Value = Sample> {
    (any::<u32>(), prop_oneof![Just(0_u16), any::<u16>()])
        .prop_map(|(bits, age_ticks)| Sample { value: f32::from_bits(bits), age_ticks })
}

fn plausible_frame() -> impl Strategy<Value = SensorFrame> {
    (-20.0_f32..20.0, -3.0_f32..12.0).prop_map(|(rate, speed)| fresh(rate, speed))
}

fn any_triple() -> impl Strategy<Value = Triple> {
    (any_sample(), any::<[u32; 2]>()).prop_map(|(x, [y, z])| Triple {
        value: [x.value, f32::from_bits(y), f32::from_bits(z)],
        age_ticks: x.age_ticks,
    })
}

fn any_frame() -> impl Strategy<Value = SensorFrame> {
    let others = prop::array::uniform8(any_sample());
    let wild = (any::<(u32, bool)>(), any_triple(), any_triple(), others).prop_map(
        |((now_us, engage), gyro_rad_s, accel_m_s2, [a, b, c, d, e, f, g, h])| SensorFrame {
            now_us,
            gyro_rad_s,
            accel_m_s2,
            steer_rad: a,
            steer_rate_rad_s: b,
            front_wheel_m_s: c,
            rear_wheel_m_s: d,
            rider_torque_nm: e,
            motor_torque_nm: f,
            heading_error_rad: g,
            lateral_error_m: h,
            engage,
        },
    );
    // Plausible frames often enough that switch, self-test and law are reached.
    prop_oneof![4 => plausible_frame(), 1 => wild]
}

fn any_law() -> impl Strategy<Value = Law> {
    let table = GainSchedule::new(&[(0.0, 30.0), (4.0, 12.0), (9.0, -1.0)]).expect("a valid table");
    (select(&LAWS), 0.01_f32..20.0).prop_map(move |(spec, slope)| (spec.build)(slope, table.clone()))
}

/// Call rates: the usual ones, the ends of the range, and between \[Hz\].
fn any_rate() -> impl Strategy<Value = f32> {
    prop_oneof![Just(1000.0_f32), Just(100.0), Just(10_000.0), 100.0_f32..10_000.0]
}

fn any_plan() -> impl Strategy<Value = Plan> {
    let limits = (
        proptest::option::of(0.1_f32..50.0),
        proptest::option::of(1.0_f32..1e5),
        proptest::option::of((0.0_f32..4.0, 0.2_f32..5.0)),
    );
    let ticks = || 0..=MAX_LATENCY_TICKS;
    (any_law(), any_rate(), limits, ticks(), ticks()).prop_map(|(law, rate_hz, limits, a, b)| {
        let mut config = Config { rate_hz, ..Config::thesis(law) };
        config.limits.max_torque_nm = limits.0;
        config.limits.rise_nm_s = limits.1;
        config.limits.fall_nm_s = limits.1;
        config.limits.taper = limits.2.map(|(zero, width)| Taper { zero_m_s: zero, full_m_s: zero + width });
        config.latency = Latency { roll_rate_ticks: a, speed_ticks: b };
        config.plan().expect("in range")
    })
}

fn fresh(roll_rate: f32, speed: f32) -> SensorFrame {
    SensorFrame {
        gyro_rad_s: Triple::fresh([roll_rate, 0.0, 0.0]),
        front_wheel_m_s: Sample::fresh(speed),
        engage: true,
        ..SensorFrame::missing()
    }
}

/// A control period, rounded up \[us\].
fn period_us(plan: &Plan) -> u32 {
    (1e6 / plan.config().rate_hz).ceil() as u32
}

/// The frames, one control period apart.
fn timed(plan: &Plan, frames: &[SensorFrame]) -> Vec<SensorFrame> {
    let period_us = period_us(plan);
    (1..).zip(frames).map(|(tick, frame)| SensorFrame { now_us: period_us * tick, ..*frame }).collect()
}

/// The frame mirrored left to right.
fn mirrored(frame: &SensorFrame) -> SensorFrame {
    let negated = |s: Sample| Sample { value: -s.value, ..s };
    let ([p, q, r], [x, y, z]) = (frame.gyro_rad_s.value, frame.accel_m_s2.value);
    SensorFrame {
        gyro_rad_s: Triple { value: [-p, q, -r], ..frame.gyro_rad_s },
        accel_m_s2: Triple { value: [x, -y, z], ..frame.accel_m_s2 },
        steer_rad: negated(frame.steer_rad),
        steer_rate_rad_s: negated(frame.steer_rate_rad_s),
        rider_torque_nm: negated(frame.rider_torque_nm),
        motor_torque_nm: negated(frame.motor_torque_nm),
        heading_error_rad: negated(frame.heading_error_rad),
        lateral_error_m: negated(frame.lateral_error_m),
        ..*frame
    }
}

/// A controller that has just reached full authority, its sensors at rest at `speed`.
fn engaged(plan: &Plan, speed: f32) -> State {
    let mut state = State::default();
    let rest = fresh(0.0, speed);
    let mut pressed = false;
    let ticks = plan.ticks_to_engage();
    for tick in 0..ticks {
        // The last frame is at time zero.
        let now_us = (tick + 1).wrapping_sub(ticks).wrapping_mul(period_us(plan));
        let command = step(plan, &mut state, &SensorFrame { now_us, engage: pressed, ..rest });
        pressed |= plan.ready(&command);
    }
    assert_eq!(state.authority(), 1.0);
    state
}

proptest! {
    /// Situation: arbitrary configuration and frames of any bits.
    /// Action: step.
    /// Must hold: torque and gain are finite; the torque and its change are inside their limits.
    #[test]
    fn the_torque_is_always_inside_its_limits(
        plan in any_plan(),
        frames in proptest::collection::vec(any_frame(), 1..200),
    ) {
        let mut state = engaged(&plan, 4.0);
        let limits = plan.config().limits;
        for frame in &timed(&plan, &frames) {
            let before = state.torque_nm();
            let command = step(&plan, &mut state, frame);
            prop_assert!(command.torque_nm.is_finite() && command.gain_nm_s_rad.is_finite());
            prop_assert_eq!(command.torque_nm.to_bits(), state.torque_nm().to_bits());
            if let Some(max) = limits.max_torque_nm {
                prop_assert!(command.torque_nm.abs() <= max);
            }
            if let Some(rate) = limits.rise_nm_s {
                // In f64, with tolerance for the rounding of one f32 addition.
                let change = (f64::from(command.torque_nm) - f64::from(before)).abs();
                let tolerance = f64::from(f32::EPSILON) * f64::from(before.abs().max(command.torque_nm.abs()));
                prop_assert!(change <= f64::from(rate / plan.config().rate_hz) * (1.0 + 1e-7) + tolerance, "{change}");
            }
            if state.authority() == 0.0 {
                prop_assert_eq!(command.gain_nm_s_rad, 0.0);
            }
        }
    }

    /// Situation: arbitrary configuration and frames, and their mirror image.
    /// Action: step both.
    /// Must hold: the mirrored torque, to the bit, with the same active limits, mode and causes.
    #[test]
    fn the_torque_is_odd_in_the_roll_rate(
        plan in any_plan(),
        frames in proptest::collection::vec(any_frame(), 1..100),
    ) {
        let (mut right, mut left) = (engaged(&plan, 4.0), engaged(&plan, 4.0));
        for frame in &timed(&plan, &frames) {
            let (a, b) = (step(&plan, &mut right, frame), step(&plan, &mut left, &mirrored(frame)));
            prop_assert_eq!(a.torque_nm, -b.torque_nm);
            prop_assert_eq!((a.limits, a.mode, a.causes), (b.limits, b.mode, b.causes));
        }
    }

    /// Situation: equal latencies of both sensors.
    /// Action: step.
    /// Must hold: the torque of the law alone, to the bit.
    #[test]
    fn equal_latencies_change_nothing(
        ticks in 0..=MAX_LATENCY_TICKS,
        rate_hz in any_rate(),
        frames in proptest::collection::vec(plausible_frame(), 1..100),
    ) {
        let law = Law::H { cut: false };
        let latency = Latency { roll_rate_ticks: ticks, speed_ticks: ticks };
        let plan = Config { rate_hz, latency, ..Config::thesis(law.clone()) }.plan().expect("in range");
        let mut state = engaged(&plan, 4.0);
        for frame in &timed(&plan, &frames) {
            let bare = law.gain(frame.front_wheel_m_s.value) * frame.gyro_rad_s.value[0];
            prop_assert_eq!(step(&plan, &mut state, frame).torque_nm.to_bits(), bare.to_bits());
        }
    }

    /// Situation: any law and speed.
    /// Action: evaluate in f32 and f64.
    /// Must hold: equal within a few units in the last place of the largest term.
    #[test]
    fn laws_in_f32_are_the_laws_in_f64(law in any_law(), speed in -3.0_f32..12.0) {
        let (single, double) = (f64::from(law.gain(speed)), law.gain(f64::from(speed)));
        // f and g have terms up to about 450 that cancel.
        prop_assert!((single - double).abs() < 1e-4 * (1.0 + double.abs()), "{single} {double}");
    }

    /// Situation: any law and speed.
    /// Action: evaluate the law as one formula, for several rides at once.
    /// Must hold: the bits of the gain, or no formula; h, f, g and no law have one, and no law that is zero from a speed on.
    #[test]
    fn a_formula_is_the_gain(law in any_law(), speed in -3.0..30.0) {
        let one_formula = matches!(law, Law::None | Law::H { cut: false } | Law::F | Law::G);
        let expected = one_formula.then(|| f64::to_bits(law.gain(speed)));
        prop_assert_eq!(law.formula(speed).map(f64::to_bits), expected);
    }
}

/// Situation: the published formulas at several speeds.
/// Action: evaluate.
/// Must hold: the gains are those of the formulas as published, with the sign converted to the benchmark's axes.
#[test]
fn the_laws_are_as_published() {
    for v in [0.0_f64, 1.4, 2.8, 4.4, 6.7, 7.4, 7.5, 9.0] {
        assert_eq!(Law::H { cut: false }.gain(v), -(4.0 * v - 30.0) * libm::exp(-0.03 * v * v));
        assert!((Law::F.gain(v) + (-0.88 * v * v + 12.0 * v - 41.0)).abs() < 1e-13);
        assert!((Law::G.gain(v) + (v - 40.0) * libm::exp(-0.35 * v)).abs() < 1e-13);
        assert_eq!(Law::Cl1.gain(v), if v < 6.7 { 5.97 * (6.7 - v) } else { 0.0 });
        assert_eq!(Law::Cl2 { k: 3.0 }.gain(v), 3.0 * (10.0 - v));
        assert_eq!(Law::H { cut: true }.gain(v), if v < 7.5 { Law::H { cut: false }.gain(v) } else { 0.0 });
    }
    // At the crosses of the thesis (eqs 3.8 to 3.10) the slopes of CL2 reproduce the gains.
    assert!((Law::Cl2 { k: 3.0 }.gain(1.4_f64) - 25.8).abs() < 1e-12);
    assert!(Law::H { cut: false }.gain(8.0_f64) < 0.0);
}

/// Situation: a speed sensor with more latency than the gyro.
/// Action: step with numbered samples.
/// Must hold: the law uses samples of one instant, and there is no torque before both exist.
#[test]
fn sensors_are_aligned_by_latency() {
    let table = GainSchedule::new(&[(0.0, 0.0), (30.0, 30.0)]).expect("a valid table");
    let latency = Latency { roll_rate_ticks: 0, speed_ticks: 3 };
    let plan = Config { latency, ..Config::thesis(Law::Table(table)) }.plan().expect("in range");
    let mut state = engaged(&plan, 2.0);
    let gap = SensorFrame { gyro_rad_s: Triple::missing(), ..fresh(0.0, 2.0) };
    for round in 0..2 {
        // A gap clears the history: no torque from samples before it.
        let at = |k: u32, frame| SensorFrame { now_us: 1000 * (1 + 21 * round + k), ..frame };
        let command = step(&plan, &mut state, &at(0, gap));
        assert!(command.causes.has(Cause::GyroLost) && command.torque_nm == 0.0);
        for k in 0..20 {
            let command = step(&plan, &mut state, &at(k + 1, fresh(k as f32, 2.0)));
            let filling = command.causes.has(Cause::Filling);
            if k < 3 {
                assert_eq!((filling, command.torque_nm), (true, 0.0));
            } else {
                assert_eq!((filling, command.torque_nm), (false, 2.0 * (k - 3) as f32));
            }
        }
    }
}

/// Situation: each kind of invalid frame.
/// Action: step.
/// Must hold: the cause is reported, and the torque goes to zero, no faster than its rate limit.
#[test]
fn invalid_frames_are_rejected_with_the_cause() {
    let mut config = Config::thesis(Law::H { cut: false });
    config.limits.fall_nm_s = Some(1000.0);
    let plan = config.plan().expect("in range");
    let late = |gyro: Triple| SensorFrame { gyro_rad_s: gyro, ..fresh(1.0, 4.0) };
    for (frame, cause) in [
        (fresh(f32::NAN, 4.0), Cause::GyroRange),
        (fresh(f32::INFINITY, 4.0), Cause::GyroRange),
        (fresh(60.001, 4.0), Cause::GyroRange),
        (fresh(1.0, f32::NEG_INFINITY), Cause::FrontWheelRange),
        (fresh(1.0, 100.01), Cause::FrontWheelRange),
        (late(Triple { value: [1.0, 0.0, 0.0], age_ticks: 1 }), Cause::GyroLost),
        (late(Triple::missing()), Cause::GyroLost),
        (SensorFrame { front_wheel_m_s: Sample::missing(), ..fresh(1.0, 4.0) }, Cause::FrontWheelLost),
    ] {
        let mut state = engaged(&plan, 4.0);
        for frame in timed(&plan, &[fresh(0.5, 4.0); 20]) {
            step(&plan, &mut state, &frame);
        }
        let before = state.torque_nm();
        assert!(before > 3.5, "{before}");
        let command = step(&plan, &mut state, &SensorFrame { now_us: 21_000, ..frame });
        assert!(command.causes.has(cause), "{:?}", command.causes.iter().collect::<Vec<_>>());
        assert_eq!(command.torque_nm, before - 1.0);
        assert_eq!(command.limits, ActiveLimits::RATE);
    }
}

/// Situation: each parameter out of its range.
/// Action: make a plan.
/// Must hold: rejected with name, value and range.
#[test]
fn parameters_out_of_range_are_named() {
    let rejected = |change: fn(&mut Config)| {
        let mut config = Config::product();
        change(&mut config);
        config.plan().expect_err("out of range")
    };
    for (error, name) in [
        (rejected(|c| c.rate_hz = 99.0), "rate_hz"),
        (rejected(|c| c.law = Law::Cl2 { k: 0.0 }), "law.cl2.k"),
        (rejected(|c| c.law = Law::Table(GainSchedule::default())), "law.table.points"),
        (rejected(|c| c.calibration.imu_rad = [0.0, f32::NAN, 0.0]), "calibration.imu_pitch_rad"),
        (rejected(|c| c.input.gyro.max = f32::NAN), "input.gyro.max"),
        (rejected(|c| c.input.front_wheel.timeout_ticks = 10_001), "input.front_wheel.timeout_ticks"),
        (rejected(|c| c.input.recent_samples = 7), "input.recent_samples"),
        (rejected(|c| c.permit.parked_m_s = Some(0.0)), "permit.parked_m_s"),
        (rejected(|c| c.latency.speed_ticks = 32), "latency.speed_ticks"),
        (rejected(|c| c.limits.max_torque_nm = Some(-1.0)), "max_torque_nm"),
        (rejected(|c| c.limits.rise_nm_s = Some(f32::INFINITY)), "rise_nm_s"),
        (rejected(|c| c.limits.taper = Some(Taper { zero_m_s: 2.0, full_m_s: 1.0 })), "full_m_s"),
    ] {
        assert!(error.to_string().contains(name) && error.to_string().contains(&error.leaf.max.to_string()));
    }
    assert!(GainSchedule::new(&[(1.0, 2.0), (1.0, 3.0)]).is_err());
    assert!(GainSchedule::new(&[(f32::NAN, 2.0)]).is_err());
}
