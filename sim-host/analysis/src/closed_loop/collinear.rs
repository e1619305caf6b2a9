//! Which columns of a regression can be separated.

use nalgebra::{DMatrix, DVector};

/// Largest variance inflation: beyond, an error is more than seven times that of the signal alone.
pub(super) const MOST_INFLATION: f64 = 50.0;

/// A column that a regression can't have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Inseparable {
    /// The same value all the time.
    Constant,
    /// A linear function of the columns before it.
    Collinear {
        /// The most similar of them.
        with: usize,
        /// Variance inflation.
        inflation: f64,
    },
}

/// Chooses columns in their order; each is kept unless it is a linear function of those kept before and a constant.
pub(super) fn separable(x: &DMatrix<f64>) -> (Vec<usize>, Vec<(usize, Inseparable)>) {
    let (mut kept, mut left): (Vec<usize>, Vec<(usize, Inseparable)>) = (Vec::new(), Vec::new());
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let centred: Vec<DVector<f64>> =
        x.column_iter().map(|column| column.add_scalar(-column.mean())).collect();
    for (j, column) in centred.iter().enumerate() {
        let whole = column.norm_squared();
        if whole.sqrt() <= 1e-9 * x.column(j).norm() || whole == 0.0 {
            left.push((j, Inseparable::Constant));
            continue;
        }
        let rest = without(&basis, column.clone());
        let inflation = whole / rest.norm_squared().max(f64::MIN_POSITIVE);
        if inflation > MOST_INFLATION {
            let likeness = |k: &usize| (centred[*k].dot(column) / centred[*k].norm()).abs();
            let with = kept.iter().copied().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
            left.extend(with.map(|with| (j, Inseparable::Collinear { with, inflation })));
        } else {
            basis.push(rest.normalize());
            kept.push(j);
        }
    }
    (kept, left)
}

/// Variance inflation of a column by others and a constant.
pub(super) fn inflation(x: &DMatrix<f64>, column: &DVector<f64>) -> f64 {
    let centred = |column: &DVector<f64>| column.add_scalar(-column.mean());
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for other in separable(x).0 {
        let rest = without(&basis, centred(&x.column(other).into_owned()));
        basis.push(rest.normalize());
    }
    let whole = centred(column);
    whole.norm_squared() / without(&basis, whole.clone()).norm_squared().max(f64::MIN_POSITIVE)
}

/// What is left of a column without the directions of an orthonormal basis; twice, for the rounding.
fn without(basis: &[DVector<f64>], mut column: DVector<f64>) -> DVector<f64> {
    for direction in basis.iter().chain(basis) {
        column -= direction * direction.dot(&column);
    }
    column
}
