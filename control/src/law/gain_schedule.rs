//! A user-defined gain schedule, linear between its points.

use crate::law::real::Real;
use crate::param::{ParamError, ParamSpec};
use heapless::Vec;

/// Largest number of points of a gain table.
pub const TABLE_POINTS: usize = 32;

const POINTS: ParamSpec = ParamSpec::new("", "law.table.points", 1.0, TABLE_POINTS as f32);
const SPEED: ParamSpec = ParamSpec::new("", "law.table.speed_m_s", -30.0, 30.0);
const GAIN: ParamSpec = ParamSpec::new("", "law.table.gain_nm_s_rad", -200.0, 200.0);
/// Smallest difference of two speeds \[m/s\].
const MIN_SPACING_M_S: f32 = 1e-3;

/// A user-defined gain schedule: speeds \[m/s\] strictly rising, gain \[N m s/rad\], linear between the points and
/// constant outside them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GainSchedule {
    points: Vec<(f32, f32), TABLE_POINTS>,
}

impl GainSchedule {
    /// Builds a table from `(speed_m_s, gain_nm_s_rad)` points.
    ///
    /// # Errors
    /// The first invalid value: no point or more than [`TABLE_POINTS`], a speed outside -30..=30 m/s, a gain beyond 200
    /// N m s/rad either way, or a speed less than 0.001 m/s above the previous one.
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

    /// The points, `(speed_m_s, gain_nm_s_rad)`, by rising speed.
    pub fn points(&self) -> &[(f32, f32)] {
        &self.points
    }

    /// Checks every point, and that speeds rise.
    ///
    /// # Errors
    /// See [`GainSchedule::new`].
    pub fn validate(&self) -> Result<(), ParamError> {
        POINTS.check(self.points.len() as f32)?;
        let mut min_speed = SPEED.min;
        for &(speed, gain) in &self.points {
            ParamSpec { min: min_speed, ..SPEED }.check(speed)?;
            GAIN.check(gain)?;
            min_speed = speed + MIN_SPACING_M_S;
        }
        Ok(())
    }

    /// The gain at a forward speed \[m/s\]; 0 without points.
    pub fn gain<R: Real + PartialOrd>(&self, speed_m_s: R) -> R {
        let mut previous: Option<(R, R)> = None;
        for &(v, k) in &self.points {
            let (v, k) = (R::lit(f64::from(v)), R::lit(f64::from(k)));
            if speed_m_s <= v {
                return match previous {
                    Some((v0, k0)) => k0 + (k - k0) * ((speed_m_s - v0) / (v - v0)),
                    None => k,
                };
            }
            previous = Some((v, k));
        }
        previous.map_or(R::lit(0.0), |(_, k)| k)
    }
}
