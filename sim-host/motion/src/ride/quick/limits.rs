//! Limits of a torque in continuous time: of its magnitude, of its change, and by the motor.

use crate::plant::ActuatorConfig;
use control::Limits;

/// Rate of change that counts as none \[N m/s\].
const UNLIMITED_NM_S: f64 = 1e9;

/// Limits of the torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TorqueLimits {
    /// Largest commanded torque \[N m\].
    pub(super) largest_nm: f64,
    /// Largest rate of change away from zero, and towards zero \[N m/s\].
    rise_nm_s: f64,
    fall_nm_s: f64,
    /// Delivered over commanded torque, and the largest that the motor delivers \[N m\].
    scale: f64,
    delivered_nm: f64,
}

/// What determines a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum By {
    Law,
    Magnitude,
    /// The rates of change on the two sides of zero.
    RateLeft,
    RateRight,
}

impl TorqueLimits {
    pub(super) const NONE: Self = Self {
        largest_nm: f64::INFINITY,
        rise_nm_s: UNLIMITED_NM_S,
        fall_nm_s: UNLIMITED_NM_S,
        scale: 1.0,
        delivered_nm: f64::INFINITY,
    };

    /// Those of a controller and a motor.
    pub(super) fn new(limits: &Limits, actuator: &ActuatorConfig) -> Self {
        let rate = |nm_s: Option<f32>| nm_s.map_or(UNLIMITED_NM_S, f64::from);
        Self {
            largest_nm: limits.max_torque_nm.map_or(f64::INFINITY, f64::from),
            rise_nm_s: rate(limits.rise_nm_s),
            fall_nm_s: rate(limits.fall_nm_s),
            scale: actuator.scale,
            delivered_nm: actuator.limit_nm.unwrap_or(f64::INFINITY),
        }
    }

    /// The slower rate of change \[N m/s\].
    pub(super) fn slower_nm_s(&self) -> f64 {
        self.rise_nm_s.min(self.fall_nm_s)
    }

    /// Whether the motor delivers what is commanded.
    pub(super) fn exact_motor(&self) -> bool {
        self.scale == 1.0 && self.delivered_nm == f64::INFINITY
    }

    /// The command `elapsed_s` after it was `began_nm`, if the law's torque is `wanted_nm` \[N m\]. The limiter of the control
    /// crate in continuous time: a torque that changes sign first falls to zero.
    #[inline(always)]
    pub(super) fn command(&self, began_nm: f64, wanted_nm: f64, elapsed_s: f64) -> f64 {
        let wanted = wanted_nm.max(-self.largest_nm).min(self.largest_nm);
        if self.slower_nm_s() >= UNLIMITED_NM_S {
            return wanted;
        }
        let side = if began_nm < 0.0 { -1.0 } else { 1.0 };
        let risen = side * began_nm + self.rise_nm_s * elapsed_s;
        let fallen = side * began_nm - self.fall_nm_s * elapsed_s;
        let fallen = if fallen < 0.0 { fallen * (self.rise_nm_s / self.fall_nm_s) } else { fallen };
        side * (side * wanted).max(fallen).min(risen)
    }

    /// What determines [`Self::command`].
    pub(super) fn by(&self, began_nm: f64, wanted_nm: f64, elapsed_s: f64) -> By {
        let command_nm = self.command(began_nm, wanted_nm, elapsed_s);
        if command_nm == wanted_nm {
            By::Law
        } else if command_nm.abs() == self.largest_nm {
            By::Magnitude
        } else if command_nm < 0.0 {
            By::RateLeft
        } else {
            By::RateRight
        }
    }

    /// The motor's torque by the command \[N m\].
    #[inline(always)]
    pub(super) fn delivered(&self, command_nm: f64) -> f64 {
        (self.scale * command_nm).max(-self.delivered_nm).min(self.delivered_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::TorqueLimits;

    /// A torque of 3 N m that is to become -4 N m, rise 10 and fall 20 N m/s: zero after 0.15 s, then a rise of 10 N m/s to the
    /// other side.
    #[test]
    fn a_torque_that_changes_sign_first_falls_to_zero() {
        let limits = TorqueLimits { largest_nm: 3.5, rise_nm_s: 10.0, fall_nm_s: 20.0, ..TorqueLimits::NONE };
        for (elapsed_s, torque_nm) in [(0.0, 3.0), (0.1, 1.0), (0.15, 0.0), (0.25, -1.0), (1.0, -3.5)] {
            for side in [1.0, -1.0] {
                let now = limits.command(side * 3.0, side * -4.0, elapsed_s);
                assert!((now - side * torque_nm).abs() < 1e-12, "{now} N m after {elapsed_s} s");
            }
        }
        assert!((limits.command(1.0, 4.0, 0.1) - 2.0).abs() < 1e-12, "a torque on the same side rises");
        assert_eq!(limits.command(1.0, 1.5, 0.1), 1.5, "a torque within reach is reached");
    }
}
