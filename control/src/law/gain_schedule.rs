//! A user's gain schedule: straight lines between points.

use crate::law::real::Real;
use crate::param::{ParamError, ParamSpec, ParamVisitor};
use heapless::Vec;

/// Most points a user's gain table may have.
pub const TABLE_POINTS: usize = 32;

const POINTS: ParamSpec = ParamSpec::new("", "law.table.points", 1.0, TABLE_POINTS as f32);
const SPEED: ParamSpec = ParamSpec::new("", "law.table.speed_m_s", -30.0, 30.0);
const GAIN: ParamSpec = ParamSpec::new("", "law.table.gain_nm_s_rad", -200.0, 200.0);
/// Least distance of two speeds \[m/s\].
const APART_M_S: f32 = 1e-3;

/// A user's gain schedule: speeds \[m/s\] strictly rising, gain \[N m s/rad\], linear between the
/// points and constant outside them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GainSchedule {
    points: Vec<(f32, f32), TABLE_POINTS>,
}

impl GainSchedule {
    /// Builds a table from `(speed_m_s, gain_nm_s_rad)` points.
    ///
    /// # Errors
    /// Names the first offending value: no point or more than [`TABLE_POINTS`], a speed outside
    /// -30..=30 m/s, a gain beyond 200 N m s/rad either way, a speed not at least 0.001 m/s above the one before it.
    pub fn new(points: &[(f32, f32)]) -> Result<Self, ParamError> {
        POINTS.check(points.len() as f32)?;
        let mut table = Self::default();
        for &point in points {
            // The length was checked above, so the push always succeeds.
            let _ = table.points.push(point);
        }
        table.validate()?;
        Ok(table)
    }

    /// The points, `(speed_m_s, gain_nm_s_rad)`, speeds rising.
    pub fn points(&self) -> &[(f32, f32)] {
        &self.points
    }

    /// Shows how many points there are, then speed and gain of each.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let mut count = self.points.len() as u16;
        to.count(&POINTS, &mut count);
        // More than there is room for leave the table as it was.
        let _ = self.points.resize(usize::from(count), (0.0, 0.0));
        for (speed, gain) in &mut self.points {
            to.number(&SPEED, speed);
            to.number(&GAIN, gain);
        }
    }

    /// Checks every point, and that speeds rise.
    ///
    /// # Errors
    /// As of [`GainSchedule::new`].
    pub fn validate(&self) -> Result<(), ParamError> {
        POINTS.check(self.points.len() as f32)?;
        let mut floor = SPEED.min;
        for &(speed, gain) in &self.points {
            ParamSpec { min: floor, ..SPEED }.check(speed)?;
            GAIN.check(gain)?;
            floor = speed + APART_M_S;
        }
        Ok(())
    }

    /// The gain at a forward speed \[m/s\]; 0 without a point.
    pub fn gain<R: Real>(&self, speed_m_s: R) -> R {
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
