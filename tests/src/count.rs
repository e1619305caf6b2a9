//! A number that counts the operations on it.

use sim_host::num::{Scalar, sin_cos};
use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers of operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub sums: u32,
    /// Multiplications.
    pub products: u32,
    /// Divisions.
    pub quotients: u32,
    /// Square roots.
    pub roots: u32,
    /// Pairs of sine and cosine.
    pub angles: u32,
}

thread_local! {
    static COUNTED: Cell<Operations> = Cell::default();
}

/// A number that counts the operations on it, in this thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted(pub f64);

impl Operations {
    /// Runs `work` and counts its operations on [`Counted`] numbers.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        COUNTED.set(Self::default());
        (work(), COUNTED.get())
    }

    /// All operations.
    pub fn total(&self) -> u32 {
        self.sums + self.products + self.quotients + self.roots + self.angles
    }
}

/// Adds one operation to a kind.
fn count(kind: impl FnOnce(&mut Operations) -> &mut u32) {
    let mut counted = COUNTED.get();
    *kind(&mut counted) += 1;
    COUNTED.set(counted);
}

macro_rules! counted {
    ($trait:ident, $method:ident, $op:tt, $kind:ident) => {
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                count(|counted| &mut counted.$kind);
                Self(self.0 $op other.0)
            }
        }
    };
}
counted!(Add, add, +, sums);
counted!(Sub, sub, -, sums);
counted!(Mul, mul, *, products);
counted!(Div, div, /, quotients);

impl Add<f64> for Counted {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        self + Self(other)
    }
}

impl Mul<f64> for Counted {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self * Self(other)
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Scalar for Counted {
    fn constant(value: f64) -> Self {
        Self(value)
    }
    fn sqrt(self) -> Self {
        count(|counted| &mut counted.roots);
        Self(self.0.sqrt())
    }
    fn sin_cos(self) -> (Self, Self) {
        count(|counted| &mut counted.angles);
        let (s, c) = sin_cos(self.0);
        (Self(s), Self(c))
    }
}
