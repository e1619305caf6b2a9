//! Root-mean-square distance of two outlines.

use super::outline::weights;
use super::{Basin, Bound, Column};

/// Root-mean-square distance of two outlines \[rad/s\], in both interpretations of the thesis's eq. 2.22.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Rmse {
    /// Square root of the mean of the squared differences.
    pub mean: f64,
    /// As the equation is printed, without 1/n: square root of their sum.
    pub as_printed: f64,
    /// Relation of both to the true distances.
    pub bound: Bound,
}

/// The distance over the speeds common to both outlines; `None` if there are none. `mean` weighs unequal steps as
/// [`Basin::mean_height`] does.
pub fn rmse(a: &Basin, b: &Basin) -> Option<Rmse> {
    let other = |column: &Column| b.columns.iter().find(|c| (c.speed - column.speed).abs() < 1e-9);
    let common: Vec<_> = a.columns.iter().filter_map(|column| Some((column, other(column)?))).collect();
    let weights = weights(&common.iter().map(|(column, _)| column.speed).collect::<Vec<_>>());
    let (mut squares, mut weighted, mut bound) = (0.0, 0.0, Bound::Measured);
    for ((column, other), weight) in common.iter().zip(&weights) {
        let square = (column.upper - other.upper).powi(2);
        squares += square;
        weighted += weight * square;
        bound = bound.and(Bound::of_distance(column, other));
    }
    let mean = (weighted / weights.iter().sum::<f64>()).sqrt();
    (!common.is_empty()).then(|| Rmse { mean, as_printed: squares.sqrt(), bound })
}
