//! Properties for every input.

use control::param::{ParamSpec, ParamVisitor};
use motor::example::EXAMPLE;
use motor::{Config, Inputs, Mode, MotorCommand, Output, Phases, Plan, State, step};
use proptest::prelude::*;

fn any_bits() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

fn any_command() -> impl Strategy<Value = MotorCommand> {
    prop_oneof![
        1 => Just(MotorCommand::Off),
        1 => Just(MotorCommand::Align),
        6 => (-20.0_f32..20.0).prop_map(MotorCommand::Torque),
        1 => any_bits().prop_map(MotorCommand::Torque),
    ]
}

/// Mostly plausible inputs, so that the bridge is often closed; sometimes arbitrary bits.
fn any_inputs() -> impl Strategy<Value = Inputs> {
    let current = || prop_oneof![40 => -16.0_f32..16.0, 1 => any_bits()];
    let phases = prop_oneof![
        prop::array::uniform2(current()).prop_map(Phases::Two),
        prop::array::uniform2(current()).prop_map(|[a, b]| Phases::Three([a, b, -a - b])),
    ];
    let bus = prop_oneof![40 => 16.0_f32..32.0, 1 => any_bits()];
    let temperature = prop_oneof![40 => 0.0_f32..100.0, 1 => any_bits()];
    let age = prop_oneof![20 => 0_u16..5, 1 => any::<u16>()];
    let counts = prop_oneof![10 => 0_u16..100, 1 => any::<u16>()];
    (phases, bus, temperature, counts, age, any_command()).prop_map(
        |(phases, bus_v, temperature_c, angle_counts, angle_age_calls, command)| Inputs {
            phases,
            bus_v,
            angle_counts,
            angle_age_calls,
            temperature_c,
            command,
        },
    )
}

/// The example with protections so wide that only implausible inputs open the bridge.
fn wide() -> Config {
    let mut c = EXAMPLE;
    c.encoder.offset_turns = Some(0.1);
    c.zero.samples = 1;
    (c.sensors.trip_a, c.follow.error_a, c.emf.error_v) = (60.0, 100.0, 50.0);
    c.angle.error_v = 50.0;
    (c.align.ramp_calls, c.align.move_calls, c.align.rest_calls) = (3, 3, 4);
    c
}

/// Draws every parameter in its range, linearly or logarithmically.
struct Draw(u64);

impl Draw {
    fn part(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }
    fn between(&mut self, leaf: &ParamSpec) -> f32 {
        let part = self.part();
        let x = if leaf.min > 0.0 && self.part() < 0.7 {
            leaf.min * (leaf.max / leaf.min).powf(part)
        } else {
            leaf.min + (leaf.max - leaf.min) * part
        };
        x.clamp(leaf.min, leaf.max)
    }
}

impl ParamVisitor for Draw {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        *value = self.between(leaf);
    }
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>) {
        *value = Some(self.between(leaf));
    }
    fn count(&mut self, leaf: &ParamSpec, value: &mut u16) {
        *value = (self.between(leaf).round() as u16).max(leaf.min as u16);
    }
    fn switch(&mut self, _: &ParamSpec, value: &mut bool) {
        *value = self.part() < 0.5;
    }
    fn choice(&mut self, _: &ParamSpec, _: &'static [&'static str], _: &mut u8) {}
}

/// Any valid configuration, with its offset measurement shortened.
fn drawn(seed: u64) -> Config {
    let mut c = EXAMPLE;
    c.visit_params(&mut Draw(seed));
    c.zero = EXAMPLE.zero;
    c.zero.samples = 1;
    c.current.bandwidth_hz = c.current.bandwidth_hz.min(c.rate_hz / 13.0);
    c.current.max_a = c.current.max_a.min(100.0);
    c.align.current_a = c.align.current_a.min(c.current.max_a);
    (c.sensors.trip_a, c.sensors.range_a) = (1.3 * c.current.max_a, 2.0 * c.current.max_a);
    (c.supply.low_v, c.supply.sag_v, c.supply.high_v) = (15.0, 16.0, 33.0);
    (c.temperature.warm_c, c.temperature.hot_c) = (80.0, 110.0);
    c.encoder.jump_turns = c.encoder.jump_turns.min(0.1 / f32::from(c.motor.pole_pairs));
    c
}

fn rest(command: MotorCommand) -> Inputs {
    Inputs {
        phases: Phases::Three([0.0; 3]),
        bus_v: 24.0,
        angle_counts: 0,
        angle_age_calls: 0,
        temperature_c: 25.0,
        command,
    }
}

fn started(plan: &Plan) -> State {
    let mut state = State::default();
    let _ = step(plan, &mut state, &rest(MotorCommand::Off));
    assert_eq!(step(plan, &mut state, &rest(MotorCommand::Off)).mode, Mode::Ready);
    state
}

fn sound(plan: &Plan, out: &Output) -> Result<(), TestCaseError> {
    let bridge = plan.config().bridge;
    for duty in out.duties.iter().flatten() {
        prop_assert!(*duty >= bridge.duty_min && *duty <= bridge.duty_max, "{out:?}");
    }
    for x in [out.torque_nm, out.id_a, out.iq_a, out.iq_wanted_a, out.limit_a, out.steer_rate_rad_s] {
        prop_assert!(x.is_finite(), "{out:?}");
    }
    let c = plan.config();
    prop_assert!(out.iq_wanted_a.abs() <= c.current.max_a && out.limit_a <= c.current.max_a);
    prop_assert_eq!(out.duties.is_some(), matches!(out.mode, Mode::Running | Mode::Aligning));
    prop_assert_eq!(out.mode == Mode::Off, !out.faults.is_empty());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Situation: any inputs to any valid configuration, from a start or ready. Must hold: duty cycles inside their
    /// limits or none; every output finite; a fault and an open bridge always together, and latched.
    #[test]
    fn any_inputs_give_safe_outputs(inputs in prop::collection::vec(any_inputs(), 1..120), fresh in any::<bool>(), kind in 0..3, seed in any::<u64>()) {
        let mut config = match kind {
            0 => EXAMPLE,
            1 => wide(),
            _ => drawn(seed),
        };
        config.encoder.offset_turns = Some(0.1);
        config.zero.samples = 1;
        let plan = config.plan().expect("valid");
        let mut state = if fresh { State::default() } else { started(&plan) };
        let mut faults = motor::Faults::NONE;
        for inputs in &inputs {
            let out = step(&plan, &mut state, inputs);
            sound(&plan, &out)?;
            prop_assert!(faults.is_empty() || out.faults == faults, "{faults:?} became {out:?}");
            faults = out.faults;
        }
    }

    /// Situation: two mirrored motors: phases b and c exchanged, counts reversed, the torque of the opposite sign.
    /// Must hold: q current, torque and speed mirrored, d current equal, duty cycles exchanged; to the bit.
    #[test]
    fn a_mirrored_torque_is_a_mirrored_current(
        calls in prop::collection::vec((prop::array::uniform2(-8.0_f32..8.0), -20.0_f32..20.0), 1..80),
        from in 1_u16..16_384,
        speed in -20_i32..20,
    ) {
        let mut config = wide();
        config.encoder.offset_turns = Some(0.0);
        let plan = config.plan().expect("valid");
        let (mut state, mut other) = (State::default(), State::default());
        for (call, ([a, b], nm)) in (0_i32..).zip(calls) {
            let c = -(a + b);
            let counts = (i32::from(from) + speed * call).rem_euclid(16_384) as u16;
            let zero = call < 20;
            let [a, b, c] = if zero { [0.0; 3] } else { [a, b, c] };
            let command = if zero { MotorCommand::Off } else { MotorCommand::Torque(nm) };
            let turned = if zero { MotorCommand::Off } else { MotorCommand::Torque(-nm) };
            let one = Inputs { phases: Phases::Three([a, b, c]), angle_counts: counts, ..rest(command) };
            let two = Inputs { phases: Phases::Three([a, c, b]), angle_counts: (16_384 - counts) % 16_384, ..rest(turned) };
            let (one, two) = (step(&plan, &mut state, &one), step(&plan, &mut other, &two));
            prop_assert_eq!(one.iq_a, -two.iq_a);
            prop_assert_eq!(one.iq_wanted_a, -two.iq_wanted_a);
            prop_assert_eq!(one.torque_nm, -two.torque_nm);
            prop_assert_eq!(one.steer_rate_rad_s, -two.steer_rate_rad_s);
            prop_assert_eq!((one.id_a, one.mode, one.faults), (two.id_a, two.mode, two.faults));
            prop_assert_eq!(one.duties, two.duties.map(|[a, b, c]| [a, c, b]));
        }
    }
}
