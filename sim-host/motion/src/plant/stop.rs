//! The mechanical end-stop of the steer: from steer angle and rate to torque.

use crate::range::{RangeError, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Stops at both sides: springs with dampers. They push only away from the stop, so they never hold the steer
/// back when it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SteerStop {
    /// Steer angle of the contact, on either side \[rad\].
    pub angle_rad: f64,
    /// Stiffness \[N m/rad\].
    pub stiffness_nm_rad: f64,
    /// Damping while in contact \[N m s/rad\].
    pub damping_nm_s_rad: f64,
}

impl SteerStop {
    /// Stop at an angle \[rad\], as stiff as a hard rubber bumper: a steer of 0.2 kg m^2 that arrives at 5
    /// rad/s moves 1.6 degrees beyond and rebounds at 0.3 of its rate. A much stiffer stop would need time
    /// steps below 1 ms.
    pub fn at(angle_rad: f64) -> Self {
        Self { angle_rad, stiffness_nm_rad: 2000.0, damping_nm_s_rad: 20.0 }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), RangeError> {
        within("steer stop (rad)", self.angle_rad, 0.05, 1.5)
            .and_then(|()| within("steer stop stiffness (N m/rad)", self.stiffness_nm_rad, 10.0, 5000.0))
            .and_then(|()| within("steer stop damping (N m s/rad)", self.damping_nm_s_rad, 0.0, 50.0))
    }

    /// The torque on the steer axis \[N m\] at a steer angle \[rad\] and rate \[rad/s\].
    pub fn torque(&self, steer_rad: f64, rate: f64) -> f64 {
        let depth = steer_rad.abs() - self.angle_rad;
        if depth <= 0.0 {
            return 0.0;
        }
        let outwards = rate * steer_rad.signum();
        let back = self.stiffness_nm_rad * depth + self.damping_nm_s_rad * outwards;
        -back.max(0.0) * steer_rad.signum()
    }
}
