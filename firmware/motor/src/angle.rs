//! Angles as integers, 2^32 to the turn: wrapping is exact, and counting turns has no rounding.

use control::maths;

/// An angle within one turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Angle(pub u32);

/// Units per turn.
const PARTS: f32 = 4_294_967_296.0;

impl Angle {
    /// A quarter turn.
    pub const QUARTER: Angle = Angle(1 << 30);

    /// From a fraction of a turn; saturates at half a turn either way, NaN gives 0.
    pub fn of(turns: f32) -> Self {
        Angle((turns * PARTS) as i32 as u32)
    }

    /// Sum of two angles.
    pub fn plus(self, other: Angle) -> Self {
        Angle(self.0.wrapping_add(other.0))
    }

    /// Difference of two angles.
    pub fn minus(self, other: Angle) -> Self {
        Angle(self.0.wrapping_sub(other.0))
    }

    /// The negative angle.
    pub fn mirrored(self) -> Self {
        Angle(self.0.wrapping_neg())
    }

    /// Multiple of the angle; with the pole pairs, the electrical angle of a mechanical one.
    pub fn times(self, n: u16) -> Self {
        Angle(self.0.wrapping_mul(u32::from(n)))
    }

    /// As a fraction of a turn, -0.5 to 0.5.
    pub fn signed(self) -> f32 {
        self.0 as i32 as f32 / PARTS
    }

    /// Sine and cosine, accurate to [`maths::SIN_COS_ERROR`] plus rounding.
    pub fn sin_cos(self) -> (f32, f32) {
        // From the magnitude, so that the negative angle gives exactly the negative sine.
        let size = (self.0 as i32).unsigned_abs();
        let quadrant = (size + (1 << 29)) >> 30;
        let rest = size.wrapping_sub(quadrant << 30) as i32;
        let (sin, cos) = maths::sin_cos(rest as f32 * (core::f32::consts::TAU / PARTS));
        let (sin, cos) = match quadrant {
            0 => (sin, cos),
            1 => (cos, -sin),
            _ => (-sin, -cos),
        };
        if (self.0 as i32) < 0 { (-sin, cos) } else { (sin, cos) }
    }
}
