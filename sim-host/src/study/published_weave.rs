//! The published stability and weave of the balance-assist prototype (`data/balance_assist.toml`), and the weave of its
//! model.

use crate::bicycle::Parameters;
use crate::eigen::{Feedback, LinearActuator, Model, roots};
use control::Law;
use nalgebra::Complex;
use serde::Deserialize;

/// The published numbers.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// The lowest speeds at which the straight ride is stable.
    pub stable_from: StableFrom,
    /// Measured weave eigenvalues.
    pub weave: Vec<Weave>,
}

/// The lowest speeds at which the straight ride is stable, as printed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StableFrom {
    /// Where they are printed (reference).
    pub source: String,
    /// Slopes of the gain \[N s^2/rad\].
    pub kappa: [f32; 2],
    /// Without a rider \[km/h\].
    pub riderless_kmh: [f64; 2],
    /// With a rigid rider \[km/h\].
    pub ridden_kmh: [f64; 2],
}

/// Measured weave eigenvalues of one setting.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weave {
    /// Where they are published (reference).
    pub source: String,
    /// The slope set in the controller \[N s^2/rad\].
    pub kappa_set: f32,
    /// The slope with which the published model comes near the measurement \[N s^2/rad\].
    pub kappa_model: f32,
    /// Forward speeds \[m/s\].
    pub speed_m_s: Vec<f64>,
    /// Real parts \[1/s\].
    pub re: Vec<f64>,
    /// Imaginary parts \[1/s\].
    pub im: Vec<f64>,
}

impl Weave {
    /// The eigenvalues \[1/s\].
    pub fn roots(&self) -> impl Iterator<Item = Complex<f64>> {
        self.re.iter().zip(&self.im).map(|(re, im)| Complex::new(*re, *im))
    }
}

/// The published numbers.
///
/// # Panics
/// The built-in file is invalid.
pub fn published() -> Published {
    toml::from_str(include_str!("../../../data/balance_assist.toml"))
        .expect("data/balance_assist.toml is sound")
}

/// The weave eigenvalue at each speed \[1/s\], the upper of the rightmost pair, under the balance assist of a given
/// slope through an actuator; `None` where there is no pair.
pub fn weave(
    bicycle: &Parameters,
    kappa: f32,
    actuator: LinearActuator,
    speeds: &[f64],
) -> Vec<Option<Complex<f64>>> {
    let model = Model::new(bicycle, Feedback::Law(Law::BalanceAssist { kappa }), None);
    let Ok(model) = model.with_actuator(actuator) else { return vec![None; speeds.len()] };
    let pair = |v: &f64| roots(&model.at(*v), 6).into_iter().find(|root| root.im > 0.0);
    speeds.iter().map(pair).collect()
}
