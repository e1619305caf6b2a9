//! The polarity check, and the engagement that it allows.

use control::safety::press::PressConfig;
use control::sensors::polarity::PolarityStep;
use control::{
    Cause, Causes, Command, Config, GainSchedule, Law, Mode, Plan, Sample, SensorFrame, State, Triple, step,
};

/// Motion of the bicycle by hand in one control period.
#[derive(Clone, Copy, Default)]
struct Hands {
    roll_rad: f32,
    roll_rate_rad_s: f32,
    steer_rad: f32,
    steer_rate_rad_s: f32,
    speed_m_s: f32,
}

/// Three movements of 2 s each, there and back, with a rest of 1 s before each: lean, steer, push.
fn movements(size: f32) -> Vec<Hands> {
    let swing = |i: usize| {
        let t = i as f32 * 1e-3;
        let phase = core::f32::consts::PI * t;
        (size * 0.5 * (1.0 - phase.cos()), size * 0.5 * core::f32::consts::PI * phase.sin())
    };
    let rest = || (0..1000).map(|_| Hands::default());
    let lean =
        (0..2000).map(|i| Hands { roll_rad: swing(i).0, roll_rate_rad_s: swing(i).1, ..Hands::default() });
    let steer =
        (0..2000).map(|i| Hands { steer_rad: swing(i).0, steer_rate_rad_s: swing(i).1, ..Hands::default() });
    let push = (0..2000).map(|i| Hands { speed_m_s: 1.5 * swing(i).0, ..Hands::default() });
    rest().chain(lean).chain(rest()).chain(steer).chain(rest()).chain(push).collect()
}

/// A fault applied to a frame.
type Fault = fn(&mut SensorFrame);

/// The sensors' frames, with a little noise so that no sensor counts as stuck; each modified by `fault`.
fn frames(hands: &[Hands], engage: bool, fault: Fault) -> Vec<SensorFrame> {
    hands
        .iter()
        .enumerate()
        .map(|(i, h)| {
            let noise = 1e-4 * (i % 7) as f32;
            let (sin, cos) = h.roll_rad.sin_cos();
            let mut frame = SensorFrame {
                now_us: 1000 * i as u32,
                gyro_rad_s: Triple::fresh([h.roll_rate_rad_s + noise, noise, noise]),
                accel_m_s2: Triple::fresh([noise, -9.81 * sin, -9.81 * cos]),
                steer_rad: Sample::fresh(h.steer_rad + noise),
                steer_rate_rad_s: Sample::fresh(h.steer_rate_rad_s + noise),
                front_wheel_m_s: Sample::fresh(h.speed_m_s),
                rear_wheel_m_s: Sample::fresh(h.speed_m_s),
                motor_torque_nm: Sample::fresh(noise),
                engage,
                ..SensorFrame::missing()
            };
            fault(&mut frame);
            frame
        })
        .collect()
}

/// The requested movements in order, the reported causes, and the largest torque shown in the first second of the lean.
fn run_check(plan: &Plan, frames: &[SensorFrame]) -> (Vec<PolarityStep>, Vec<Cause>, f32) {
    let mut state = State::default();
    let (mut requested, mut causes, mut shown) = (vec![state.polarity()], control::Causes::NONE, 0.0_f32);
    for (i, frame) in frames.iter().enumerate() {
        let command = step(plan, &mut state, frame);
        assert_eq!(command.torque_nm, 0.0, "the motor is off");
        assert!(!command.mode.drives());
        causes = causes.with(command.causes);
        if state.polarity() != *requested.last().unwrap() {
            requested.push(state.polarity());
        }
        if (1000..2000).contains(&i) && state.polarity_torque_nm().abs() > shown.abs() {
            shown = state.polarity_torque_nm();
        }
    }
    (requested, causes.iter().collect(), shown)
}

fn flashed() -> Plan {
    Config::product().plan().expect("in range")
}

/// Situation: the flashed controller on a correctly wired bicycle.
/// Action: lean, steer, push.
/// Must hold: each movement is requested in order and passed; during the lean to the right the torque shown is to the
/// right and equals the law's; the motor's torque is zero.
#[test]
fn a_correctly_wired_bicycle_passes() {
    let (requested, causes, shown) = run_check(&flashed(), &frames(&movements(0.5), false, |_| ()));
    assert_eq!(
        requested,
        [PolarityStep::Lean, PolarityStep::Steer, PolarityStep::Push, PolarityStep::Passed]
    );
    assert!(
        causes.contains(&Cause::PolarityUnchecked) && !causes.contains(&Cause::PolarityWrong),
        "{causes:?}"
    );
    // h(4 m/s) times the largest rate of the lean.
    let expected = 8.66 * 0.25 * core::f32::consts::PI;
    assert!((0.95..1.05).contains(&(shown / expected)), "{shown} against {expected}");
}

/// Situation: movements large enough to pass, and too small ones; then riding.
/// Action: press the switch.
/// Must hold: without a passed check rejected with the cause; with it the press engages.
#[test]
fn only_a_passed_check_engages() {
    let plan = flashed();
    for (size, drives) in [(0.5, true), (0.05, false)] {
        let mut state = State::default();
        let passing = frames(&movements(size), false, |_| ());
        let on = [Hands { speed_m_s: 2.0, ..Hands::default() }; 1500];
        let (riding, pressed) = (frames(&on, false, |_| ()), frames(&on, true, |_| ()));
        let mut last = None;
        for (i, frame) in passing.iter().chain(&riding).chain(&pressed).enumerate() {
            let frame = SensorFrame { now_us: 1000 * i as u32, ..*frame };
            last = Some(step(&plan, &mut state, &frame));
        }
        let last = last.expect("stepped");
        assert_eq!(last.mode.drives(), drives, "{:?}", last.mode);
        assert_eq!(last.causes.has(Cause::PolarityUnchecked), !drives);
        assert!(drives || last.mode == Mode::Standby);
    }
}

/// Situation: from boot through the movements to a ride, the switch off; each press counts in its first period.
/// Action: press in any period.
/// Must hold: it engages exactly where the controller reported ready in the period before, unless a cause appears or
/// disappears in that period; not before the push, and always during the ride after its start.
#[test]
fn ready_predicts_engagement() {
    let mut config = Config::product();
    config.permit.press = PressConfig::default();
    let plan = config.plan().expect("in range");
    let on = [Hands { speed_m_s: 2.0, ..Hands::default() }; 1000];
    let ride: Vec<SensorFrame> =
        frames(&movements(0.5), false, |_| ()).into_iter().chain(frames(&on, false, |_| ())).collect();
    let switch = Causes::all(&[Cause::SwitchOff, Cause::SwitchHeld]);
    let others = |causes: Causes| Causes(causes.0 & !switch.0);
    let (mut state, mut ready) = (State::default(), Vec::new());
    let mut before: Option<Command> = None;
    for (i, frame) in ride.iter().enumerate() {
        let frame = SensorFrame { now_us: 1000 * i as u32, ..*frame };
        let pressed = step(&plan, &mut state.clone(), &SensorFrame { engage: true, ..frame });
        if let Some(before) = before.filter(|b| others(b.causes) == others(pressed.causes)) {
            assert_eq!(pressed.mode.drives(), plan.ready(&before), "{i}: {before:?}");
        }
        let command = step(&plan, &mut state, &frame);
        ready.push(plan.ready(&command));
        before = Some(command);
    }
    let (moving, riding) = ready.split_at(ride.len() - 1000);
    // The push, which ends the check, takes the last 2000 periods of the movements.
    assert!(!moving[..moving.len() - 2000].contains(&true));
    assert!(riding[500..].iter().all(|ready| *ready));
}

/// Situation: a ride with the lean and steer movements of the check.
/// Action: ride on.
/// Must hold: no step is passed and no sign is reported as wrong.
#[test]
fn a_ride_is_not_a_check() {
    let mut riding = movements(0.5);
    riding.iter_mut().for_each(|h| h.speed_m_s = 4.0);
    let (requested, causes, _) = run_check(&flashed(), &frames(&riding, false, |_| ()));
    assert_eq!(requested, [PolarityStep::Lean]);
    assert!(!causes.contains(&Cause::PolarityWrong), "{causes:?}");
}

/// Situation: one sign is wrong.
/// Action: the movements.
/// Must hold: found at the movement that shows it, reported, and no further step follows. With a calibration that
/// corrects the sign the check is passed.
#[test]
fn every_wrong_sign_is_found() {
    let fault: [(&str, PolarityStep, Fault); 6] = [
        ("gyro", PolarityStep::Lean, |f| f.gyro_rad_s.value[0] = -f.gyro_rad_s.value[0]),
        ("accelerometer", PolarityStep::Lean, |f| f.accel_m_s2.value[1] = -f.accel_m_s2.value[1]),
        ("steer angle", PolarityStep::Steer, |f| f.steer_rad.value = -f.steer_rad.value),
        ("steer rate", PolarityStep::Steer, |f| f.steer_rate_rad_s.value = -f.steer_rate_rad_s.value),
        ("front wheel", PolarityStep::Push, |f| f.front_wheel_m_s.value = -f.front_wheel_m_s.value),
        ("rear wheel", PolarityStep::Push, |f| f.rear_wheel_m_s.value = -f.rear_wheel_m_s.value),
    ];
    for (name, at, fault) in fault {
        let (requested, causes, _) = run_check(&flashed(), &frames(&movements(0.5), false, fault));
        let found = requested.split_last().map(|(last, before)| (*last, before.last().copied()));
        assert_eq!(found, Some((PolarityStep::Wrong, Some(at))), "{name}: {requested:?}");
        assert!(causes.contains(&Cause::PolarityWrong), "{name}");
    }
    // A calibration that corrects the sign passes the check.
    let mut config = Config::product();
    config.calibration.steer_reversed = true;
    let reversed: Fault = |f| f.steer_rad.value = -f.steer_rad.value;
    let (requested, ..) =
        run_check(&config.plan().expect("in range"), &frames(&movements(0.5), false, reversed));
    assert_eq!(requested.last(), Some(&PolarityStep::Passed));
}

/// Situation: a gain table with the wrong sign.
/// Action: lean.
/// Must hold: found, because it would steer out of the lean.
#[test]
fn a_law_of_the_wrong_sign_is_found() {
    let table = GainSchedule::new(&[(0.0, -8.0), (10.0, -8.0)]).expect("a table");
    let config = Config { law: Law::Table(table), ..Config::product() };
    let (requested, _, shown) =
        run_check(&config.plan().expect("in range"), &frames(&movements(0.5), false, |_| ()));
    assert_eq!(requested, [PolarityStep::Lean, PolarityStep::Wrong]);
    assert!(shown < -1.0, "{shown}");
}

/// Situation: movements below the thresholds, a gyro with a bias, a lost sensor.
/// Action: the movements.
/// Must hold: neither passed nor reported as wrong.
#[test]
fn inconclusive_movements_decide_nothing() {
    let cases: [(&str, f32, Fault, PolarityStep); 3] = [
        ("small", 0.1, |_| (), PolarityStep::Lean),
        ("bias", 0.0, |f| f.gyro_rad_s.value[0] += 0.06, PolarityStep::Lean),
        ("steer lost", 0.5, |f| f.steer_rad = Sample::missing(), PolarityStep::Steer),
    ];
    for (name, size, fault, stays) in cases {
        let (requested, causes, _) = run_check(&flashed(), &frames(&movements(size), false, fault));
        assert_eq!(requested.last(), Some(&stays), "{name}: {requested:?}");
        assert!(!causes.contains(&Cause::PolarityWrong), "{name}");
    }
}
