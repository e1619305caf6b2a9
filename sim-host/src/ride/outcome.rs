//! What became of a ride.

use super::{FallCause, Start};

/// How a ride ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// By the ride's [`super::FallCriterion`].
    Fallen {
        /// When \[s\].
        time_s: f64,
        /// What made it count as fallen.
        by: FallCause,
    },
    /// Not fallen within the time limit, and come back close to straight and upright.
    Recovered,
    /// Not fallen within the time limit, and not come back either: a slow capsize, a limit cycle, or
    /// a growing oscillation that only outlasts the time.
    Undecided,
}

impl Outcome {
    /// When it fell \[s\], if it did.
    pub fn time_to_fall_s(&self) -> Option<f64> {
        match self {
            Outcome::Fallen { time_s, .. } => Some(*time_s),
            Outcome::Recovered | Outcome::Undecided => None,
        }
    }

    /// What made it count as fallen, if it did.
    pub fn fall(&self) -> Option<FallCause> {
        match self {
            Outcome::Fallen { by, .. } => Some(*by),
            Outcome::Recovered | Outcome::Undecided => None,
        }
    }

    /// Its name in files.
    pub fn name(&self) -> &'static str {
        match self {
            Outcome::Fallen { .. } => "fallen",
            Outcome::Recovered => "recovered",
            Outcome::Undecided => "undecided",
        }
    }
}

/// What the ride asked of the motor and of the rider.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
pub struct Effort {
    /// Largest torque either way \[N m\].
    pub peak_torque_nm: f64,
    /// Root mean square of the torque over the ride \[N m\].
    pub rms_torque_nm: f64,
    /// Largest change of the torque from one control period to the next, per second \[N m/s\]. The
    /// engagement at t = 0 is not a change.
    pub peak_slew_nm_s: f64,
    /// Largest roll angle either way \[rad\].
    pub peak_roll_rad: f64,
    /// Largest steer angle either way \[rad\].
    pub peak_steer_rad: f64,
    /// Work done by the motor on the steer axis, braking work counted negative \[J\].
    pub motor_energy_j: f64,
    /// Work done by the motor while it pushes \[J\].
    pub motor_energy_out_j: f64,
    /// Largest torque of the rider either way \[N m\].
    pub rider_peak_torque_nm: f64,
    /// Root mean square of the rider's torque over the ride \[N m\].
    pub rider_rms_torque_nm: f64,
    /// Work done by the rider on the steer axis, braking work counted negative \[J\].
    pub rider_energy_j: f64,
    /// Part of the ride in which assist and rider pushed against each other, 0 to 1.
    pub opposed: f64,
}

/// The state at the end of a ride.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct FinalState {
    /// Time \[s\].
    pub t: f64,
    /// Roll \[rad\].
    pub roll: f64,
    /// Steer \[rad\].
    pub steer: f64,
    /// Roll rate \[rad/s\].
    pub roll_rate: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate: f64,
    /// Rear wheel rate \[rad/s\], negative forward.
    pub rear_wheel_rate: f64,
}

/// One finished ride.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ride {
    /// How it began.
    pub start: Start,
    /// How it ended.
    pub outcome: Outcome,
    /// Its state then.
    pub end: FinalState,
    /// What it took.
    pub effort: Effort,
    /// Control periods ridden.
    pub steps: u32,
}

impl Ride {
    /// Whether nothing disturbed it: the model then stays exactly upright, stable or not.
    pub fn undisturbed(&self) -> bool {
        self.effort.peak_roll_rad == 0.0 && self.effort.peak_steer_rad == 0.0 && !self.fell()
    }

    /// Whether it fell.
    pub fn fell(&self) -> bool {
        matches!(self.outcome, Outcome::Fallen { .. })
    }
}
