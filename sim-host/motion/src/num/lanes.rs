//! Several numbers side by side; the compiler vectorises the loops.

use super::Scalar;
use super::sincos::{by_quadrant, reduced};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `N` independent numbers. Operations act on each lane alone, so each lane has the same bits as an `f64`
/// after the same operations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<const N: usize>(pub [f64; N]);

impl<const N: usize> Lanes<N> {
    /// Applies a function to every lane.
    #[inline(always)]
    pub fn map(self, op: impl Fn(f64) -> f64) -> Self {
        let mut out = self;
        for i in 0..N {
            out.0[i] = op(self.0[i]);
        }
        out
    }
}

macro_rules! binary {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<const N: usize> $trait for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut out = self;
                for i in 0..N {
                    out.0[i] = self.0[i] $op other.0[i];
                }
                out
            }
        }
    };
}
binary!(Add, add, +);
binary!(Sub, sub, -);
binary!(Mul, mul, *);
binary!(Div, div, /);

impl<const N: usize> Add<f64> for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        self + Self([other; N])
    }
}

impl<const N: usize> Mul<f64> for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * Self([other; N])
    }
}

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut out = self;
        for i in 0..N {
            out.0[i] = -self.0[i];
        }
        out
    }
}

impl<const N: usize> Scalar for Lanes<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let mut out = self;
        for i in 0..N {
            out.0[i] = self.0[i].sqrt();
        }
        out
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut s, mut c, quadrant) = reduced(self);
        for i in 0..N {
            (s.0[i], c.0[i]) = by_quadrant(s.0[i], c.0[i], quadrant.0[i].to_bits());
        }
        (s, c)
    }
}
