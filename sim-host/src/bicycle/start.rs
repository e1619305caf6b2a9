//! The initial state of a ride.

use super::{Geometry, State};

/// Initial state of one ride: straight and upright on steady riding, plus a disturbance that changes the
/// rates instantaneously.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Start {
    /// Forward speed of the rear wheel \[m/s\].
    pub speed_m_s: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate_rad_s: f64,
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f64,
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
    pub(crate) fn key(&self) -> [f64; 3] {
        [self.speed_m_s, self.steer_rate_rad_s, self.roll_rate_rad_s]
    }
}
