//! Identification of a rider: the feedback gains of a delayed rider model from a record of a perturbed ride (Kuipers 2020,
//! sections 2.1.3 and 2.3; Schwab et al. 2013).
//!
//! [`identify`] runs all steps. From a [`Record`], a bicycle, a speed and a delay ([`GrayBox`]) to gains with their covariance ([`Fit`]). The model's
//! response is simulated from rest with exact discretisation (`interval`); its difference from the measured signals is
//! minimised by a global search in the frequency domain (`spectrum`, `evolution`) and a Levenberg-Marquardt search in
//! time with exact derivatives (`descent`). [`refine`] corrects them for the nonlinearity of the
//! bicycle. [`reduce`] leaves out the gains that the record does not need,
//! [`delay_profile`] asks what it tells about the delay, [`impulse_response`] separates the response from the rider's own
//! motion.

mod delay;
mod descent;
mod error;
mod evolution;
mod fir;
mod fit;
mod gray_box;
mod interval;
mod nonlinear;
mod objective;
mod pipeline;
mod record;
mod reduction;
mod residuals;
mod response;
mod search;
mod spectrum;
mod uncertainty;

pub use delay::{DROP_95, DelayPoint, DelayProfile, delay_profile};
pub use error::{FitError, SHORTEST_S};
pub use fir::{Fir, impulse_response};
pub use fit::{AFTER_ONSET_S, Fit, From, LocalOptimum, Problem, Residuals, rightmost_real};
pub use gray_box::{GAINS, GrayBox, PerGain, symbols};
pub use nonlinear::{Pushed, Refined, refine};
pub use objective::Drift;
pub use pipeline::{IMPULSE_RESPONSE_S, Identified, Plan, Stage, identify};
pub use record::{Measured, Record};
pub use reduction::{Criteria, Select, Step, reduce};
pub use response::{Disturbances, Hold, Signal};
