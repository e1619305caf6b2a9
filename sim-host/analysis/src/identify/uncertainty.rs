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

/// The products of a signal's derivatives with themselves some lags later, and its residuals' covariance at these lags.
struct Lagged {
    products: Vec<DMatrix<f64>>,
    covariance: Vec<f64>,
    length: f64,
}

impl Lagged {
    /// Sum of the products, each with its factor and transposed for the opposite lag.
    fn sum(&self, factor: impl Fn(usize, &DMatrix<f64>) -> f64) -> DMatrix<f64> {
        let terms = self.products.iter().enumerate().map(|(lag, product)| {
            let term = product * factor(lag, product);
            if lag == 0 { term } else { &term + term.transpose() }
        });
        terms.sum()
    }
}

/// Covariance at an optimum (Ljung 1999, section 9.4): `(J'J)^-1 J' R J (J'J)^-1` with `R` the covariance of the residuals
/// as estimated from themselves, which the fit has made orthogonal to `J`: it took the variance `tr((J'J)^-1 J' R J) / gains`
/// out of each direction of `J`, and that is put back at every lag. For white residuals it is the common
/// `variance (J'J)^-1`. `None` if the Jacobian is singular.
pub(super) fn uncertainty(objective: &Objective, at: &Evaluation, sample_s: f64) -> Option<Uncertainty> {
    let count = at.jacobian.ncols();
    let reach = ((REACH_S / sample_s) as usize).max(1);
    // Derivatives of unit length, because the gains' units differ by orders of magnitude.
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
    let (mut signals, mut first) = (Vec::new(), 0);
    for length in objective.lengths() {
        let rest: Vec<f64> = at.residual.rows(first, length).iter().copied().collect();
        let columns = unit.rows(first, length);
        let covariance = autocovariance(&rest, reach);
        let product = |lag: usize| columns.rows(0, length - lag).tr_mul(&columns.rows(lag, length - lag));
        let products = (0..covariance.len()).map(product).collect();
        signals.push(Lagged { products, covariance, length: length as f64 });
        first += length;
    }
    let estimated: DMatrix<f64> =
        signals.iter().map(|signal| signal.sum(|lag, _| signal.covariance[lag])).sum();
    let taken = (&inverse * &estimated).trace() / count as f64;
    let put_back = |signal: &Lagged| {
        signal.sum(|lag, product| {
            taken * (&inverse * product).trace() / signal.length * parzen(lag as f64 / reach as f64)
        })
    };
    let middle = estimated + signals.iter().map(put_back).sum::<DMatrix<f64>>();
    let scale = DMatrix::from_diagonal(&lengths.map(f64::recip));
    let covariance = &scale * &inverse * middle * &inverse * &scale;
    let symmetric = (&covariance + covariance.transpose()) / 2.0;
    symmetric.iter().all(|x| x.is_finite()).then_some(Uncertainty {
        covariance: symmetric,
        independent: signals.iter().map(|signal| signal.length / dependence(&signal.covariance)).collect(),
        condition,
    })
}
