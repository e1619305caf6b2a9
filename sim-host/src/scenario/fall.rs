//! The fall criterion of a scenario.

use super::content::OrNone;
use crate::ride::{FallCriterion, LaidFlat};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When a ride counts as fallen; absent keys have their defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FallChoice {
    /// Largest roll to either side \[rad\].
    pub roll_rad: f64,
    /// Largest steer to either side \[rad\].
    pub steer_rad: f64,
    /// The bicycle lies on the ground below these angles, or "none".
    pub flat: OrNone<LaidFlat>,
}

impl Default for FallChoice {
    fn default() -> Self {
        FallCriterion::default().into()
    }
}

impl From<FallCriterion> for FallChoice {
    fn from(fall: FallCriterion) -> Self {
        Self { roll_rad: fall.roll_rad, steer_rad: fall.steer_rad, flat: OrNone::new(fall.flat) }
    }
}

impl From<FallChoice> for FallCriterion {
    fn from(fall: FallChoice) -> Self {
        Self { roll_rad: fall.roll_rad, steer_rad: fall.steer_rad, flat: fall.flat.value() }
    }
}
