//! The mechanical end-stop of the steer.

use super::PlantError;
use crate::range::within;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Stops at both sides, against the steer whatever turns it: springs with dampers that the steer runs into and
/// that never hold it back when it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SteerStop {
    /// Steer angle of the contact, either way \[rad\].
    pub angle_rad: f64,
    /// Stiffness \[N m/rad\].
    pub stiffness_nm_rad: f64,
    /// Damping while in contact \[N m s/rad\].
    pub damping_nm_s_rad: f64,
}

impl SteerStop {
    /// At an angle \[rad\], as stiff as a hard rubber bumper: a steer of 0.2 kg m^2 that arrives with 5 rad/s goes
    /// 1.6 degrees beyond and leaves with 0.3 of its rate. Much stiffer would need steps below 1 ms.
    pub fn at(angle_rad: f64) -> Self {
        Self { angle_rad, stiffness_nm_rad: 2000.0, damping_nm_s_rad: 20.0 }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the value and its range.
    pub fn check(&self) -> Result<(), PlantError> {
        within("steer stop (rad)", self.angle_rad, 0.05, 1.5)
            .and_then(|()| within("steer stop stiffness (N m/rad)", self.stiffness_nm_rad, 10.0, 5000.0))
            .and_then(|()| within("steer stop damping (N m s/rad)", self.damping_nm_s_rad, 0.0, 50.0))
            .map_err(PlantError)
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
