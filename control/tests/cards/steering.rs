//! Flight cards: yaw, roll and wheels against steering, on a bicycle that moves as its equations say.

use control::{Cause, Config, Plan, Sample, SensorFrame, State, Triple, Wheel, step};
use core::f32::consts::TAU;

/// The product with gyro, steer angle and rear wheel only.
fn plan() -> Plan {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    let input = &mut config.input;
    input.wheel = Wheel::Rear;
    for sensor in [&mut input.front_wheel, &mut input.motor, &mut input.steer_rate, &mut input.accel] {
        sensor.fitted = false;
    }
    config.response.motor = None;
    config.plan().expect("a sound configuration")
}

/// A bicycle that swings its steer by `swing_rad` once in 1.2 s, and what each sensor says of that.
#[derive(Clone, Copy)]
struct Ride {
    speed_m_s: f32,
    swing_rad: f32,
    /// Factors of the gyro's x and z axes and of the steer angle, from 3 s on.
    wrong: [f32; 3],
    /// What the wheel says at a time, from the true speed.
    wheel: fn(f32, f32) -> f32,
    /// Noise of the gyro \[rad/s\].
    noise_rad_s: f32,
}

const RIGHT: Ride =
    Ride { speed_m_s: 3.0, swing_rad: 0.04, wrong: [1.0; 3], wheel: |_, v| v, noise_rad_s: 1e-3 };

/// For how long the bicycle is ridden \[ms\].
const RIDE_MS: u16 = 9000;

/// Rides; what `cause` says: from when to when it was told \[s\].
fn told(ride: &Ride, cause: Cause) -> Option<(f32, f32)> {
    let (plan, mut state) = (plan(), State::default());
    let config = plan.config();
    let (cross, mass) = (config.cross, config.estimate.balance);
    let omega = TAU / 1.2;
    let (mut press, mut when) = (false, None);
    for k in 0..RIDE_MS {
        let t = 1e-3 * f32::from(k);
        let (sin, cos) = (omega * t).sin_cos();
        let yaw_most = ride.speed_m_s * ride.swing_rad * cross.tilt_rad.cos() / cross.wheelbase_m;
        // The steady swing of roll'' - g roll / h = -(v Y + b Y') / h.
        let stiff = mass.up_m * omega * omega + 9.81;
        let (in_step, ahead) = (ride.speed_m_s * yaw_most / stiff, mass.forward_m * omega * yaw_most / stiff);
        let roll_rate = omega * (in_step * cos - ahead * sin);
        let [x, z, steer] = if t < 3.0 { [1.0; 3] } else { ride.wrong };
        let noise = ride.noise_rad_s * [1.0, -2.0, 2.0, -1.0, 0.5, -0.5, 0.0][usize::from(k % 7)];
        let mut frame = SensorFrame::missing();
        frame.now_us = 1000 * u32::from(k);
        frame.gyro_rad_s = Triple::fresh([x * roll_rate + noise, -noise, z * yaw_most * sin + noise]);
        frame.steer_rad = Sample::fresh(steer * ride.swing_rad * sin);
        frame.rear_wheel_m_s = Sample::fresh((ride.wheel)(t, ride.speed_m_s));
        frame.engage = press;
        let command = step(&plan, &mut state, &frame);
        press = command.mode.drives() || plan.ready(&command);
        if command.causes.has(cause) && t > 1.0 {
            let (from, _) = when.unwrap_or((t, t));
            when = Some((from, t));
        }
    }
    when
}

/// Situation: swings of 0.02 to 0.08 rad at 1.5 to 6 m/s, all sensors right, the gyro's noise from none to 0.02 rad/s. Action: ride for 9 s.
/// Must hold: no word of gyro, yaw rate or wheel.
#[test]
fn who_rolls_as_the_steering_says_is_right() {
    for speed_m_s in [1.5, 3.0, 6.0] {
        for swing_rad in [0.02, 0.08] {
            for noise_rad_s in [0.0, 1e-3, 0.02] {
                let ride = Ride { speed_m_s, swing_rad, noise_rad_s, ..RIGHT };
                for cause in [Cause::GyroDisagrees, Cause::YawDisagrees, Cause::RearWheelStuck] {
                    assert_eq!(told(&ride, cause), None, "{speed_m_s} {swing_rad} {noise_rad_s} {cause:?}");
                }
            }
        }
    }
}

/// Situation: the same swings without an accelerometer; at 3 s one of roll axis, yaw axis and steer sensor has the other sign. Action: ride on.
/// Must hold: the roll axis is the gyro's fault alone, the yaw axis the yaw rate's alone, the steer sensor both, within about a swing, 0.2 to 1.4 s.
#[test]
fn each_reversed_sign_has_its_own_signature() {
    for speed_m_s in [2.0, 3.0, 5.0] {
        for (wrong, gyro, yaw) in
            [([-1.0, 1.0, 1.0], true, false), ([1.0, -1.0, 1.0], false, true), ([1.0, 1.0, -1.0], true, true)]
        {
            let ride = Ride { speed_m_s, wrong, swing_rad: 0.06, ..RIGHT };
            for (cause, expected) in [(Cause::GyroDisagrees, gyro), (Cause::YawDisagrees, yaw)] {
                let after_s = told(&ride, cause).map(|(from, _)| from - 3.0);
                let holds = after_s.map_or(!expected, |after| expected && (0.2..1.4).contains(&after));
                assert!(holds, "{speed_m_s} {wrong:?} {cause:?}: {after_s:?}");
            }
        }
    }
}

/// Situation: the wheel's sensor says 0 from 3 s on, at 1, 2, 3 and 5 m/s. Action: ride on. Must hold: from 2 m/s on the wheel is named,
/// 0.2 to 2 s later and still at the end; at 1 m/s, as one leads a bicycle, never. Parked is told in each.
#[test]
fn a_wheel_that_stands_while_the_bicycle_turns_is_named() {
    for (speed_m_s, named) in [(1.0, false), (2.0, true), (3.0, true), (5.0, true)] {
        let wheel = |t: f32, v: f32| if t < 3.0 { v } else { 0.0 };
        let ride = Ride { speed_m_s, swing_rad: 0.08, wheel, ..RIGHT };
        match told(&ride, Cause::RearWheelStuck) {
            Some((from, until)) => {
                assert!(named && (3.2..5.0).contains(&from) && until > 8.5, "{speed_m_s}: {from} {until}");
            }
            None => assert!(!named, "{speed_m_s}"),
        }
        assert!(told(&ride, Cause::Parked).is_some(), "{speed_m_s}");
    }
}

/// Situation: a wheel from 4.9 m/s to rest at 3 s: lifted, in 70 ms; braked as hard as tyres grip, in 0.6 s; back on the ground 5 s
/// later. Action: ride on. Must hold: the lifted one jumps, told within 30 to 100 ms and no longer than 0.4 s, and again when it is dropped; the
/// braked one never does.
#[test]
fn a_wheel_that_is_lifted_jumps_and_a_braked_one_does_not() {
    let lifted =
        |t: f32, v: f32| v * (1.0 - ((t - 3.0) / 0.07).clamp(0.0, 1.0) + ((t - 8.0) / 0.07).clamp(0.0, 1.0));
    let braked = |t: f32, v: f32| v * (1.0 - ((t - 3.0) / 0.6).clamp(0.0, 1.0));
    let ride = Ride { speed_m_s: 4.9, swing_rad: 0.0, wheel: lifted, ..RIGHT };
    let (from, until) = told(&ride, Cause::RearWheelJump).expect("told");
    assert!((3.03..3.1).contains(&from) && (8.03..8.4).contains(&until), "{from} {until}");
    assert_eq!(told(&Ride { wheel: braked, ..ride }, Cause::RearWheelJump), None);
}
