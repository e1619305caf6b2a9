//! Angles as whole numbers, 2^32 to the turn: they wrap by themselves, and no turn is ever lost to rounding.

use control::maths;

/// An angle within one turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Angle(pub u32);

/// Parts of a turn.
const PARTS: f32 = 4_294_967_296.0;

impl Angle {
    /// A quarter turn.
    pub const QUARTER: Angle = Angle(1 << 30);

    /// Of a part of a turn; what is beyond a half either way counts as a half, NaN as 0.
    pub fn of(turns: f32) -> Self {
        Angle((turns * PARTS) as i32 as u32)
    }

    /// This angle and another.
    pub fn plus(self, other: Angle) -> Self {
        Angle(self.0.wrapping_add(other.0))
    }

    /// This angle less another.
    pub fn minus(self, other: Angle) -> Self {
        Angle(self.0.wrapping_sub(other.0))
    }

    /// The angle the other way round.
    pub fn mirrored(self) -> Self {
        Angle(self.0.wrapping_neg())
    }

    /// So many times the angle: the electrical angle of a mechanical one, by the pole pairs.
    pub fn times(self, n: u16) -> Self {
        Angle(self.0.wrapping_mul(u32::from(n)))
    }

    /// As a part of a turn, the short way round: -0.5 to 0.5.
    pub fn signed(self) -> f32 {
        self.0 as i32 as f32 / PARTS
    }

    /// Sine and cosine, to [`maths::SIN_COS_ERROR`] and a rounding.
    pub fn sin_cos(self) -> (f32, f32) {
        // By the size of the angle, so that the mirrored angle gives the mirrored sine to the bit.
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
