//! Flight cards: the yaw rate against speed and steer angle in gentle riding.

use control::{Cause, Config, Mode, Plan, Sample, SensorFrame, State, Triple, step};

/// What is wrong with the sensors.
#[derive(Clone, Copy, Default)]
struct Wrong {
    gyro: f32,
    steer: f32,
}

const RIGHT: Wrong = Wrong { gyro: 1.0, steer: 1.0 };

/// The product without the sensors that this bicycle lacks: gyro, accelerometer, steer angle and rear wheel.
fn plan() -> Plan {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    config.input.wheel = control::Wheel::Rear;
    for sensor in [&mut config.input.front_wheel, &mut config.input.motor, &mut config.input.steer_rate] {
        sensor.fitted = false;
    }
    config.response.motor = None;
    config.plan().expect("a sound configuration")
}

/// A gentle serpentine at `speed` m/s: the frame steers by `swing` rad once in 1.6 s and yaws as wheelbase and tilt of the
/// configuration say; the sensors are `wrong` from 3 s on. When `cause` was first told \[s\], within 12 s.
fn told(speed_m_s: f32, swing_rad: f32, wrong: Wrong, cause: Cause) -> Option<f32> {
    let (plan, mut state) = (plan(), State::default());
    let cross = plan.config().cross;
    let (mut mode, mut press) = (Mode::Off, false);
    for k in 0..12_000_u16 {
        let t = 1e-3 * f32::from(k);
        let Wrong { gyro, steer } = if t < 3.0 { RIGHT } else { wrong };
        let phase = core::f32::consts::TAU * t / 1.6;
        let angle = swing_rad * phase.sin();
        let yaw = speed_m_s * (angle * cross.tilt_rad.cos()).tan() / cross.wheelbase_m;
        // Noise of a sensor, so that no sample comes twice.
        let noise = [1e-3, -2e-3, 2e-3, -1e-3, 0.0][usize::from(k % 5)];
        let mut frame = SensorFrame::missing();
        frame.now_us = 1000 * u32::from(k);
        frame.gyro_rad_s = Triple::fresh([noise, -noise, gyro * yaw + noise]);
        frame.accel_m_s2 = Triple::fresh([noise, speed_m_s * yaw + noise, -9.81 - noise]);
        frame.steer_rad = Sample::fresh(steer * angle);
        frame.rear_wheel_m_s = Sample::fresh(speed_m_s);
        frame.engage = press;
        let command = step(&plan, &mut state, &frame);
        mode = command.mode;
        press = mode.drives() || plan.ready(&command);
        if command.causes.has(cause) && t > 1.0 {
            return Some(t);
        }
    }
    assert!(mode.drives(), "{mode:?}");
    None
}

/// Situation: a serpentine of 0.03 to 0.1 rad of steer at 2 to 6 m/s, all sensors right. Action: ride for 12 s. Must hold: engaged to the end, no
/// word of the yaw rate; also with a steer sensor whose scale is wrong by a third.
#[test]
fn gentle_riding_is_no_disagreement() {
    for speed in [2.0, 3.0, 4.0, 6.0] {
        for swing in [0.0, 0.03, 0.1] {
            for steer in [0.75, 1.0, 1.33] {
                let wrong = Wrong { gyro: 1.0, steer };
                assert_eq!(told(speed, swing, wrong, Cause::YawDisagrees), None, "{speed} {swing} {steer}");
            }
        }
    }
}

/// Situation: the same serpentines; at 3 s the yaw gyro, or the steer angle, has the other sign. Action: ride on. Must hold: told within 0.2 to
/// 1.6 s, one swing, though no difference comes near the 2 rad/s of the fast check.
#[test]
fn a_reversed_sign_shows_in_gentle_riding() {
    for speed in [2.0, 3.0, 4.0, 6.0] {
        for wrong in [Wrong { gyro: -1.0, steer: 1.0 }, Wrong { gyro: 1.0, steer: -1.0 }] {
            let at = told(speed, 0.06, wrong, Cause::YawDisagrees);
            let after_s = at.unwrap_or_else(|| panic!("{speed} {}: not told", wrong.gyro)) - 3.0;
            assert!((0.2..=1.6).contains(&after_s), "{speed} {}: {after_s} s", wrong.gyro);
        }
    }
}

/// Situation: a bicycle led by hand at 0.9 m/s, its front wheel turned to and fro, the yaw gyro reversed. Action: go on for 9 s. Must hold: no word by
/// slope or lasting difference: a bicycle led by hand need not go where its wheel points.
#[test]
fn below_riding_speed_the_slope_is_not_judged() {
    assert_eq!(told(0.9, 0.1, Wrong { gyro: -1.0, steer: 1.0 }, Cause::YawDisagrees), None);
}

/// Situation: riding straight on at 4 m/s; at 3 s gyro or accelerometer repeats its sample for ever. Action: ride on. Must hold: stuck within 48 to 75 ms, three
/// looks of 24 ms, whatever the rider does with the handlebar; standing, where no sensor changes at all, or where there is no other
/// sensor to change, never.
#[test]
fn an_imu_that_repeats_itself_is_stuck_soon() {
    let alone = || {
        let mut config = plan().config().clone();
        config.input.accel.fitted = false;
        config.plan().expect("a sound configuration")
    };
    let after_ms = |plan: Plan, cause: Cause, speed_m_s: f32, exact: bool| {
        let mut state = State::default();
        let mut at = None;
        for k in 0..4000_u16 {
            let noise = |k: u16| if exact { 0.0 } else { 1e-3 * f32::from(k % 7) };
            let held = |stuck: bool| noise(if stuck { k.min(3000) } else { k });
            let (gyro, accel) = (held(cause == Cause::GyroStuck), held(cause == Cause::AccelStuck));
            let mut frame = SensorFrame::missing();
            frame.now_us = 1000 * u32::from(k);
            frame.gyro_rad_s = Triple::fresh([gyro, -gyro, gyro]);
            frame.accel_m_s2 = Triple::fresh([accel, 0.0, -9.81]);
            frame.steer_rad = Sample::fresh(0.0);
            frame.rear_wheel_m_s = Sample::fresh(speed_m_s);
            if step(&plan, &mut state, &frame).causes.has(cause) && k > 1000 {
                at.get_or_insert(k);
            }
        }
        at.map(|at| at - 3000)
    };
    for cause in [Cause::GyroStuck, Cause::AccelStuck] {
        let after = after_ms(plan(), cause, 4.0, false).expect("told");
        assert!((48..=75).contains(&after), "{cause:?}: {after} ms");
        assert_eq!(after_ms(plan(), cause, 0.0, false), None, "{cause:?} standing");
        assert_eq!(after_ms(plan(), cause, 4.0, true), None, "{cause:?} where nothing changes");
    }
    assert_eq!(after_ms(alone(), Cause::GyroStuck, 4.0, false), None, "no other sensor changes");
}
