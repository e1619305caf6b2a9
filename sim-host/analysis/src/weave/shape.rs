//! Shape of the motion after a disturbance in one gyro axis of a linear bicycle.
//!
//! The riderless bicycle has a weave pair, a fast real root (caster) and a slow one (capsize). Within a
//! recording of one or two seconds the slow mode and the gyro's bias resemble an offset.

use nalgebra::{DMatrix, DVector};

/// Motion fitted in addition to the weave and an offset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Beside {
    /// A decaying real mode, the caster of the linear model.
    #[default]
    Mode,
    /// None.
    Offset,
}

/// Parameters common to all axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Real part of the weave's eigenvalue, negative if it decays \[1/s\].
    pub decay_1_s: f64,
    /// Imaginary part \[rad/s\].
    pub frequency_rad_s: f64,
    /// The real mode's eigenvalue \[1/s\].
    pub mode_1_s: Option<f64>,
}

impl Shape {
    /// The parameters as a vector: decay, frequency, and the mode if there is one.
    pub fn numbers(&self) -> Vec<f64> {
        [self.decay_1_s, self.frequency_rad_s].into_iter().chain(self.mode_1_s).collect()
    }

    /// The shape from such a vector.
    pub fn of(numbers: &[f64]) -> Self {
        Self { decay_1_s: numbers[0], frequency_rad_s: numbers[1], mode_1_s: numbers.get(2).copied() }
    }

    /// Basis motions of an axis, one per column: two of the weave, offset, mode. Times in s.
    pub fn columns(&self, times: &[f64]) -> DMatrix<f64> {
        let mut columns = DMatrix::from_element(times.len(), 3 + usize::from(self.mode_1_s.is_some()), 1.0);
        for (i, t) in times.iter().enumerate() {
            let envelope = libm::exp(self.decay_1_s * t);
            let (sin, cos) = libm::sincos(self.frequency_rad_s * t);
            columns[(i, 0)] = envelope * cos;
            columns[(i, 1)] = envelope * sin;
            if let Some(mode) = self.mode_1_s {
                columns[(i, 3)] = libm::exp(mode * t);
            }
        }
        columns
    }

    /// Derivatives of an axis with `weights` of the columns with respect to each parameter.
    pub fn tangents(&self, times: &[f64], weights: &DVector<f64>) -> DMatrix<f64> {
        let mut tangents = DMatrix::zeros(times.len(), 2 + usize::from(self.mode_1_s.is_some()));
        for (i, t) in times.iter().enumerate() {
            let envelope = t * libm::exp(self.decay_1_s * t);
            let (sin, cos) = libm::sincos(self.frequency_rad_s * t);
            tangents[(i, 0)] = envelope * (weights[0] * cos + weights[1] * sin);
            tangents[(i, 1)] = envelope * (weights[1] * cos - weights[0] * sin);
            if let Some(mode) = self.mode_1_s {
                tangents[(i, 2)] = t * libm::exp(mode * t) * weights[3];
            }
        }
        tangents
    }
}
