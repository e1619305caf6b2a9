//! A gain schedule as variables of the search: linear interpolation between knots over speed.

use crate::range::{RangeError, within};
use control::{GainSchedule, Law, ParamError};

/// Allowed gains \[N m s/rad\]: the upper is the thesis's limit for a motor (section 2.4.3).
pub const GAINS: (f64, f64) = (-10.0, 40.0);
/// Speed range of the design \[m/s\].
const SPAN_M_S: (f64, f64) = (2.0, 7.5);
/// Range above the last knot over which the gain fades to zero \[m/s\]: the schedule was not evaluated there.
const FADE_M_S: f64 = 1.0;

/// Speeds of the knots \[m/s\], increasing.
#[derive(Clone, Debug, PartialEq)]
pub struct Knots(Vec<f64>);

impl Knots {
    /// `count` knots evenly spaced over the speed range of the design.
    ///
    /// # Errors
    /// Fewer than 2 or more than 8 knots.
    pub fn new(count: usize) -> Result<Self, RangeError> {
        within("number of knots", count as f64, 2.0, 8.0)?;
        let (from, to) = SPAN_M_S;
        let step = (to - from) / (count - 1) as f64;
        Ok(Self((0..count).map(|i| ((from + i as f64 * step) * 1e6).round() / 1e6).collect()))
    }

    /// The speeds \[m/s\].
    pub fn speeds(&self) -> &[f64] {
        &self.0
    }

    /// The law with `gains` at the knots, constant below the first, zero from 1 m/s above the last.
    ///
    /// # Errors
    /// A gain is outside the table's range.
    pub fn law(&self, gains: &[f64]) -> Result<Law, ParamError> {
        let mut points: Vec<(f32, f32)> =
            self.0.iter().zip(gains).map(|(v, gain)| (*v as f32, *gain as f32)).collect();
        points.extend(self.0.last().map(|v| ((v + FADE_M_S) as f32, 0.0)));
        GainSchedule::new(&points).map(Law::Table)
    }

    /// The gains of another law at the knots, inside [`GAINS`].
    pub fn gains_of(&self, law: &Law) -> Vec<f64> {
        self.0.iter().map(|v| law.gain(*v).clamp(GAINS.0, GAINS.1)).collect()
    }
}

/// Roughness of gains: mean square of their second differences \[(N m s/rad)^2\].
pub(super) fn roughness(gains: &[f64]) -> f64 {
    let bends: Vec<f64> = gains.windows(3).map(|g| (g[0] - 2.0 * g[1] + g[2]).powi(2)).collect();
    if bends.is_empty() { 0.0 } else { bends.iter().sum::<f64>() / bends.len() as f64 }
}
