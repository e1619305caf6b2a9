//! Friction of the steer bearing and the motor's gear: from steer rate to torque.

use crate::num::Scalar;
use crate::range::{RangeError, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Friction about the steer axis, opposing the steer rate. The default has none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Friction {
    /// Viscous coefficient \[N m s/rad\].
    pub viscous_nm_s_rad: f64,
    /// Coulomb friction \[N m\].
    pub coulomb_nm: f64,
    /// Steer rate at which Coulomb friction reaches 71 % of its value \[rad/s\]. Below it the steer creeps
    /// instead of sticking.
    pub creep_rad_s: f64,
}

impl Default for Friction {
    fn default() -> Self {
        Self { viscous_nm_s_rad: 0.0, coulomb_nm: 0.0, creep_rad_s: 0.01 }
    }
}

impl Friction {
    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), RangeError> {
        within("viscous friction (N m s/rad)", self.viscous_nm_s_rad, 0.0, 100.0)
            .and_then(|()| within("Coulomb friction (N m)", self.coulomb_nm, 0.0, 50.0))
            .and_then(|()| within("creep (rad/s)", self.creep_rad_s, 1e-3, 1.0))
            .and_then(|()| {
                // A larger slope has a time constant too short for a time step of 1 ms.
                let slope = self.coulomb_nm / self.creep_rad_s;
                within("Coulomb friction over creep (N m s/rad)", slope, 0.0, 100.0)
            })
    }

    /// Whether any friction is set.
    pub fn acts(&self) -> bool {
        self.viscous_nm_s_rad != 0.0 || self.coulomb_nm != 0.0
    }

    /// Torque on the steer axis at a steer rate \[rad/s\]: `-(c q + T q / sqrt(q^2 + q0^2))`. Smooth and odd;
    /// always opposes the motion.
    #[inline(always)]
    pub fn torque<S: Scalar>(&self, rate: S) -> S {
        let direction = rate / (rate * rate + self.creep_rad_s * self.creep_rad_s).sqrt();
        -(rate * self.viscous_nm_s_rad + direction * self.coulomb_nm)
    }
}
