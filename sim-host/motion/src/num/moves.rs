//! States that can be integrated over time.

/// A state that can be advanced by its time derivative.
pub trait Moves: Copy {
    /// `self + h * rate`, entry by entry.
    fn moved(&self, h: f64, rate: &Self) -> Self;
}
