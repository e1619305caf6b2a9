//! Capsize term: steers into the lean at high speed, where the unstable mode is capsize, a slow fall without
//! oscillation.
//!
//! The thesis gives the torque as `-K_c (v - v_max) phi` above `v_max` (Kuipers 2020, eq. 2.16, after Schwab, Kooijman
//! and Meijaard 2008), in axes whose steer torque is opposite to the benchmark's. The minus sign is removed here. A
//! lean to the right gives a torque to the right.

use crate::law::real::Real;
use crate::param::{ParamError, ParamSpec, ParamVisitor};

const K_C: ParamSpec = ParamSpec::new("capsize", "k_c", 0.0, 20.0);
const V_MAX: ParamSpec = ParamSpec::new("capsize", "v_max_m_s", 0.0, 30.0);

/// The capsize term, added to any roll-rate law. Off by default. The steer-by-wire bicycle of TU Delft uses 0.7 and 6.5
/// (mechmotum/sbw_bicycle_with_model_matching).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsize {
    /// Roll-angle gain per speed above `v_max_m_s` \[N s/rad\], 0..=20; 0 is off.
    pub k_c: f32,
    /// Speed up to which there is no torque \[m/s\], 0..=30.
    pub v_max_m_s: f32,
}

impl Default for Capsize {
    fn default() -> Self {
        Self { k_c: 0.0, v_max_m_s: 6.5 }
    }
}

impl Capsize {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&K_C, &mut self.k_c);
        to.number(&V_MAX, &mut self.v_max_m_s);
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// The parameter, its value and the allowed range.
    pub fn validate(&self) -> Result<(), ParamError> {
        K_C.check(self.k_c)?;
        V_MAX.check(self.v_max_m_s)
    }

    /// Whether the term is on.
    pub fn is_on(&self) -> bool {
        self.k_c > 0.0
    }

    /// The gain of the roll angle \[N m/rad\], never negative. It never falls with speed, so of uncertain speeds the
    /// lowest gives the smallest gain.
    pub fn gain<R: Real + PartialOrd>(&self, speed_m_s: R) -> R {
        let above = speed_m_s - R::lit(f64::from(self.v_max_m_s));
        if above > R::lit(0.0) { R::lit(f64::from(self.k_c)) * above } else { R::lit(0.0) }
    }

    /// Steer torque, positive to the right \[N m\], at a forward speed \[m/s\] and roll angle, positive to the right
    /// \[rad\].
    pub fn torque(&self, speed_m_s: f32, roll_rad: f32) -> f32 {
        self.gain(speed_m_s) * roll_rad
    }
}
