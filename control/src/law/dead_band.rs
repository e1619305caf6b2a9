//! Dead band of the roll rate: the roll-rate law gives no torque for small roll rates.
//!
//! The law receives the part of the roll rate outside the band, `p - clamp(p, -R, R)`, so that
//! `T = gain(v) * (p - clamp(p, -R, R))`. The torque is continuous: it starts from zero at the edge of the band, and its
//! slope outside is that of the law. A dead band that passes the whole roll rate outside would change the torque by
//! `gain * R` at once (0.9 N m for `h` at 4 m/s and 0.1 rad/s).

use crate::law::real::Real;
use crate::param::{ParamSpec, ParamVisitor};

const ROLL_RATE: ParamSpec = ParamSpec::new("dead_band", "roll_rate_rad_s", 0.0, 1.0);

/// The dead band, in front of any roll-rate law. Off by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeadBand {
    /// Largest roll rate without torque, either way \[rad/s\], 0..=1; 0 is off.
    pub roll_rate_rad_s: f32,
}

impl DeadBand {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ROLL_RATE, &mut self.roll_rate_rad_s);
    }

    /// Whether the dead band is on.
    pub fn is_on(&self) -> bool {
        self.roll_rate_rad_s > 0.0
    }

    /// The part of a roll rate outside the band, with the sign of the roll rate \[rad/s\]; the same bits if the band is
    /// off.
    #[inline]
    pub fn excess<R: Real + PartialOrd>(&self, roll_rate_rad_s: R) -> R {
        if !self.is_on() {
            return roll_rate_rad_s;
        }
        let edge = R::lit(f64::from(self.roll_rate_rad_s));
        if roll_rate_rad_s > edge {
            roll_rate_rad_s - edge
        } else if roll_rate_rad_s < -edge {
            roll_rate_rad_s + edge
        } else {
            R::lit(0.0)
        }
    }
}
