//! Flight cards: the polarity check, and what it lets through.

use control::safety::press::PressConfig;
use control::sensors::polarity::PolarityStep;
use control::{
    Cause, Causes, Command, Config, GainSchedule, Law, Mode, Plan, Sample, SensorFrame, State, Triple, step,
};

/// What somebody does with the bicycle in one control period.
#[derive(Clone, Copy, Default)]
struct Hands {
    roll_rad: f32,
    roll_rate_rad_s: f32,
    steer_rad: f32,
    steer_rate_rad_s: f32,
    speed_m_s: f32,
}

/// Three moves of 2 s each, there and back, and a rest of 1 s before each: lean, steer, push.
fn moves(size: f32) -> Vec<Hands> {
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

/// What is wrong with a frame.
type Wrong = fn(&mut SensorFrame);

/// The sensors' frames, with a little noise so that none counts as stuck; each then changed by `wrong`.
fn frames(hands: &[Hands], engage: bool, wrong: Wrong) -> Vec<SensorFrame> {
    hands
        .iter()
        .enumerate()
        .map(|(i, h)| {
            let hum = 1e-4 * (i % 7) as f32;
            let (sin, cos) = h.roll_rad.sin_cos();
            let mut frame = SensorFrame {
                now_us: 1000 * i as u32,
                gyro_rad_s: Triple::fresh([h.roll_rate_rad_s + hum, hum, hum]),
                accel_m_s2: Triple::fresh([hum, -9.81 * sin, -9.81 * cos]),
                steer_rad: Sample::fresh(h.steer_rad + hum),
                steer_rate_rad_s: Sample::fresh(h.steer_rate_rad_s + hum),
                front_wheel_m_s: Sample::fresh(h.speed_m_s),
                rear_wheel_m_s: Sample::fresh(h.speed_m_s),
                motor_torque_nm: Sample::fresh(hum),
                engage,
                ..SensorFrame::missing()
            };
            wrong(&mut frame);
            frame
        })
        .collect()
}

/// The moves asked for one after the other, the causes told on the way, the torque shown while leaning to the right.
fn checked(plan: &Plan, frames: &[SensorFrame]) -> (Vec<PolarityStep>, Vec<Cause>, f32) {
    let mut state = State::default();
    let (mut asked, mut causes, mut shown) = (vec![state.polarity()], control::Causes::NONE, 0.0_f32);
    for (i, frame) in frames.iter().enumerate() {
        let command = step(plan, &mut state, frame);
        assert_eq!(command.torque_nm, 0.0, "the motor is off");
        assert!(!command.mode.drives());
        causes = causes.with(command.causes);
        if state.polarity() != *asked.last().unwrap() {
            asked.push(state.polarity());
        }
        if (1000..2000).contains(&i) && state.hand_torque_nm().abs() > shown.abs() {
            shown = state.hand_torque_nm();
        }
    }
    (asked, causes.iter().collect(), shown)
}

fn flashed() -> Plan {
    Config::product().plan().expect("in range")
}

/// Situation: the flashed controller on a bicycle put together as drawn. Action: lean, steer, push.
/// Must hold: each move is asked for in its turn and passed; while it leans to the right the torque shown is to the right
/// and what the law asks for; no torque flows.
#[test]
fn a_sound_bicycle_passes() {
    let (asked, causes, shown) = checked(&flashed(), &frames(&moves(0.5), false, |_| ()));
    assert_eq!(asked, [PolarityStep::Lean, PolarityStep::Steer, PolarityStep::Push, PolarityStep::Passed]);
    assert!(
        causes.contains(&Cause::PolarityUnchecked) && !causes.contains(&Cause::PolarityWrong),
        "{causes:?}"
    );
    // h(4 m/s) times the largest rate of the lean.
    let expected = 8.66 * 0.25 * core::f32::consts::PI;
    assert!((0.95..1.05).contains(&(shown / expected)), "{shown} against {expected}");
}

/// Situation: the moves, large enough to pass and too small; then somebody rides. Action: press the switch.
/// Must hold: without the check refused with the cause; with it the press engages.
#[test]
fn only_who_passed_engages() {
    let plan = flashed();
    for (size, drives) in [(0.5, true), (0.05, false)] {
        let mut state = State::default();
        let passing = frames(&moves(size), false, |_| ());
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

/// Situation: from boot through the moves to a ride, the switch off, each press counting in its first period. Action:
/// press it in any period. Must hold: it engages where the controller said that it was ready, and nowhere else but where a cause comes or goes
/// in that very period; not before the push, and throughout the ride once it counts as one.
#[test]
fn ready_says_when_a_press_engages() {
    let mut config = Config::product();
    config.permit.press = PressConfig::default();
    let plan = config.plan().expect("in range");
    let on = [Hands { speed_m_s: 2.0, ..Hands::default() }; 1000];
    let ride: Vec<SensorFrame> =
        frames(&moves(0.5), false, |_| ()).into_iter().chain(frames(&on, false, |_| ())).collect();
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
    // The push, which ends the check, takes the last 2000 periods of the moves.
    assert!(!moving[..moving.len() - 2000].contains(&true));
    assert!(riding[500..].iter().all(|ready| *ready));
}

/// Situation: somebody rides, leaning and steering as in the check. Action: ride on. Must hold: nothing is passed, nothing
/// accused.
#[test]
fn a_ride_is_no_check() {
    let mut riding = moves(0.5);
    riding.iter_mut().for_each(|h| h.speed_m_s = 4.0);
    let (asked, causes, _) = checked(&flashed(), &frames(&riding, false, |_| ()));
    assert_eq!(asked, [PolarityStep::Lean]);
    assert!(!causes.contains(&Cause::PolarityWrong), "{causes:?}");
}

/// Situation: one sign is wrong. Action: the moves. Must hold: found at the move that shows it, told, and not forgotten.
#[test]
fn every_wrong_sign_is_found() {
    let wrong: [(&str, PolarityStep, Wrong); 6] = [
        ("gyro", PolarityStep::Lean, |f| f.gyro_rad_s.value[0] = -f.gyro_rad_s.value[0]),
        ("accelerometer", PolarityStep::Lean, |f| f.accel_m_s2.value[1] = -f.accel_m_s2.value[1]),
        ("steer angle", PolarityStep::Steer, |f| f.steer_rad.value = -f.steer_rad.value),
        ("steer rate", PolarityStep::Steer, |f| f.steer_rate_rad_s.value = -f.steer_rate_rad_s.value),
        ("front wheel", PolarityStep::Push, |f| f.front_wheel_m_s.value = -f.front_wheel_m_s.value),
        ("rear wheel", PolarityStep::Push, |f| f.rear_wheel_m_s.value = -f.rear_wheel_m_s.value),
    ];
    for (name, at, wrong) in wrong {
        let (asked, causes, _) = checked(&flashed(), &frames(&moves(0.5), false, wrong));
        let found = asked.split_last().map(|(last, before)| (*last, before.last().copied()));
        assert_eq!(found, Some((PolarityStep::Wrong, Some(at))), "{name}: {asked:?}");
        assert!(causes.contains(&Cause::PolarityWrong), "{name}");
    }
    // A calibration that says so makes it right.
    let mut config = Config::product();
    config.calibration.steer_reversed = true;
    let reversed: Wrong = |f| f.steer_rad.value = -f.steer_rad.value;
    let (asked, ..) = checked(&config.plan().expect("in range"), &frames(&moves(0.5), false, reversed));
    assert_eq!(asked.last(), Some(&PolarityStep::Passed));
}

/// Situation: a table of gains typed with the wrong sign. Action: lean. Must hold: found: it would steer out of the lean.
#[test]
fn a_law_of_the_wrong_sign_is_found() {
    let table = GainSchedule::new(&[(0.0, -8.0), (10.0, -8.0)]).expect("a table");
    let config = Config { law: Law::Table(table), ..Config::product() };
    let (asked, _, shown) = checked(&config.plan().expect("in range"), &frames(&moves(0.5), false, |_| ()));
    assert_eq!(asked, [PolarityStep::Lean, PolarityStep::Wrong]);
    assert!(shown < -1.0, "{shown}");
}

/// Situation: moves too small to tell, a gyro with a bias, a sensor that is lost. Action: the moves.
/// Must hold: nothing is passed and nothing accused.
#[test]
fn what_does_not_show_decides_nothing() {
    let cases: [(&str, f32, Wrong, PolarityStep); 3] = [
        ("small", 0.1, |_| (), PolarityStep::Lean),
        ("bias", 0.0, |f| f.gyro_rad_s.value[0] += 0.06, PolarityStep::Lean),
        ("steer lost", 0.5, |f| f.steer_rad = Sample::missing(), PolarityStep::Steer),
    ];
    for (name, size, wrong, stays) in cases {
        let (asked, causes, _) = checked(&flashed(), &frames(&moves(size), false, wrong));
        assert_eq!(asked.last(), Some(&stays), "{name}: {asked:?}");
        assert!(!causes.contains(&Cause::PolarityWrong), "{name}");
    }
}
