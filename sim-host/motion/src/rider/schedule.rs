//! Gain schedule: gains as functions of forward speed.

use super::{Gains, KEYS, ScheduleError};
use crate::range::within;

/// Behaviour outside the speeds at which the gains were measured.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Outside {
    /// The outermost straight lines are extrapolated, as published.
    #[default]
    Extrapolate,
    /// The outermost gains are held.
    Hold,
}

/// Gains over speed: linear interpolation between points. A linear regression is a schedule of two points.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    points: Vec<(f64, Gains)>,
    outside: Outside,
}

impl Schedule {
    /// A schedule through `points`: increasing speeds \[m/s\], at least one; a single point gives constant
    /// gains.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn new(points: Vec<(f64, Gains)>, outside: Outside) -> Result<Self, ScheduleError> {
        within("number of gain sets", points.len() as f64, 1.0, 1000.0)?;
        for (speed, gains) in &points {
            within("speed (m/s)", *speed, 0.0, 30.0)?;
            for (key, gain) in KEYS.iter().zip(gains.0) {
                within(&format!("{key} at {speed} m/s"), gain, -1e5, 1e5)?;
            }
        }
        if let Some(w) = points.windows(2).find(|w| w[1].0 - w[0].0 < 1e-3) {
            return Err(ScheduleError::Order { speed_m_s: w[1].0, before_m_s: w[0].0 });
        }
        Ok(Self { points, outside })
    }

    /// The same gains at every speed.
    pub fn constant(gains: Gains) -> Self {
        Self { points: vec![(0.0, gains)], outside: Outside::Hold }
    }

    /// The points.
    pub fn points(&self) -> &[(f64, Gains)] {
        &self.points
    }

    /// Behaviour outside the points.
    pub fn outside(&self) -> Outside {
        self.outside
    }

    /// The gains at `speed` \[m/s\].
    #[inline]
    pub fn at(&self, speed: f64) -> Gains {
        let p = &self.points;
        let last = p.len() - 1;
        if last == 0 {
            return p[0].1;
        }
        let right = 1 + p[1..last].partition_point(|point| point.0 <= speed);
        let ((v0, k0), (v1, k1)) = (&p[right - 1], &p[right]);
        let speed = match self.outside {
            Outside::Extrapolate => speed,
            Outside::Hold => speed.clamp(p[0].0, p[last].0),
        };
        k0.toward(k1, (speed - v0) / (v1 - v0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gains(x: f64) -> Gains {
        Gains([x; 10])
    }

    #[test]
    fn lines_between_points_go_on_or_stop() {
        let points = vec![(2.0, gains(1.0)), (4.0, gains(2.0)), (5.0, gains(0.0))];
        let of = |outside| Schedule::new(points.clone(), outside).unwrap();
        let (on, stop) = (of(Outside::Extrapolate), of(Outside::Hold));
        for (v, expected, held) in
            [(1.0, 0.5, 1.0), (2.0, 1.0, 1.0), (3.0, 1.5, 1.5), (4.5, 1.0, 1.0), (6.0, -2.0, 0.0)]
        {
            assert_eq!(on.at(v), gains(expected), "{v}");
            assert_eq!(stop.at(v), gains(held), "{v}");
        }
    }

    #[test]
    fn one_point_is_constant() {
        assert_eq!(Schedule::constant(gains(3.0)).at(9.0), gains(3.0));
    }

    #[test]
    fn speeds_must_rise() {
        let falling = vec![(4.0, gains(1.0)), (2.0, gains(1.0))];
        assert!(Schedule::new(falling, Outside::Hold).is_err());
        assert!(Schedule::new(vec![], Outside::Hold).is_err());
        assert!(Schedule::new(vec![(2.0, gains(f64::NAN))], Outside::Hold).is_err());
    }
}
