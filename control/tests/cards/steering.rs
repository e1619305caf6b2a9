//! Yaw, roll and wheel checks against steering, on a simulated bicycle that follows the equations of motion.

use control::{Cause, Config, Plan, Sample, SensorFrame, State, Triple, Wheel, step};
use core::f32::consts::TAU;

/// The flashed configuration with gyro, steer angle and rear wheel only.
fn plan() -> Plan {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    let input = &mut config.input;
    input.wheel = Wheel::Rear;
    for sensor in [&mut input.front_wheel, &mut input.motor, &mut input.steer_rate, &mut input.accel] {
        sensor.fitted = false;
    }
    config.response.motor = None;
    config.plan().expect("a valid configuration")
}

/// A bicycle whose steer angle swings by `swing_rad` with a period of 1.2 s, and its sensors.
#[derive(Clone, Copy)]
struct Ride {
    speed_m_s: f32,
    swing_rad: f32,
    /// Factors of the gyro's x and z axes and of the steer angle, from 3 s on.
    factors: [f32; 3],
    /// Reported wheel speed at a time, from the true speed.
    wheel: fn(f32, f32) -> f32,
    /// Noise of the gyro \[rad/s\].
    noise_rad_s: f32,
}

const CORRECT: Ride =
    Ride { speed_m_s: 3.0, swing_rad: 0.04, factors: [1.0; 3], wheel: |_, v| v, noise_rad_s: 1e-3 };

/// Duration of a ride \[ms\].
const RIDE_MS: u16 = 9000;

/// Rides; returns the first and the last time at which `cause` is reported \[s\].
fn reported(ride: &Ride, cause: Cause) -> Option<(f32, f32)> {
    let (plan, mut state) = (plan(), State::default());
    let config = plan.config();
    let (cross, mass) = (config.cross, config.estimate.balance);
    let omega = TAU / 1.2;
    let (mut press, mut when) = (false, None);
    for k in 0..RIDE_MS {
        let t = 1e-3 * f32::from(k);
        let (sin, cos) = (omega * t).sin_cos();
        let yaw_amplitude = ride.speed_m_s * ride.swing_rad * cross.tilt_rad.cos() / cross.wheelbase_m;
        // The steady swing of roll'' - g roll / h = -(v Y + b Y') / h.
        let stiff = mass.up_m * omega * omega + 9.81;
        let (in_step, ahead) =
            (ride.speed_m_s * yaw_amplitude / stiff, mass.forward_m * omega * yaw_amplitude / stiff);
        let roll_rate = omega * (in_step * cos - ahead * sin);
        let [x, z, steer] = if t < 3.0 { [1.0; 3] } else { ride.factors };
        let noise = ride.noise_rad_s * [1.0, -2.0, 2.0, -1.0, 0.5, -0.5, 0.0][usize::from(k % 7)];
        let mut frame = SensorFrame::missing();
        frame.now_us = 1000 * u32::from(k);
        frame.gyro_rad_s = Triple::fresh([x * roll_rate + noise, -noise, z * yaw_amplitude * sin + noise]);
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

/// Situation: swings of 0.02 to 0.08 rad at 1.5 to 6 m/s, all sensors correct, gyro noise from 0 to 0.02 rad/s.
/// Action: ride for 9 s.
/// Must hold: no cause of gyro, yaw rate or wheel.
#[test]
fn correct_sensors_cause_no_disagreement() {
    for speed_m_s in [1.5, 3.0, 6.0] {
        for swing_rad in [0.02, 0.08] {
            for noise_rad_s in [0.0, 1e-3, 0.02] {
                let ride = Ride { speed_m_s, swing_rad, noise_rad_s, ..CORRECT };
                for cause in [Cause::GyroDisagrees, Cause::YawDisagrees, Cause::RearWheelStuck] {
                    assert_eq!(
                        reported(&ride, cause),
                        None,
                        "{speed_m_s} {swing_rad} {noise_rad_s} {cause:?}"
                    );
                }
            }
        }
    }
}

/// Situation: the same swings without an accelerometer; at 3 s the sign of roll axis, yaw axis or steer sensor
/// reverses.
/// Action: ride on.
/// Must hold: the roll axis is reported by the gyro's cause only, the yaw axis by the yaw rate's only, the steer sensor
/// by both, within 0.2 to 1.4 s, about one swing.
#[test]
fn each_reversed_sign_has_its_own_signature() {
    for speed_m_s in [2.0, 3.0, 5.0] {
        for (factors, gyro, yaw) in
            [([-1.0, 1.0, 1.0], true, false), ([1.0, -1.0, 1.0], false, true), ([1.0, 1.0, -1.0], true, true)]
        {
            let ride = Ride { speed_m_s, factors, swing_rad: 0.06, ..CORRECT };
            for (cause, expected) in [(Cause::GyroDisagrees, gyro), (Cause::YawDisagrees, yaw)] {
                let after_s = reported(&ride, cause).map(|(from, _)| from - 3.0);
                let as_expected = after_s.map_or(!expected, |after| expected && (0.2..1.4).contains(&after));
                assert!(as_expected, "{speed_m_s} {factors:?} {cause:?}: {after_s:?}");
            }
        }
    }
}

/// Situation: the wheel sensor reads 0 from 3 s on, at 1, 2, 3 and 5 m/s.
/// Action: ride on.
/// Must hold: from 2 m/s on the wheel is reported 0.2 to 2 s later and until the end; never at 1 m/s, the speed of a
/// bicycle led by hand. Parked is reported at every speed.
#[test]
fn a_standing_wheel_sensor_is_reported_in_turns() {
    for (speed_m_s, named) in [(1.0, false), (2.0, true), (3.0, true), (5.0, true)] {
        let wheel = |t: f32, v: f32| if t < 3.0 { v } else { 0.0 };
        let ride = Ride { speed_m_s, swing_rad: 0.08, wheel, ..CORRECT };
        match reported(&ride, Cause::RearWheelStuck) {
            Some((from, until)) => {
                assert!(named && (3.2..5.0).contains(&from) && until > 8.5, "{speed_m_s}: {from} {until}");
            }
            None => assert!(!named, "{speed_m_s}"),
        }
        assert!(reported(&ride, Cause::Parked).is_some(), "{speed_m_s}");
    }
}

/// Situation: a wheel that stops from 4.9 m/s at 3 s: lifted, in 70 ms, and dropped 5 s later; or braked at the grip
/// limit of tyres, in 0.6 s.
/// Action: ride on.
/// Must hold: the lifted wheel's jump is reported within 30 to 100 ms, and again within 0.4 s of its drop; no jump of
/// the braked wheel.
#[test]
fn a_lifted_wheel_jumps_and_a_braked_one_does_not() {
    let lifted =
        |t: f32, v: f32| v * (1.0 - ((t - 3.0) / 0.07).clamp(0.0, 1.0) + ((t - 8.0) / 0.07).clamp(0.0, 1.0));
    let braked = |t: f32, v: f32| v * (1.0 - ((t - 3.0) / 0.6).clamp(0.0, 1.0));
    let ride = Ride { speed_m_s: 4.9, swing_rad: 0.0, wheel: lifted, ..CORRECT };
    let (from, until) = reported(&ride, Cause::RearWheelJump).expect("reported");
    assert!((3.03..3.1).contains(&from) && (8.03..8.4).contains(&until), "{from} {until}");
    assert_eq!(reported(&Ride { wheel: braked, ..ride }, Cause::RearWheelJump), None);
}
