//! Several numbers side by side, in the registers of the instruction set that has as many lanes.
//!
//! | lanes | registers of a number | instructions |
//! | ---: | --- | --- |
//! | 16 | 2 of 8 | AVX-512 |
//! | 8 | 1 of 8 | AVX-512 |
//! | 4 | 1 of 4 | AVX2 |
//! | 1 | 1 of 1 | of every processor |
//! | any other | as the compiler finds | of every processor of the target |
//!
//! Lanes of the first three rows are used only in [`crate::ride`]'s functions for these instructions, which are called where the
//! processor has them.

use super::Scalar;
use super::exp::exp;
#[cfg(target_arch = "x86_64")]
use super::registers::{Avx2, Avx512, TwoOfAvx512};
use super::registers::{One, Registers};
use super::sincos::{by_quadrant, reduced};
use control::law::real::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `N` independent numbers. Operations act on each lane alone, so each lane has the same bits as an `f64`
/// after the same operations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f64; N]);

/// A variable that begins a cache line. With one in a function, the compiler also aligns the registers that it stores: an
/// instruction takes longer if its numbers lie in two lines.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub(crate) struct Aligned<T>(pub(crate) T);

impl<const N: usize> Lanes<N> {
    /// Applies a function to every lane.
    #[inline(always)]
    pub(crate) fn map(self, op: impl Fn(f64) -> f64) -> Self {
        let mut out = self;
        for i in 0..N {
            out.0[i] = op(self.0[i]);
        }
        out
    }

    #[inline(always)]
    fn by_quadrant<R: Registers>(s: Self, c: Self, quadrant: Self) -> (Self, Self) {
        let (s, c) = R::by_quadrant(R::load(s.0), R::load(c.0), R::load(quadrant.0));
        (Self(s.numbers()), Self(c.numbers()))
    }
}

/// Returns the result in registers if there are such of `N` lanes.
macro_rules! in_registers {
    ($operation:ident, $($operand:expr),+) => {
        match N {
            #[cfg(target_arch = "x86_64")]
            16 => return Self(TwoOfAvx512::$operation($(TwoOfAvx512::load($operand.0)),+).numbers()),
            #[cfg(target_arch = "x86_64")]
            8 => return Self(Avx512::$operation($(Avx512::load($operand.0)),+).numbers()),
            #[cfg(target_arch = "x86_64")]
            4 => return Self(Avx2::$operation($(Avx2::load($operand.0)),+).numbers()),
            1 => return Self(One::$operation($(One::load($operand.0)),+).numbers()),
            _ => (),
        }
    };
}

macro_rules! binary {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<const N: usize> $trait for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                in_registers!($method, self, other);
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
        self + Self::constant(other)
    }
}

impl<const N: usize> Mul<f64> for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * Self::constant(other)
    }
}

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        in_registers!(neg, self);
        self.map(|x| -x)
    }
}

impl<const N: usize> Scalar for Lanes<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        match N {
            #[cfg(target_arch = "x86_64")]
            16 => return Self(TwoOfAvx512::constant(value).numbers()),
            #[cfg(target_arch = "x86_64")]
            8 => return Self(Avx512::constant(value).numbers()),
            #[cfg(target_arch = "x86_64")]
            4 => return Self(Avx2::constant(value).numbers()),
            1 => return Self(One::constant(value).numbers()),
            _ => (),
        }
        Self([value; N])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        in_registers!(sqrt, self);
        self.map(f64::sqrt)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut s, mut c, quadrant) = reduced(self);
        match N {
            #[cfg(target_arch = "x86_64")]
            16 => return Self::by_quadrant::<TwoOfAvx512>(s, c, quadrant),
            #[cfg(target_arch = "x86_64")]
            8 => return Self::by_quadrant::<Avx512>(s, c, quadrant),
            #[cfg(target_arch = "x86_64")]
            4 => return Self::by_quadrant::<Avx2>(s, c, quadrant),
            1 => return Self::by_quadrant::<One>(s, c, quadrant),
            _ => (),
        }
        for i in 0..N {
            (s.0[i], c.0[i]) = by_quadrant(s.0[i], c.0[i], quadrant.0[i].to_bits());
        }
        (s, c)
    }
}

/// For the laws of quick rides.
impl<const N: usize> Real for Lanes<N> {
    #[inline(always)]
    fn lit(value: f64) -> Self {
        Self::constant(value)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        exp(self)
    }
}
