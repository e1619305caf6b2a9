//! Results of a ride: outcome, effort and final state.

use super::{FallCause, Start};

/// How a ride ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// By the ride's [`super::FallCriterion`].
    Fallen {
        /// Time of the fall \[s\].
        time_s: f64,
        /// Cause of the fall.
        by: FallCause,
    },
    /// Not fallen within the time limit, and returned close to straight and upright.
    Recovered,
    /// Not fallen within the time limit, but not recovered: a slow capsize, a limit cycle, or a growing
    /// oscillation that only exceeds the time limit.
    Undecided,
}

impl Outcome {
    /// The outcome of a ride that did not fall, from its largest roll and steer in the last second and in all \[rad\]:
    /// recovered if both are below the fraction `recovered_below` of their maxima. `None` if that is not clear by the
    /// factor `clear`, at least 1.
    pub(super) fn of_amplitudes(
        recovered_below: f64,
        late: [f64; 2],
        peak: [f64; 2],
        clear: f64,
    ) -> Option<Self> {
        let limit = peak.map(|peak| recovered_below * peak);
        if (0..2).all(|i| late[i] * clear <= limit[i]) {
            return Some(Outcome::Recovered);
        }
        (0..2).any(|i| late[i] > limit[i] * clear).then_some(Outcome::Undecided)
    }

    /// Time of the fall \[s\], if it fell.
    pub fn time_to_fall_s(&self) -> Option<f64> {
        match self {
            Outcome::Fallen { time_s, .. } => Some(*time_s),
            Outcome::Recovered | Outcome::Undecided => None,
        }
    }

    /// Cause of the fall, if it fell.
    pub fn fall(&self) -> Option<FallCause> {
        match self {
            Outcome::Fallen { by, .. } => Some(*by),
            Outcome::Recovered | Outcome::Undecided => None,
        }
    }

    /// Name in files.
    pub fn name(&self) -> &'static str {
        match self {
            Outcome::Fallen { .. } => "fallen",
            Outcome::Recovered => "recovered",
            Outcome::Undecided => "undecided",
        }
    }
}

/// Torques, angles and work of motor and rider during a ride.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
pub struct Effort {
    /// Largest magnitude of the torque \[N m\].
    pub peak_torque_nm: f64,
    /// Root mean square of the torque over the ride \[N m\].
    pub rms_torque_nm: f64,
    /// Largest change of the torque from one control period to the next, per second \[N m/s\]. The
    /// engagement at t = 0 is not a change.
    pub peak_slew_nm_s: f64,
    /// Largest magnitude of roll \[rad\].
    pub peak_roll_rad: f64,
    /// Largest magnitude of steer \[rad\].
    pub peak_steer_rad: f64,
    /// Work done by the motor on the steer axis, braking counted negative \[J\].
    pub motor_energy_j: f64,
    /// Work done by the motor at positive power \[J\].
    pub motor_energy_out_j: f64,
    /// Largest magnitude of the rider's torque \[N m\].
    pub rider_peak_torque_nm: f64,
    /// Root mean square of the rider's torque over the ride \[N m\].
    pub rider_rms_torque_nm: f64,
    /// Work done by the rider on the steer axis, braking counted negative \[J\].
    pub rider_energy_j: f64,
    /// Fraction of the ride in which the torques of assist and rider had opposite signs, 0 to 1.
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
    /// Initial state.
    pub start: Start,
    /// Outcome.
    pub outcome: Outcome,
    /// Final state.
    pub end: FinalState,
    /// Torques and work.
    pub effort: Effort,
    /// Control periods simulated.
    pub steps: u32,
}

impl Ride {
    /// Whether there was no disturbance: the model then stays exactly upright, stable or not.
    pub fn undisturbed(&self) -> bool {
        self.effort.peak_roll_rad == 0.0 && self.effort.peak_steer_rad == 0.0 && !self.fell()
    }

    /// Whether the ride ended in a fall.
    pub fn fell(&self) -> bool {
        matches!(self.outcome, Outcome::Fallen { .. })
    }
}
