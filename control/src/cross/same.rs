//! Does an IMU repeat itself while the bicycle rides? It takes another sensor that changes to know that this is wrong.

use crate::fault::{Cause, Causes};
use core::hint::cold_path;

/// Speed above which no sensor of the frame's motion stands still \[m/s\].
const STANDING_M_S: f32 = 0.5;

/// What gyro, accelerometer and the other sensors said at the last look, and how often each of the two has said the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Same {
    gyro_rad_s: [f32; 3],
    accel_m_s2: [f32; 3],
    others: [f32; 3],
    gyro_checks: u16,
    accel_checks: u16,
    /// Those that have said the same too often.
    pub(super) stuck: Causes,
}

impl Same {
    /// Another look: at gyro (w) and accelerometer (f), NaN where one is not believed, steer angle and speeds. Each is a
    /// value of its own, which goes by register; an array would have to lie in memory in every control period.
    #[inline(never)]
    #[allow(clippy::too_many_arguments, reason = "in registers")]
    pub(super) fn look(
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
    ) {
        let (gyro_rad_s, accel_m_s2) = ([wx, wy, wz], [fx, fy, fz]);
        let others = [steer_rad, front_m_s, rear_m_s];
        let [gyro, accel] = [gyro_rad_s == self.gyro_rad_s, accel_m_s2 == self.accel_m_s2];
        if gyro || accel {
            cold_path();
            let rides = front_m_s > STANDING_M_S || rear_m_s > STANDING_M_S;
            // One that is not known does not change.
            let [gyro_changes, accel_changes] = [!(gyro || wx.is_nan()), !(accel || fx.is_nan())];
            let changes = others != self.others;
            let count = |same: bool, other_changes: bool, before: u16| {
                if rides && same && (changes || other_changes) { before.saturating_add(1) } else { 0 }
            };
            self.gyro_checks = count(gyro, accel_changes, self.gyro_checks);
            self.accel_checks = count(accel, gyro_changes, self.accel_checks);
            self.stuck = Causes::NONE;
            self.stuck.note(Cause::GyroStuck, self.gyro_checks >= checks);
            self.stuck.note(Cause::AccelStuck, self.accel_checks >= checks);
        } else {
            (self.gyro_checks, self.accel_checks, self.stuck) = (0, 0, Causes::NONE);
        }
        (self.gyro_rad_s, self.accel_m_s2, self.others) = (gyro_rad_s, accel_m_s2, others);
    }
}
