//! Checks that run every 24 ms.
//!
//! * **Repeated samples**: whether an IMU repeats its sample while the bicycle rides. Another sensor must change to
//!   prove the fault.
//! * **Rear wheel jump**: whether the rear wheel's speed changes more than a bicycle can. A lifted, dropped or blocked
//!   wheel changes its speed in steps that pass the sample-to-sample check.

use crate::fault::{Cause, Causes};
use core::hint::cold_path;

/// Speed above which every sensor of the frame's motion changes \[m/s\].
const RIDING_M_S: f32 = 0.5;

/// Largest change of a rolling wheel's speed within four checks, 96 ms \[m/s\]. With tyres that grip it is about 1; of
/// a wheel pushed by hand, or inside the basins of `h`, no more than 2.
const MAX_CHANGE_M_S: f32 = 2.5;

/// Samples of gyro, accelerometer and the other sensors at the last check, and the number of consecutive checks with
/// equal samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub(super) struct Repeats {
    gyro_rad_s: [f32; 3],
    accel_m_s2: [f32; 3],
    others: [f32; 3],
    gyro_checks: u16,
    accel_checks: u16,
    /// Rear wheel speed at the last checks, oldest first; NaN where unknown \[m/s\].
    rear_m_s: [f32; 4],
}

impl Default for Repeats {
    fn default() -> Self {
        Self {
            gyro_rad_s: [0.0; 3],
            accel_m_s2: [0.0; 3],
            others: [0.0; 3],
            gyro_checks: 0,
            accel_checks: 0,
            rear_m_s: [f32::NAN; 4],
        }
    }
}

impl Repeats {
    /// One check of gyro (w), accelerometer (f) and rear wheel, NaN where not valid, and of steer angle and front
    /// wheel. Returns the causes of the sensors to invalidate. Scalar arguments are passed in registers; an array would
    /// have to be in memory in every control period.
    #[inline(never)]
    #[allow(clippy::too_many_arguments, reason = "in registers")]
    pub(super) fn check(
        &mut self,
        checks: u16,
        wx: f32,
        wy: f32,
        wz: f32,
        fx: f32,
        fy: f32,
        fz: f32,
        steer_rad: f32,
        front_m_s: f32,
        rear_m_s: f32,
    ) -> Causes {
        let mut causes = Causes::NONE;
        let (gyro_rad_s, accel_m_s2) = ([wx, wy, wz], [fx, fy, fz]);
        let others = [steer_rad, front_m_s, if rear_m_s.is_nan() { 0.0 } else { rear_m_s }];
        let [gyro, accel] = [gyro_rad_s == self.gyro_rad_s, accel_m_s2 == self.accel_m_s2];
        if gyro || accel {
            cold_path();
            let riding = front_m_s > RIDING_M_S || rear_m_s > RIDING_M_S;
            // A missing sensor does not count as changing.
            let [gyro_changes, accel_changes] = [!(gyro || wx.is_nan()), !(accel || fx.is_nan())];
            let changes = others != self.others;
            let count = |equal: bool, other_changes: bool, before: u16| {
                if riding && equal && (changes || other_changes) { before.saturating_add(1) } else { 0 }
            };
            self.gyro_checks = count(gyro, accel_changes, self.gyro_checks);
            self.accel_checks = count(accel, gyro_changes, self.accel_checks);
            causes.note(Cause::GyroStuck, self.gyro_checks >= checks);
            causes.note(Cause::AccelStuck, self.accel_checks >= checks);
        } else {
            (self.gyro_checks, self.accel_checks) = (0, 0);
        }
        let [oldest, later @ ..] = self.rear_m_s;
        causes.note(Cause::RearWheelJump, (rear_m_s - oldest).abs() > MAX_CHANGE_M_S);
        let [a, b, c] = later;
        self.rear_m_s = [a, b, c, rear_m_s];
        (self.gyro_rad_s, self.accel_m_s2, self.others) = (gyro_rad_s, accel_m_s2, others);
        causes
    }
}
