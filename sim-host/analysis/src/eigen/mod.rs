//! Linear analysis of a bicycle with an assist and a delayed rider: characteristic roots over speed, critical
//! speeds, and modes. See `docs/eigenvalues.md`.

mod actuator;
mod critical;
mod feedback;
mod follow;
mod generator;
mod modes;
mod qr;
mod roots;
mod stability;
mod system;

pub use actuator::{ActuatorError, LinearActuator};
pub use critical::{CriticalSpeeds, SEARCH_TO_M_S, critical_speeds};
pub use feedback::{Feedback, Intuitive, StaticFeedback};
pub use modes::{Mode, REFERENCE_SPEED_M_S, modes, modes_until};
pub use qr::spectrum;
pub use roots::{rightmost, roots};
pub use stability::{Crossing, Stability, StabilityChange, stability, stability_until};
pub use system::{DelaySystem, Model};

use control::Law;
use nalgebra::Complex;
use physics::bicycle::linear::Linear;
use rayon::prelude::*;

/// The four eigenvalues \[1/s\] at speed `v` \[m/s\] without a rider: largest real part first; of a conjugate
/// pair, the positive imaginary part first. NaN if the state matrix is not finite.
pub fn eigenvalues(bicycle: &Linear, law: &Law, v: f64) -> [Complex<f64>; 4] {
    let found = spectrum(&bicycle.state_matrix(v, law.gain(v))).and_then(|values| values.try_into().ok());
    let mut values = found.unwrap_or([Complex::new(f64::NAN, f64::NAN); 4]);
    sort(&mut values);
    values
}

/// Growth up to which a root counts as neutral \[1/s\]: it has no effect in a ride. A rider that feeds back the integrals of
/// both roll and steer has a root of zero, as only their weighted sum acts.
pub const NEUTRAL_1_S: f64 = 1e-3;

/// Per speed \[m/s\], the number of models whose straight ride is unstable: the rightmost root grows by more than
/// [`NEUTRAL_1_S`], or no root converges.
pub fn unstable(models: &[Model], speeds: &[f64]) -> Vec<usize> {
    let grows = |model: &Model, v: f64| {
        let growth = rightmost(&model.at(v)).re;
        growth.is_nan() || growth > NEUTRAL_1_S
    };
    speeds.par_iter().map(|&v| models.iter().filter(|model| grows(model, v)).count()).collect()
}

/// Largest real part first, then largest imaginary part.
fn sort(values: &mut [Complex<f64>]) {
    values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
}
