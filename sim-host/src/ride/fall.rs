//! When a ride counts as fallen, as data.

use crate::range::within;
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// When a ride counts as fallen.
///
/// Close to 90 degrees of roll the knife-edge model bounces as a coin does: with a handlebar stop, much steer
/// damping or a long trail a bicycle can lie there and never pass the angle. Hence [`FallCriterion::flat`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FallCriterion {
    /// Roll either way beyond this \[rad\]; 90 degrees, as published.
    pub roll_rad: f64,
    /// Steer either way beyond this \[rad\]; 90 degrees, as published.
    pub steer_rad: f64,
    /// The bicycle lies on the ground short of that; null is not looked for.
    pub flat: Option<LaidFlat>,
}

/// The bicycle lies on the ground: its roll passed an angle, and it has not fallen by roll or steer in a time from then,
/// whether it stays there or bounces. A ride whose time is up before counts as laid flat if it has come back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LaidFlat {
    /// Roll either way at which a bicycle lies on the ground \[rad\].
    pub roll_rad: f64,
    /// How long after it passed the angle the ride ends \[s\].
    pub lasting_s: f64,
}

impl FallCriterion {
    /// 90 degrees of roll or steer, and nothing else.
    pub const PUBLISHED: Self = Self { roll_rad: FRAC_PI_2, steer_rad: FRAC_PI_2, flat: None };

    /// Checks ranges.
    ///
    /// # Errors
    /// Names the value and its range.
    pub fn check(&self) -> Result<(), String> {
        let angle = |name: &str, rad: f64| {
            // 90 degrees as typed may be off by rounding.
            within(&format!("{name} (deg)"), (rad.to_degrees() * 1e9).round() / 1e9, 1.0, 90.0)
        };
        angle("fall: roll", self.roll_rad)?;
        angle("fall: steer", self.steer_rad)?;
        self.flat.map_or(Ok(()), |flat| {
            angle("fall: flat", flat.roll_rad)?;
            within("fall: lasting (s)", flat.lasting_s, 0.001, 10.0)
        })
    }
}

impl Default for FallCriterion {
    /// As published, and laid flat 1 s after 80 degrees of roll: the falls of ordinary rides that bounce there have mostly
    /// passed 90 degrees of roll or steer by then, so that their times stay as published.
    fn default() -> Self {
        let flat = LaidFlat { roll_rad: 80f64.to_radians(), lasting_s: 1.0 };
        Self { flat: Some(flat), ..Self::PUBLISHED }
    }
}

/// What made a ride count as fallen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FallCause {
    /// Roll passed [`FallCriterion::roll_rad`].
    Roll,
    /// Steer passed [`FallCriterion::steer_rad`].
    Steer,
    /// [`FallCriterion::flat`].
    LaidFlat,
    /// Roll and yaw became so quick that the ride would cost many times an ordinary one; happens beside 90 degrees of
    /// roll, where the yaw rate of a bouncing bicycle has no bound.
    TooQuick,
    /// The model has no motion there.
    NoMotion,
}

impl FallCause {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Roll, Self::Steer, Self::LaidFlat, Self::TooQuick, Self::NoMotion];

    /// Its name in files.
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
