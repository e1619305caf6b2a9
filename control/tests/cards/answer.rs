//! Flight cards: the motor's response, on a handlebar that answers the torque the wrong way round.

use control::{Cause, Config, Sample, SensorFrame, State, Triple, step};
use core::f32::consts::TAU;

/// From when on cause 37 is told \[s\], on a bicycle that rolls upright at a speed while the handlebar swings four times a second
/// against the torque that the drive reports.
fn told(speed_m_s: f32) -> Option<f32> {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    (config.cross.motor_nm, config.cross.steer_rad) = (None, None);
    let plan = config.plan().expect("a sound configuration");
    let mut state = State::default();
    (0..4000_u16).find_map(|ms| {
        let t = 1e-3 * f32::from(ms);
        let (sine, cosine) = (TAU * 4.0 * t).sin_cos();
        let noise = 1e-3 * (f32::from(ms) * f32::from(ms % 97)).sin();
        let frame = SensorFrame {
            now_us: u32::from(ms) * 1000,
            gyro_rad_s: Triple::fresh([noise, -noise, noise]),
            accel_m_s2: Triple::fresh([noise, noise, -9.81]),
            steer_rad: Sample::fresh(-0.06 * cosine),
            steer_rate_rad_s: Sample::fresh(0.06 * TAU * 4.0 * sine),
            front_wheel_m_s: Sample::fresh(speed_m_s),
            rear_wheel_m_s: Sample::fresh(speed_m_s),
            motor_torque_nm: Sample::fresh(-6.0 * cosine),
            ..SensorFrame::missing()
        };
        step(&plan, &mut state, &frame).causes.has(Cause::WrongResponse).then_some(t)
    })
}

/// Situation: the handlebar swings against the torque, by a reversed motor or held by a hand.
/// Action: roll at speeds from standing to 4 m/s.
/// Must hold: up to 1 m/s, where a hand is likelier, nothing is told; above it within 0.6 s, and not before the sensors are ready.
#[test]
fn a_held_handlebar_is_no_reversed_motor() {
    for speed_m_s in [0.0, 0.5, 0.95] {
        assert_eq!(told(speed_m_s), None, "{speed_m_s} m/s");
    }
    for speed_m_s in [1.05, 2.0, 4.0] {
        let t = told(speed_m_s).expect("a reversed motor");
        assert!((0.02..0.6).contains(&t), "{speed_m_s} m/s: {t} s");
    }
}
