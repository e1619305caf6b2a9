//! The torque on the steer axis: the sum of assist, rider, friction and end-stop.

use crate::bicycle::Torques;
use crate::num::{Lanes, Scalar};
use crate::plant::ActuatorConfig;

/// The number of one ride, or those of several rides side by side.
pub(super) trait PerRide: Scalar {
    /// Applies `op` to the two numbers of each ride.
    fn zip(self, other: Self, op: impl Fn(f64, f64) -> f64) -> Self;
}

impl PerRide for f64 {
    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(f64, f64) -> f64) -> Self {
        op(self, other)
    }
}

impl<const N: usize> PerRide for Lanes<N> {
    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(f64, f64) -> f64) -> Self {
        Lanes(std::array::from_fn(|lane| op(self.0[lane], other.0[lane])))
    }
}

/// The torques on a bicycle without a roll torque: everything that acts on the steer axis, added in this order, so that a
/// ride has the same bits in lanes and in substeps. `steer_rad` is evaluated only where there is an end-stop.
#[inline(always)]
pub(super) fn torques<S: PerRide>(
    actuator: &ActuatorConfig,
    assist_nm: S,
    rider_nm: Option<S>,
    steer_rad: impl FnOnce() -> S,
    steer_rate_rad_s: S,
) -> Torques<S> {
    let mut steer = rider_nm.map_or(assist_nm, |rider_nm| assist_nm + rider_nm);
    if actuator.friction.acts() {
        steer = steer + actuator.friction.torque(steer_rate_rad_s);
    }
    if let Some(stop) = &actuator.stop {
        steer = steer + steer_rad().zip(steer_rate_rad_s, |angle, rate| stop.torque(angle, rate));
    }
    Torques { roll: S::constant(0.0), steer }
}
