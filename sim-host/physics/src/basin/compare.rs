//! Root-mean-square distance of two outlines.

use super::{Basin, Bound};

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

/// The distance over the speeds common to both outlines; `None` if there are none.
pub fn rmse(a: &Basin, b: &Basin) -> Option<Rmse> {
    let mut squares = 0.0;
    let mut n = 0u32;
    let mut bound = Bound::Measured;
    for column in &a.columns {
        if let Some(other) = b.columns.iter().find(|c| (c.speed - column.speed).abs() < 1e-9) {
            squares += (column.upper - other.upper).powi(2);
            bound = bound.and(Bound::of_distance(column, other));
            n += 1;
        }
    }
    (n > 0).then(|| Rmse { mean: (squares / f64::from(n)).sqrt(), as_printed: squares.sqrt(), bound })
}
