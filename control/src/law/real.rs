//! The two number types a law can be evaluated in: f32 on the chip and in the firmware's copy on
//! the host, f64 in the simulator's ideal continuous controller.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A floating-point number with the few operations the laws need.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A literal of a formula, rounded once to the type.
    fn lit(value: f64) -> Self;
    /// e to the power of `self`, as [`libm`] has it (error below 1 ulp; the same bits on every machine).
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
