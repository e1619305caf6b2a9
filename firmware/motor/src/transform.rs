//! Clarke's and Park's transforms, amplitude-invariant: a current of 1 A peak in the phases is 1 A in d and q.

/// Two components in stator axes (alpha along phase a, beta a quarter turn ahead) or in rotor axes (d along the rotor's
/// flux, q a quarter turn ahead).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// Component alpha or d.
    pub d: f32,
    /// Component beta or q.
    pub q: f32,
}

const INVERSE_SQRT_3: f32 = 0.577_350_26;
const HALF_SQRT_3: f32 = 0.866_025_4;

impl Vector {
    /// From two components.
    pub const fn new(d: f32, q: f32) -> Self {
        Self { d, q }
    }

    /// Squared length.
    pub fn square(self) -> f32 {
        self.d * self.d + self.q * self.q
    }

    /// Length.
    pub fn length(self) -> f32 {
        libm::sqrtf(self.square())
    }

    /// Sum of two vectors.
    pub fn plus(self, other: Self) -> Self {
        Self::new(self.d + other.d, self.q + other.q)
    }

    /// Difference of two vectors.
    pub fn minus(self, other: Self) -> Self {
        Self::new(self.d - other.d, self.q - other.q)
    }

    /// Multiple of the vector.
    pub fn times(self, factor: f32) -> Self {
        Self::new(self.d * factor, self.q * factor)
    }

    /// Limits the vector to a circle: d has priority, q is limited to the rest.
    pub fn inside(self, radius: f32) -> Self {
        if self.square() <= radius * radius {
            return self;
        }
        let d = control::maths::bounded(self.d, radius);
        let left = radius * radius - d * d;
        Self::new(d, control::maths::bounded(self.q, libm::sqrtf(if left > 0.0 { left } else { 0.0 })))
    }
}

/// Clarke transform: alpha and beta of three phases. The common-mode part cancels.
pub fn clarke([a, b, c]: [f32; 3]) -> Vector {
    Vector::new((2.0 * a - (b + c)) * (1.0 / 3.0), (b - c) * INVERSE_SQRT_3)
}

/// Inverse Clarke transform: three phases without a common-mode part.
pub fn phases(stator: Vector) -> [f32; 3] {
    let (half, other) = (-0.5 * stator.d, HALF_SQRT_3 * stator.q);
    [stator.d, half + other, half - other]
}

/// Park transform: d and q from alpha and beta, with sine and cosine of the electrical angle.
pub fn park(stator: Vector, (sin, cos): (f32, f32)) -> Vector {
    Vector::new(stator.d * cos + stator.q * sin, stator.q * cos - stator.d * sin)
}

/// Inverse Park transform: alpha and beta from d and q.
pub fn stator(rotor: Vector, (sin, cos): (f32, f32)) -> Vector {
    Vector::new(rotor.d * cos - rotor.q * sin, rotor.d * sin + rotor.q * cos)
}
