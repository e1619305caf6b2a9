//! A bicycle with a gyro and one wheel's speed, the minimum for the law.

use control::{Cause, Config, Mode};
use sim_host::parameters::set;
use sim_host::ride::{Conditions, ScheduleSpeed, Start, TracePoint};
use tests::detection::{Detection, detect, of_the_fault};
use tests::fault_reactions::{product, smart};

const KNOCK: Start = Start { speed_m_s: 4.0, steer_rate_rad_s: 1.0, roll_rate_rad_s: 0.0 };
/// Beginning of the fault \[s\].
const FROM_S: f64 = 0.3;
const WHEELS: [&str; 2] = ["rear", "front"];

/// The flashed configuration with a gyro and this wheel only.
fn lone(wheel: &str) -> Config {
    let mut config = product();
    let other = if wheel == "rear" { "front_wheel" } else { "rear_wheel" };
    for sensor in ["accel", "steer", "steer_rate", "motor", other] {
        set(&mut config, &format!("input.{sensor}.fitted"), "off").unwrap();
    }
    set(&mut config, "input.wheel", wheel).unwrap();
    config
}

fn ridden(wheel: &str, fault: &str) -> Detection {
    let fault = format!("{fault}@{FROM_S}s").replace("wheel", &format!("{wheel}-wheel"));
    let schedule_speed = if wheel == "rear" { ScheduleSpeed::Rear } else { ScheduleSpeed::Front };
    detect(&fault, KNOCK, |plant| Conditions {
        time_limit_s: 6.0,
        schedule_speed,
        ..smart(lone(wheel), plant)
    })
}

/// The largest torque from this time after the fault on.
fn torque_nm(trace: &[TracePoint], after_s: f64) -> f64 {
    let late = trace.iter().filter(|p| p.t > FROM_S + after_s);
    late.map(|p| p.torque.abs()).fold(0.0, f64::max)
}

/// Situation: either wheel with the gyro, a knock, no fault (the accelerometer that fails is not fitted).
/// Action: ride.
/// Must hold: engaged to the end, no cause, the torque flows.
#[test]
fn gyro_and_one_wheel_are_enough_to_ride() {
    for wheel in WHEELS {
        let Detection { first, fell, trace } = ridden(wheel, "accel:missing");
        assert!(first.is_none() && !fell, "{wheel}: {first:?}");
        assert!(trace.iter().all(|p| p.mode == Mode::Engaged as u8 && p.causes == 0), "{wheel}");
        let peak_nm = torque_nm(&trace, -FROM_S);
        assert!((0.5..7.0).contains(&peak_nm), "{wheel}: {peak_nm} N m");
    }
}

/// Situation: the same.
/// Action: gyro or wheel stop sending, send invalid values, jump, repeat a sample.
/// Must hold: the sensor is named within its time; with the gyro it ends in a fault, with the wheel in limp mode, and
/// in both cases no torque is left soon after.
#[test]
fn a_sensor_that_fails_is_named() {
    for wheel in WHEELS {
        let [lost, range, jump] = match wheel {
            "rear" => [Cause::RearWheelLost, Cause::RearWheelRange, Cause::RearWheelJump],
            _ => [Cause::FrontWheelLost, Cause::FrontWheelRange, Cause::FrontWheelJump],
        };
        for (fault, cause, mode, within_s) in [
            ("gyro:missing", Cause::GyroLost, Mode::Fault, 0.012),
            ("gyro:nan", Cause::GyroRange, Mode::Fault, 0.012),
            ("gyro.x:jump=5", Cause::GyroJump, Mode::Fault, 0.012),
            ("gyro:stuck", Cause::GyroStuck, Mode::Fault, 0.08),
            ("wheel:missing", lost, Mode::Limp, 0.252),
            ("wheel:nan", range, Mode::Limp, 0.252),
            ("wheel:jump=10", jump, Mode::Limp, 0.252),
            ("wheel:value=0", jump, Mode::Limp, 0.252),
            ("wheel:flip", jump, Mode::Limp, 0.252),
        ] {
            let Detection { first, trace, .. } = ridden(wheel, fault);
            let first = first.unwrap_or_else(|| panic!("{wheel}, {fault}: not detected"));
            assert_eq!(first.causes, [cause], "{wheel}, {fault}");
            assert!((0.008..within_s).contains(&first.after_s), "{wheel}, {fault}: {first}");
            let at = trace.iter().find(|p| !of_the_fault(p).is_empty()).expect("detected");
            assert_eq!(at.mode, mode as u8, "{wheel}, {fault}");
            let left_nm = torque_nm(&trace, within_s + 0.3);
            assert!(left_nm < 1e-6, "{wheel}, {fault}: {left_nm} N m");
        }
    }
}

/// Situation: the same.
/// Action: faults that no other sensor of the bicycle shows: the wheel repeats its speed, drifts, reads half of it;
/// the gyro is reversed.
/// Must hold: as docs/sensors.md states, the first two are never reported, half of the speed is a jump and then
/// accepted, and a reversed gyro is not reported before the bicycle falls; the torque stays within its limit.
#[test]
fn faults_that_one_sensor_does_not_show() {
    for wheel in WHEELS {
        for fault in ["wheel:stuck", "wheel:drift=2/s"] {
            let Detection { first, fell, trace } = ridden(wheel, fault);
            assert!(first.is_none() && !fell, "{wheel}, {fault}: {first:?}");
            assert!((0.01..7.0).contains(&torque_nm(&trace, 0.0)), "{wheel}, {fault}");
        }
        let Detection { first, trace, .. } = ridden(wheel, "wheel:scale=0.5");
        let jump = if wheel == "rear" { Cause::RearWheelJump } else { Cause::FrontWheelJump };
        assert_eq!(first.map(|first| first.causes), Some(vec![jump]), "{wheel}");
        let last = trace.last().expect("a ride");
        assert_eq!((last.mode, last.causes), (Mode::Engaged as u8, 0), "{wheel}");
        let Detection { first, fell, trace } = ridden(wheel, "gyro:flip");
        assert!(fell && first.is_none_or(|first| first.roll_rad > 0.5), "{wheel}");
        assert!((1.0..7.001).contains(&torque_nm(&trace, 0.0)), "{wheel}");
    }
}
