//! A finished sweep: the plan and what was found in every cell.

use super::{Folder, Plan, SweepError, Unit};
use crate::basin::{Bound, area};

/// The cells of a sweep, those that are not done missing.
#[derive(Clone, Debug)]
pub struct Grid {
    /// What was asked for.
    pub plan: Plan,
    /// What was found, in the plan's order.
    pub units: Vec<Option<Unit>>,
}

impl Grid {
    /// Gathers what `folders` hold of `plan`, each unit from the first that has it whole.
    ///
    /// # Errors
    /// When a unit is damaged wherever it is, or can't be read.
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

    /// How many cells are missing.
    pub fn missing(&self) -> usize {
        self.units.iter().filter(|u| u.is_none()).count()
    }

    /// Area of a cell's basin by the trapezoidal rule \[rad m/s^2\].
    pub fn area(&self, unit: &Unit) -> f64 {
        let heights = unit.found.iter().map(|f| f.height);
        area(&self.plan.search.speeds.iter().copied().zip(heights).collect::<Vec<_>>())
    }

    /// Whether there is a single speed, under whose heights is no area.
    pub fn one_speed(&self) -> bool {
        self.plan.search.speeds.len() < 2
    }

    /// What cells are compared by: the area \[rad m/s^2\], or the height \[rad/s\] at a single speed; and how it
    /// lies to the true one.
    pub fn measure(&self, unit: &Unit) -> (f64, Bound) {
        let measure = if self.one_speed() { unit.mean_height() } else { self.area(unit) };
        (measure, Bound::of(unit.capped()))
    }

    /// Its measures, cell by cell.
    pub fn measures(&self) -> Vec<Option<(f64, Bound)>> {
        self.units.iter().map(|u| u.as_ref().map(|u| self.measure(u))).collect()
    }
}

impl Unit {
    /// Whether some height is a lower bound, and with it the area and the mean.
    pub fn capped(&self) -> bool {
        self.found.iter().any(|f| f.capped)
    }

    /// Mean height over the speeds \[rad/s\].
    pub fn mean_height(&self) -> f64 {
        self.found.iter().map(|f| f.height).sum::<f64>() / self.found.len().max(1) as f64
    }

    /// The largest torque \[N m\] and change of torque \[N m/s\] of the rides at the border.
    pub fn most(&self) -> (f64, f64) {
        let efforts = self.found.iter().filter_map(|f| f.effort);
        efforts
            .fold((0.0, 0.0), |(torque, slew), e| (e.peak_torque_nm.max(torque), e.peak_slew_nm_s.max(slew)))
    }
}
