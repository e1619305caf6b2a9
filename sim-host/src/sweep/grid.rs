//! A sweep's results: the plan and the result of every cell.

use super::{Folder, Plan, SweepError, Unit};
use crate::basin::{Bound, area};

/// The cells of a sweep; unfinished ones are missing.
#[derive(Clone, Debug)]
pub struct Grid {
    /// The plan.
    pub plan: Plan,
    /// Results in the plan's order.
    pub units: Vec<Option<Unit>>,
}

impl Grid {
    /// Collects the results of `plan` from `folders`; each unit from the first folder with an undamaged file.
    ///
    /// # Errors
    /// A unit is damaged in every folder that has it, or can't be read.
    pub fn gather(plan: &Plan, folders: &[Folder]) -> Result<Self, SweepError> {
        let find = |id: &String| {
            let mut damaged = None;
            for folder in folders {
                match folder.unit(id) {
                    Ok(Some(unit)) => return Ok(Some(unit)),
                    Ok(None) => {}
                    Err(e) => damaged = Some(e),
                }
            }
            damaged.map_or(Ok(None), Err)
        };
        Ok(Self { plan: plan.clone(), units: plan.cells.iter().map(find).collect::<Result<_, _>>()? })
    }

    /// Number of missing cells.
    pub fn missing(&self) -> usize {
        self.units.iter().filter(|u| u.is_none()).count()
    }

    /// Area of a cell's basin by the trapezoidal rule \[rad m/s^2\]; none at a single speed.
    pub fn area(&self, unit: &Unit) -> Option<f64> {
        let heights = unit.found.iter().map(|f| f.height);
        let outline: Vec<_> = self.plan.search.speeds.iter().copied().zip(heights).collect();
        (!self.one_speed()).then(|| area(&outline))
    }

    /// Whether the sweep has a single speed, and so no area.
    pub fn one_speed(&self) -> bool {
        self.plan.search.speeds.len() < 2
    }

    /// The measure by which cells are compared: area \[rad m/s^2\], or height \[rad/s\] at a single speed;
    /// and its relation to the true one.
    pub fn measure(&self, unit: &Unit) -> (f64, Bound) {
        let measure = self.area(unit).unwrap_or_else(|| unit.mean_height());
        (measure, Bound::of(unit.capped()))
    }

    /// The measure of every cell.
    pub fn measures(&self) -> Vec<Option<(f64, Bound)>> {
        self.units.iter().map(|u| u.as_ref().map(|u| self.measure(u))).collect()
    }
}

impl Unit {
    /// Whether any height is a lower bound, and so the area and the mean.
    pub fn capped(&self) -> bool {
        self.found.iter().any(|f| f.capped)
    }

    /// Mean height over the speeds \[rad/s\].
    pub fn mean_height(&self) -> f64 {
        self.found.iter().map(|f| f.height).sum::<f64>() / self.found.len().max(1) as f64
    }

    /// Largest torque \[N m\] and largest change of torque \[N m/s\] of the rides at the borders.
    pub fn most(&self) -> (f64, f64) {
        let efforts = self.found.iter().filter_map(|f| f.effort);
        efforts
            .fold((0.0, 0.0), |(torque, slew), e| (e.peak_torque_nm.max(torque), e.peak_slew_nm_s.max(slew)))
    }
}
