//! Fall criterion: configuration and causes.

use crate::range::{RangeError, within_key};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Criterion by which a ride counts as fallen.
///
/// Near 90 degrees of roll the knife-edge model bounces as a coin does. With a handlebar stop, much steer
/// damping or a long trail a bicycle can lie there without passing the angle; see [`FallCriterion::flat`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FallCriterion {
    /// Largest roll to either side \[rad\]; 90 degrees, as published.
    pub roll_rad: f64,
    /// Largest steer to either side \[rad\]; 90 degrees, as published.
    pub steer_rad: f64,
    /// Criterion for a bicycle that lies on the ground below these angles; null disables it.
    pub flat: Option<LaidFlat>,
}

/// The bicycle lies on the ground: its roll passed an angle, and a time has elapsed since without a fall by
/// roll or steer, whether it stays there or bounces. A ride that ends before that time counts as laid flat if
/// the roll has returned below the angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LaidFlat {
    /// Roll to either side at which a bicycle lies on the ground \[rad\].
    pub roll_rad: f64,
    /// Time from passing the angle to the end of the ride \[s\].
    pub lasting_s: f64,
}

impl FallCriterion {
    /// 90 degrees of roll or steer only.
    pub const PUBLISHED: Self = Self { roll_rad: FRAC_PI_2, steer_rad: FRAC_PI_2, flat: None };

    /// Checks ranges.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), RangeError> {
        let angle = |key, name: &str, rad: f64| {
            // A typed 90 degrees can differ by rounding.
            within_key(key, &format!("{name} (deg)"), (rad.to_degrees() * 1e9).round() / 1e9, 1.0, 90.0)
        };
        angle("fall.roll_rad", "fall: roll", self.roll_rad)?;
        angle("fall.steer_rad", "fall: steer", self.steer_rad)?;
        self.flat.map_or(Ok(()), |flat| {
            angle("fall.flat.roll_rad", "fall: flat", flat.roll_rad)?;
            within_key("fall.flat.lasting_s", "fall: lasting (s)", flat.lasting_s, 0.001, 10.0)
        })
    }
}

impl Default for LaidFlat {
    /// 1 s after 80 degrees of roll.
    fn default() -> Self {
        Self { roll_rad: 80f64.to_radians(), lasting_s: 1.0 }
    }
}

impl Default for FallCriterion {
    /// The published angles, and laid flat 1 s after 80 degrees of roll. Most falls of ordinary rides that
    /// bounce there have passed 90 degrees of roll or steer by then, so their times are the published ones.
    fn default() -> Self {
        Self { flat: Some(LaidFlat::default()), ..Self::PUBLISHED }
    }
}

/// Cause for which a ride counts as fallen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FallCause {
    /// Roll passed [`FallCriterion::roll_rad`].
    Roll,
    /// Steer passed [`FallCriterion::steer_rad`].
    Steer,
    /// [`FallCriterion::flat`].
    LaidFlat,
    /// Roll and yaw became so fast that the ride would cost many times an ordinary one. Occurs near 90
    /// degrees of roll, where the yaw rate of a bouncing bicycle is unbounded.
    TooQuick,
    /// The model has no solution.
    NoMotion,
}

impl FallCause {
    /// All causes.
    pub const ALL: [Self; 5] = [Self::Roll, Self::Steer, Self::LaidFlat, Self::TooQuick, Self::NoMotion];

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Roll => "roll",
            Self::Steer => "steer",
            Self::LaidFlat => "laid-flat",
            Self::TooQuick => "too-quick",
            Self::NoMotion => "no-motion",
        }
    }
}
