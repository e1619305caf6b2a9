//! Covariance of fitted gains when the noise of the record is coloured, as a rider's own motion is.

use super::objective::{Evaluation, Objective};
use nalgebra::{DMatrix, DVector};

/// Reach of the correlation that is taken into account \[s\].
const REACH_S: f64 = 3.0;

/// Uncertainty of a fit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Uncertainty {
    /// Covariance of the fitted gains.
    pub(super) covariance: DMatrix<f64>,
    /// The number of independent residuals of each signal: all, less what their correlation takes.
    pub(super) independent: Vec<f64>,
    /// Condition number of the Jacobian with columns of unit length.
    pub(super) condition: f64,
}

/// Parzen's window from 0 to 1.
fn parzen(x: f64) -> f64 {
    if x < 0.5 { 1.0 - 6.0 * x * x * (1.0 - x) } else { 2.0 * (1.0 - x).powi(3).max(0.0) }
}

/// Autocovariance of `rest` up to `reach` lags, tapered.
fn autocovariance(rest: &[f64], reach: usize) -> Vec<f64> {
    let n = rest.len() as f64;
    let at = |lag: usize| rest.iter().zip(&rest[lag..]).map(|(a, b)| a * b).sum::<f64>() / n;
    (0..reach.min(rest.len())).map(|lag| at(lag) * parzen(lag as f64 / reach as f64)).collect()
}

/// `1 + 2 sum rho^2`: by how much the correlation of residuals reduces the information about their variance (Bartlett 1946).
fn dependence(autocovariance: &[f64]) -> f64 {
    match autocovariance {
        [variance, later @ ..] if *variance > 0.0 => {
            1.0 + 2.0 * later.iter().map(|r| (r / variance).powi(2)).sum::<f64>()
        }
        _ => 1.0,
    }
}

/// Covariance at an optimum (Ljung 1999, section 9.4): `(J'J)^-1 J' R J (J'J)^-1` with `R` the covariance of the residuals
/// as estimated from themselves. For white residuals it is the common `variance (J'J)^-1`. `None` if the Jacobian
/// is singular.
pub(super) fn uncertainty(objective: &Objective, at: &Evaluation, sample_s: f64) -> Option<Uncertainty> {
    let count = at.jacobian.ncols();
    let reach = ((REACH_S / sample_s) as usize).max(1);
    let (mut middle, mut independent, mut first) = (DMatrix::<f64>::zeros(count, count), Vec::new(), 0);
    for length in objective.lengths() {
        let rest: Vec<f64> = at.residual.rows(first, length).iter().copied().collect();
        let columns = at.jacobian.rows(first, length);
        let covariance = autocovariance(&rest, reach);
        for (lag, r) in covariance.iter().enumerate() {
            let product = columns.rows(0, length - lag).tr_mul(&columns.rows(lag, length - lag)) * *r;
            middle += if lag == 0 { product } else { &product + product.transpose() };
        }
        independent.push(length as f64 / dependence(&covariance));
        first += length;
    }
    let lengths = DVector::from_iterator(count, at.jacobian.column_iter().map(|column| column.norm()));
    if lengths.iter().any(|length| *length <= 0.0) {
        return None;
    }
    let mut unit = at.jacobian.clone();
    for (mut column, length) in unit.column_iter_mut().zip(lengths.iter()) {
        column /= *length;
    }
    let singular = unit.singular_values();
    let condition = singular.max() / singular.min();
    let inverse = unit.tr_mul(&unit).cholesky()?.inverse();
    let scale = DMatrix::from_diagonal(&lengths.map(f64::recip));
    let inverse = &scale * inverse * &scale;
    // Gains were fitted to the same residuals.
    let corrected = at.residual.len() as f64 / (at.residual.len() as f64 - count as f64).max(1.0);
    let covariance = &inverse * middle * &inverse * corrected;
    let symmetric = (&covariance + covariance.transpose()) / 2.0;
    symmetric.iter().all(|x| x.is_finite()).then_some(Uncertainty {
        covariance: symmetric,
        independent,
        condition,
    })
}
