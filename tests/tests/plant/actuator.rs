//! The motor compared with closed forms, and the friction's energy.

use sim_host::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use sim_host::integrate::{Actuation, Stages, rk4};
use sim_host::num::Moves;
use sim_host::plant::catalogue::{load, shipped_names};
use sim_host::plant::{Actuator, ActuatorConfig, Friction, SteerStop, Supply};
use tests::rides::{knocked, shipped};

const PERIOD_S: f64 = 1e-3;

/// Torque at a steer rate of zero at the start, middle and end of every period of a command.
fn given(config: &ActuatorConfig, command: impl Fn(usize) -> f64, periods: usize) -> Vec<[f64; 3]> {
    config.check().expect("in range");
    let mut actuator = Actuator::new(config);
    (0..periods)
        .map(|period| {
            actuator.command(config, PERIOD_S, command(period));
            [0.0, 0.5, 1.0].map(|part| actuator.torque(config, part * PERIOD_S, 0.0))
        })
        .collect()
}

/// Situation: no actuator. Must hold: the command at every instant, to the bit.
#[test]
fn the_default_actuator_gives_the_requested_torque() {
    let command = |period: usize| [0.0, -0.0, 3.7, -1e9][period % 4];
    for (period, torques) in given(&ActuatorConfig::default(), command, 8).into_iter().enumerate() {
        assert_eq!(torques.map(f64::to_bits), [command(period).to_bits(); 3]);
    }
    assert!(ActuatorConfig::default().exact());
}

/// Situation: a time constant of 20 ms, then with a delay of 3 periods. Action: a step of 5 N m.
/// Must hold: `5 (1 - exp(-t / T))` at every start, middle and end of a period, to 1e-9; later by
/// exactly the delay.
#[test]
fn the_step_response_is_of_first_order() {
    for delay_ticks in [0, 3] {
        let config = ActuatorConfig { time_constant_s: 0.02, delay_ticks, ..ActuatorConfig::default() };
        for (period, torques) in given(&config, |_| 5.0, 200).into_iter().enumerate() {
            for (torque, part) in torques.into_iter().zip([0.0, 0.5, 1.0]) {
                let t = (period as f64 + part - f64::from(delay_ticks)) * PERIOD_S;
                let expected = if t > 0.0 { 5.0 * (1.0 - (-t / 0.02).exp()) } else { 0.0 };
                assert!((torque - expected).abs() < 1e-9, "{period} {part}: {torque} {expected}");
            }
        }
    }
}

/// Situation: a limit of 7 N m, a torque constant 10 % low, a motor wired the wrong way.
/// Must hold: each as named, limits both ways.
#[test]
fn limit_scale_and_sign() {
    let at = |config: ActuatorConfig, command| given(&config, |_| command, 1)[0][2];
    let none = ActuatorConfig::default();
    let limited = ActuatorConfig { limit_nm: Some(7.0), ..none };
    assert_eq!([6.9, 9.0, -9.0].map(|x| at(limited, x)), [6.9, 7.0, -7.0]);
    assert_eq!(at(ActuatorConfig { scale: 0.9, ..none }, 5.0), 4.5);
    assert_eq!(at(ActuatorConfig { scale: -1.0, ..limited }, 9.0), -7.0);
}

/// Situation: 24 V, 0.6 ohm, 0.75 N m/A at the steer axis.
/// Action: request a large torque at steer rates in both directions.
/// Must hold: `k (V - k q) / R` where that is less, so 30 N m at standstill, less with the motion, none at `V / k`; a
/// small torque passes.
#[test]
fn the_voltage_limits_the_torque_at_speed() {
    let supply = Supply { voltage_v: 24.0, resistance_ohm: 0.6, constant_nm_a: 0.75 };
    let config = ActuatorConfig { supply: Some(supply), ..ActuatorConfig::default() };
    let at = |command, rate| {
        let mut actuator = Actuator::new(&config);
        actuator.command(&config, PERIOD_S, command);
        actuator.torque(&config, 0.0, rate)
    };
    for rate in [-40.0, -5.0, 0.0, 5.0, 20.0, 32.0] {
        let most = 0.75 * (24.0 - 0.75 * rate) / 0.6;
        assert!((at(1000.0, rate) - most).abs() < 1e-12);
        assert!((at(-1000.0, -rate) + most).abs() < 1e-12);
    }
    assert_eq!((at(1000.0, 0.0), at(2.0, 5.0)), (30.0, 2.0));
    assert!(at(1000.0, 32.0).abs() < 1e-12);
    assert!(at(1000.0, f64::NAN) == 1000.0);
}

/// Situation: the shipped actuators, and files with an error each.
/// Must hold: the shipped ones load with the published values; a file's error is named.
#[test]
fn actuators_load_by_name_or_file() {
    for name in shipped_names() {
        load(&name).unwrap_or_else(|e| panic!("{e}"));
    }
    let friction = load("davis").unwrap().friction;
    assert_eq!((friction.viscous_nm_s_rad, friction.coulomb_nm), (0.34, 0.15));
    assert_eq!(load("gazelle").unwrap(), ActuatorConfig { limit_nm: Some(7.0), ..ActuatorConfig::default() });
    assert_eq!(load("none").unwrap(), ActuatorConfig::default());
    assert!(load("other").unwrap_err().to_string().contains("none, davis, gazelle"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("motor.toml");
    let loaded = |text: &str| {
        std::fs::write(&path, text).unwrap();
        load(path.to_str().unwrap())
    };
    let supply = "supply = { voltage_v = 24, resistance_ohm = 0.6, constant_nm_a = 0.75 }";
    assert_eq!(loaded(supply).unwrap().supply.map(|s| s.voltage_v), Some(24.0));
    for (text, says) in [
        ("limits_nm = 7", "limits_nm"),
        ("limit_nm = -1", "actuator limit (N m) = -1 is outside 0 to 1000"),
        ("scale = 'x'", "scale"),
        ("friction = { coulomb = 1 }", "coulomb"),
        ("supply = { voltage_v = 24 }", "resistance_ohm"),
        ("source = 3", "source must be text"),
        ("[", "motor.toml"),
    ] {
        let message = loaded(text).expect_err(text).to_string();
        assert!(message.contains(says) && message.contains("motor.toml"), "{message}");
    }
}

/// Work done by friction, integrated with the bicycle.
#[derive(Clone, Copy)]
struct Work(f64);

impl Moves for Work {
    fn moved(&self, h: f64, rate: &Self) -> Self {
        Self(self.0 + h * rate.0)
    }
}

struct Rubbing {
    friction: Friction,
    work: Stages<Work>,
}

impl Actuation<f64> for Rubbing {
    fn torques(&self, _: usize, motion: &Motion<f64>) -> Torques<f64> {
        Torques { roll: 0.0, steer: self.friction.torque(motion.actual.steer) }
    }

    fn end_stage(
        &mut self,
        _: &Geometry,
        stage: usize,
        _: &State<f64>,
        motion: &Motion<f64>,
        _: &Accelerations<f64>,
    ) {
        let rate = motion.actual.steer;
        self.work.next(stage, PERIOD_S, &Work(self.friction.torque(rate) * rate));
    }
}

/// Situation: the benchmark bicycle after a knock at 5 m/s with the Davis friction, then with ten times the Coulomb
/// part.
/// Action: 5 s of riding.
/// Must hold: the energy changes by the friction's work, which is never positive and not negligible.
#[test]
fn friction_takes_exactly_its_work() {
    let b = Geometry::new(&shipped("benchmark").parameters);
    let davis = load("davis").unwrap().friction;
    for friction in [davis, Friction { coulomb_nm: 1.0, ..davis }] {
        friction.check().expect("in range");
        let mut state = knocked(&b, 5.0, 2.0);
        let energy = |state: &State<f64>| Motion::new(&b, state).energy(&b, state);
        let (before, mut work) = (energy(&state), Work(0.0));
        for _ in 0..5000 {
            let mut rubbing = Rubbing { friction, work: Stages::new(Work(0.0)) };
            state = rk4(&b, &state, PERIOD_S, &mut rubbing);
            assert!(rubbing.work.end.0 <= 0.0);
            work.0 += rubbing.work.end.0;
        }
        let change = energy(&state) - before;
        println!("{friction:?}: work {} J, energy {change} J", work.0);
        assert!((change - work.0).abs() < 1e-5 * work.0.abs() && work.0 < -0.1 && work.0 > -20.0);
    }
}

/// Situation: Coulomb friction only. Must hold: odd; 71 % at the creep rate; all of it, within 0.1 %, at
/// 25 times that; none at rest.
#[test]
fn coulomb_friction_is_smooth_through_zero() {
    let friction = Friction { coulomb_nm: 0.2, ..Friction::default() };
    assert_eq!(friction.torque(0.0), 0.0);
    assert!((friction.torque(0.01) + 0.2 * 0.5_f64.sqrt()).abs() < 1e-15);
    assert!((0.1998..0.2).contains(&-friction.torque(0.25)));
    assert_eq!(friction.torque(-0.3), -friction.torque(0.3));
    assert!(!Friction::default().acts() && friction.acts());
    let stiff = Friction { coulomb_nm: 2.0, ..friction };
    assert!(stiff.check().expect_err("stiff").to_string().contains("over creep"));
}

/// Situation: a steer of 0.2 kg m^2 that runs into a stop at 0.5 rad with 5 rad/s, to the right and to the left.
/// Action: 0.2 s in steps of 1 ms.
/// Must hold: it goes 1.6 degrees beyond and leaves with 0.30 of its rate, as the closed form of the damped spring
/// without tension gives, both within a twentieth; before and after the contact there is no torque; left mirrors
/// right.
#[test]
fn the_stop_throws_the_steer_back_with_loss() {
    let stop = SteerStop::at(0.5);
    stop.check().expect("in range");
    let inertia = 0.2;
    // Damping ratio 0.5 and 100 rad/s: force ends where the acceleration does, after two thirds of half a turn.
    let (wn, z) = ((stop.stiffness_nm_rad / inertia).sqrt(), 0.5_f64);
    let wd = wn * (1.0 - z * z).sqrt();
    let deepest = 5.0 / wn * (-z / (1.0 - z * z).sqrt() * z.acos()).exp();
    let left_with = (-z * wn * 2.0 * z.acos() / wd).exp();
    for side in [1.0, -1.0] {
        let (mut angle, mut rate, mut most) = (0.499 * side, 5.0 * side, 0.0_f64);
        for _ in 0..200 {
            let acc = |a: f64, r: f64| stop.torque(a, r) / inertia;
            let (h, k1) = (PERIOD_S, acc(angle, rate));
            let k2 = acc(angle + 0.5 * h * rate, rate + 0.5 * h * k1);
            let k3 = acc(angle + 0.5 * h * (rate + 0.5 * h * k1), rate + 0.5 * h * k2);
            let k4 = acc(angle + h * (rate + 0.5 * h * k2), rate + h * k3);
            angle += h * (rate + h / 6.0 * (k1 + k2 + k3));
            rate += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            most = most.max(angle * side);
        }
        let (deep, left_part) = (most - 0.5, -rate * side / 5.0);
        println!("{deep} rad, {left_part}; closed form {deepest}, {left_with}");
        assert!((deep / deepest - 1.0).abs() < 0.05 && (left_part / left_with - 1.0).abs() < 0.05);
        assert!((deepest.to_degrees() - 1.6).abs() < 0.05 && (left_with - 0.3).abs() < 0.005);
    }
    assert_eq!((stop.torque(0.499, 9.0), stop.torque(-0.499, -9.0)), (0.0, 0.0));
    // Leaving fast, the spring cannot follow: the stop does not hold the steer back.
    assert_eq!(stop.torque(0.51, -9.0), 0.0);
    assert_eq!(stop.torque(0.51, 1.0), -stop.torque(-0.51, -1.0));
    for angle_rad in [0.0, 2.0, f64::NAN] {
        assert!(SteerStop::at(angle_rad).check().expect_err("range").to_string().contains("0.05 to 1.5"));
    }
}
