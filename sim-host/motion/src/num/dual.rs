//! Dual numbers: a value and one exact derivative (forward-mode differentiation).

use super::{Scalar, sin_cos};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `re + eps * epsilon` with `epsilon^2 = 0`: `eps` is the derivative of `re`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// The value.
    pub re: f64,
    /// The derivative of the value.
    pub eps: f64,
}

impl Dual {
    /// The independent variable of the differentiation.
    pub fn variable(re: f64) -> Self {
        Self { re, eps: 1.0 }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { re: self.re + b.re, eps: self.eps + b.eps }
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { re: self.re - b.re, eps: self.eps - b.eps }
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { re: self.re * b.re, eps: self.eps * b.re + self.re * b.eps }
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let re = self.re / b.re;
        Self { re, eps: (self.eps - re * b.eps) / b.re }
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, eps: -self.eps }
    }
}
impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, b: f64) -> Self {
        Self { re: self.re + b, eps: self.eps }
    }
}
impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, b: f64) -> Self {
        Self { re: self.re * b, eps: self.eps * b }
    }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Self {
        Self { re: value, eps: 0.0 }
    }
    fn sqrt(self) -> Self {
        let re = self.re.sqrt();
        Self { re, eps: self.eps / (2.0 * re) }
    }
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = sin_cos(self.re);
        (Self { re: s, eps: c * self.eps }, Self { re: c, eps: -s * self.eps })
    }
}
