//! The initial state of a ride.

use super::{Geometry, State};

/// Initial state of one ride: straight and upright on steady riding, plus a disturbance that changes the
/// rates instantaneously.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Forward speed of the rear wheel \[m/s\].
    #[serde(default = "unknown")]
    pub speed_m_s: f64,
    /// Steer rate \[rad/s\].
    #[serde(default)]
    pub steer_rate_rad_s: f64,
    /// Roll rate \[rad/s\].
    #[serde(default)]
    pub roll_rate_rad_s: f64,
}

/// A speed that is not given.
fn unknown() -> f64 {
    f64::NAN
}

impl Start {
    /// The bicycle's state at t = 0.
    pub fn state(&self, b: &Geometry) -> State<f64> {
        State {
            roll_rate: self.roll_rate_rad_s,
            steer_rate: self.steer_rate_rad_s,
            ..State::upright(b, self.speed_m_s)
        }
    }
    /// The three values, as the key of a ride's random numbers.
    pub fn key(&self) -> [f64; 3] {
        [self.speed_m_s, self.steer_rate_rad_s, self.roll_rate_rad_s]
    }
}
