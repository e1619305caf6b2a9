//! Number types of the equations of motion: one source for `f64`, for several rides side by side (`Lanes`)
//! and for exact derivatives ([`Dual`]).
//!
//! Only `+ - * /`, square root and [`sin_cos`] are used. None depends on the C library or on fused
//! multiply-add, so a ride has the same bits alone, in a batch, and on every x86-64.

mod dual;
mod exp;
mod lanes;
mod moves;
mod random_stream;
mod registers;
mod sincos;
mod vector;

pub use dual::Dual;
pub(crate) use lanes::{Aligned, Lanes};
pub use moves::Moves;
pub use random_stream::RandomStream;
pub use sincos::sin_cos;
pub use vector::Vec3;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, several in lanes, or a dual number.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians, |angle| below 1e5.
    fn sin_cos(self) -> (Self, Self);
}

impl Scalar for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
}
