//! How far two outlines are apart.

use super::{Basin, Bound};

/// Root-mean-square distance of two outlines \[rad/s\], both readings of the thesis's eq. 2.22.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Rmse {
    /// The root of the mean of the squared differences.
    pub mean: f64,
    /// As the equation is printed, without 1/n: the root of their sum.
    pub as_printed: f64,
    /// How both lie to the true distances.
    pub bound: Bound,
}

/// The distance over the speeds both outlines have; `None` when they share none.
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
