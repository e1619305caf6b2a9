//! Roll-rate laws: the gain in `T = +gain(v) * roll_rate`, steering into the fall.
//!
//! The sources print the feedback gain `K_phi_d(v)` of the Basu-Mandal axes, where steering into
//! the fall is a negative gain; `gain = -K_phi_d` here, converted once, in this file.

use crate::param::{Leaf, ParamError, check};
use crate::real::Real;
use heapless::Vec;

/// Most points a user's gain table may have.
pub const TABLE_POINTS: usize = 32;

/// A user's gain schedule: speeds \[m/s\] strictly rising, gain \[N m s/rad\], linear between the
/// points and constant outside them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LawTable {
    points: Vec<(f32, f32), TABLE_POINTS>,
}

impl LawTable {
    /// Builds a table from `(speed_m_s, gain_nm_s_rad)` points.
    ///
    /// # Errors
    /// Names the first offending value: no point or more than [`TABLE_POINTS`], a speed outside
    /// -30..=30 m/s, a gain beyond 200 N m s/rad either way, a speed not at least 0.001 m/s above the one before it.
    pub fn new(points: &[(f32, f32)]) -> Result<Self, ParamError> {
        check("law.table.points", points.len() as f32, 1.0, TABLE_POINTS as f32)?;
        let mut table = Self::default();
        let mut floor = -30.0;
        for &(speed, gain) in points {
            check("law.table.speed_m_s", speed, floor, 30.0)?;
            check("law.table.gain_nm_s_rad", gain, -200.0, 200.0)?;
            // The length was checked above, so the push always succeeds.
            let _ = table.points.push((speed, gain));
            floor = speed + 1e-3;
        }
        Ok(table)
    }

    /// The points, `(speed_m_s, gain_nm_s_rad)`, speeds rising.
    pub fn points(&self) -> &[(f32, f32)] {
        &self.points
    }

    fn gain<R: Real>(&self, speed_m_s: R) -> R {
        let mut before: Option<(R, R)> = None;
        for &(v, k) in &self.points {
            let (v, k) = (R::lit(f64::from(v)), R::lit(f64::from(k)));
            if speed_m_s <= v {
                return match before {
                    Some((v0, k0)) => k0 + (k - k0) * ((speed_m_s - v0) / (v - v0)),
                    None => k,
                };
            }
            before = Some((v, k));
        }
        before.map_or(R::lit(0.0), |(_, k)| k)
    }
}

/// A roll-rate law. Gains in N m s/rad, speeds in m/s. Formulas are the sources' `K_phi_d`; the gain is
/// minus that, except where a gain is said.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "no allocator to box the table with")]
pub enum Law {
    /// No assist.
    None,
    /// `h(v) = (4 v - 30) exp(-0.03 v^2)` (Kuipers 2020, eq. 3.13): the thesis's choice. Its gain
    /// changes sign at 7.5 m/s and steers out of the fall above; `cut` makes it zero there.
    H {
        /// Zero above 7.5 m/s, as the thesis suggests.
        cut: bool,
    },
    /// `f(v) = -0.88 v^2 + 12 v - 41` (eq. 3.11).
    F,
    /// `g(v) = (v - 40) exp(-0.35 v)` (eq. 3.12).
    G,
    /// Gain `5.97 (6.7 - v)` below 6.7 m/s, zero above (eqs 3.6-3.7).
    Cl1,
    /// Gain `k (10 - v)` below 10 m/s, zero above (section 3.4.2), k > 0 in N s^2/rad.
    Cl2 {
        /// Slope of the gain over speed \[N s^2/rad\], 0.001..=20.
        k: f32,
    },
    /// A user's table.
    Table(LawTable),
}

impl Law {
    /// The gain at a forward speed \[m/s\], positive where the law steers into the fall.
    ///
    /// Finite for every speed within +-30 m/s, the range [`crate::input`] lets through.
    #[inline]
    pub fn gain<R: Real>(&self, speed_m_s: R) -> R {
        let v = speed_m_s;
        let zero = R::lit(0.0);
        match self {
            Law::None => zero,
            Law::H { cut } => {
                if *cut && v >= R::lit(7.5) {
                    zero
                } else {
                    (R::lit(30.0) - R::lit(4.0) * v) * (R::lit(-0.03) * v * v).exp()
                }
            }
            Law::F => R::lit(0.88) * v * v - R::lit(12.0) * v + R::lit(41.0),
            Law::G => (R::lit(40.0) - v) * (R::lit(-0.35) * v).exp(),
            Law::Cl1 if v < R::lit(6.7) => R::lit(5.97) * (R::lit(6.7) - v),
            Law::Cl2 { k } if v < R::lit(10.0) => R::lit(f64::from(*k)) * (R::lit(10.0) - v),
            Law::Cl1 | Law::Cl2 { .. } => zero,
            Law::Table(table) => table.gain(v),
        }
    }

    /// Checks the law's own parameters.
    ///
    /// # Errors
    /// The parameter, its value and the allowed range.
    pub fn validate(&self) -> Result<(), ParamError> {
        match self {
            Law::Cl2 { k } => check("law.cl2.k", *k, 1e-3, 20.0),
            Law::Table(t) if t.points.is_empty() => {
                Err(Leaf::new("", "law.table.points", 1.0, TABLE_POINTS as f32).error(0.0))
            }
            _ => Ok(()),
        }
    }
}
