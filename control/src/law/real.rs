//! Number types for evaluating a law: f32 on the chip and in the host's build of the firmware, f64 in the simulator's
//! ideal continuous controller, several f64 side by side in its quick rides.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A floating-point number with the operations that the laws need.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Converts a constant of a formula, rounded once to the type.
    fn lit(value: f64) -> Self;
    /// e to the power of `self`; of f32 and f64 with the bits of [`libm`] (error below 1 ulp, identical on every machine).
    fn exp(self) -> Self;
}

impl Real for f32 {
    #[inline]
    fn lit(value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn exp(self) -> Self {
        crate::maths::exp(self)
    }
}

impl Real for f64 {
    #[inline]
    fn lit(value: f64) -> Self {
        value
    }
    #[inline]
    fn exp(self) -> Self {
        libm::exp(self)
    }
}
