//! Records that can't be fitted.

/// Shortest record \[s\].
pub const SHORTEST_S: f64 = 5.0;
/// Fewest samples per gain.
pub(super) const SAMPLES_PER_GAIN: usize = 10;

/// A record that can't be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Too short.
    #[error(
        "the record is {duration_s:.2} s long; the fit needs at least {SHORTEST_S} s after the first {skip_s} s"
    )]
    Short {
        /// Duration of the record \[s\].
        duration_s: f64,
        /// Time that is skipped \[s\].
        skip_s: f64,
    },
    /// Too few samples.
    #[error("{signal} has too few valid samples for {gains} of the gains: {samples} of at least {}", gains * SAMPLES_PER_GAIN)]
    Few {
        /// The signal.
        signal: &'static str,
        /// The number of samples.
        samples: usize,
        /// The number of gains.
        gains: usize,
    },
    /// A value that is not a number.
    #[error("sample {sample} of {signal} is not a number")]
    NotANumber {
        /// The signal.
        signal: &'static str,
        /// Its index.
        sample: usize,
    },
    /// No perturbation.
    #[error(
        "there is no perturbation: lateral force and steer torque are zero throughout, so no gain can be identified"
    )]
    Undisturbed,
    /// A signal that does not move.
    #[error("{0} does not move")]
    Still(&'static str),
    /// No signal or no gain.
    #[error("nothing to fit: {0}")]
    Nothing(&'static str),
    /// Too short for an impulse response.
    #[error("the record is too short, or too little disturbed, for an impulse response of {0}")]
    NoImpulseResponse(&'static str),
    /// A fall of the nonlinear bicycle.
    #[error("with these gains the nonlinear bicycle falls after {time_s:.2} s of the record")]
    Falls {
        /// Time of the fall \[s\].
        time_s: f64,
    },
    /// No bounded response.
    #[error(
        "no set of gains was found for which the response stays bounded over the record; its delay, the sign or unit of the disturbance, or the bicycle may be wrong"
    )]
    Unbounded,
    /// Gains that can't be separated.
    #[error("the gains {0} can't be identified together: the record does not move them independently")]
    Inseparable(String),
    /// Interrupted.
    #[error("interrupted")]
    Interrupted,
}
