//! Neuromuscular dynamics: the second-order filter between the neural signal and the steer torque
//! (eq. B.5; eq. 2.9 is printed without the square of its input gain).

use crate::num::Scalar;
use crate::range::{RangeError, within};

/// `T'' = omega^2 (alpha - T) - 2 zeta omega T'`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Neuromuscular {
    /// Undamped natural frequency \[rad/s\].
    pub omega_rad_s: f64,
    /// Damping ratio.
    pub zeta: f64,
}

impl Neuromuscular {
    /// Shoulder dynamics: 2.17 Hz, damping ratio `sqrt(1/2)` (Schouten et al. 2007, as used by the thesis).
    pub const SHOULDERS: Self =
        Self { omega_rad_s: 2.17 * std::f64::consts::TAU, zeta: std::f64::consts::FRAC_1_SQRT_2 };

    /// `T''` \[N m/s^2\] for the neural signal `alpha` \[N m\], from `T` \[N m\] and `T'`.
    #[inline(always)]
    pub fn acceleration<S: Scalar>(&self, alpha: S, torque: S, torque_rate: S) -> S {
        let (w, zeta) = (self.omega_rad_s, self.zeta);
        (alpha - torque) * (w * w) - torque_rate * (2.0 * zeta * w)
    }

    /// Checks ranges.
    ///
    /// # Errors
    /// The value and its range.
    pub fn check(&self) -> Result<(), RangeError> {
        within("neuromuscular natural frequency (rad/s)", self.omega_rad_s, 0.1, 200.0)?;
        within("neuromuscular damping ratio", self.zeta, 0.01, 10.0)
    }
}
