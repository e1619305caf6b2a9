//! What is looked at every 24 ms.
//!
//! * Does an IMU repeat itself while the bicycle rides? It takes another sensor that changes to know that this is wrong.
//! * Does the rear wheel change its speed by more than a bicycle can? One that is lifted, dropped or blocked does, in steps
//!   that are small enough from sample to sample.

use crate::fault::{Cause, Causes};
use core::hint::cold_path;

/// Speed above which no sensor of the frame's motion stands still \[m/s\].
const STANDING_M_S: f32 = 0.5;

/// Largest change of a rolling wheel's speed within four looks, 96 ms \[m/s\]: of tyres that grip about 1; of a wheel pushed by
/// hand, or inside the basins of `h`, no more than 2.
const CHANGED_M_S: f32 = 2.5;

/// What gyro, accelerometer and the other sensors said at the last look, and how often each of the two has said the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Repeats {
    gyro_rad_s: [f32; 3],
    accel_m_s2: [f32; 3],
    others: [f32; 3],
    gyro_checks: u16,
    accel_checks: u16,
    /// The rear wheel's speed at the last looks, the oldest first; NaN where it was not known \[m/s\].
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
    /// Another look: at gyro (w), accelerometer (f) and rear wheel, NaN where one is not believed, steer angle and front
    /// wheel. What it finds is the cause for which that sensor must not be believed any more. Each is a
    /// value of its own, which goes by register; an array would have to lie in memory in every control period.
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
        let mut found = Causes::NONE;
        let (gyro_rad_s, accel_m_s2) = ([wx, wy, wz], [fx, fy, fz]);
        let others = [steer_rad, front_m_s, if rear_m_s.is_nan() { 0.0 } else { rear_m_s }];
        let [gyro, accel] = [gyro_rad_s == self.gyro_rad_s, accel_m_s2 == self.accel_m_s2];
        if gyro || accel {
            cold_path();
            let rides = front_m_s > STANDING_M_S || rear_m_s > STANDING_M_S;
            // One that is not known does not change.
            let [gyro_changes, accel_changes] = [!(gyro || wx.is_nan()), !(accel || fx.is_nan())];
            let changes = others != self.others;
            let count = |equal: bool, other_changes: bool, before: u16| {
                if rides && equal && (changes || other_changes) { before.saturating_add(1) } else { 0 }
            };
            self.gyro_checks = count(gyro, accel_changes, self.gyro_checks);
            self.accel_checks = count(accel, gyro_changes, self.accel_checks);
            found.note(Cause::GyroStuck, self.gyro_checks >= checks);
            found.note(Cause::AccelStuck, self.accel_checks >= checks);
        } else {
            (self.gyro_checks, self.accel_checks) = (0, 0);
        }
        let [oldest, later @ ..] = self.rear_m_s;
        found.note(Cause::RearWheelJump, (rear_m_s - oldest).abs() > CHANGED_M_S);
        let [a, b, c] = later;
        self.rear_m_s = [a, b, c, rear_m_s];
        (self.gyro_rad_s, self.accel_m_s2, self.others) = (gyro_rad_s, accel_m_s2, others);
        found
    }
}
