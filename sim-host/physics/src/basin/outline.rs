//! Results of a basin search.

use crate::ride::{FallCause, Outcome, Ride};

/// Result of one point of the scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanPoint {
    /// Disturbance \[rad/s\].
    pub rate: f64,
    /// Outcome of the ride.
    pub outcome: Outcome,
}

/// Island: an interval of disturbances beyond the first fall in which rides do not fall \[rad/s\].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Island {
    /// Smallest disturbance found not to fall.
    pub from: f64,
    /// Largest disturbance found not to fall.
    pub to: f64,
}

/// Computing effort.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
pub struct Work {
    /// Rides.
    pub rides: u64,
    /// Time steps simulated: control periods of exact rides, longer steps of others.
    pub steps: u64,
    /// Right-hand sides of the equations of motion evaluated: four per step. Those of substeps
    /// before falls are not counted.
    pub right_hand_sides: u64,
}

impl Work {
    /// Adds finished rides.
    pub fn add(&mut self, rides: &[Ride]) {
        let steps: u64 = rides.iter().map(|r| u64::from(r.steps)).sum();
        self.rides += rides.len() as u64;
        self.steps += steps;
        self.right_hand_sides += 4 * steps;
    }

    /// Adds a ride of `steps` steps of another length.
    pub(super) fn add_steps(&mut self, steps: u32) {
        self.rides += 1;
        self.steps += u64::from(steps);
        self.right_hand_sides += 4 * u64::from(steps);
    }

    /// Sum of both.
    pub fn plus(self, other: &Work) -> Work {
        Work {
            rides: self.rides + other.rides,
            steps: self.steps + other.steps,
            right_hand_sides: self.right_hand_sides + other.right_hand_sides,
        }
    }
}

/// The basin at one forward speed. Disturbances are to the right; those to the left are the mirror image.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// Height: largest disturbance found not to fall in the interval that contains zero \[rad/s\].
    pub upper: f64,
    /// Whether no ride fell up to the largest disturbance tried.
    pub capped: bool,
    /// Islands beyond it.
    pub islands: Vec<Island>,
    /// The scan, in order of increasing disturbance.
    pub scan: Vec<ScanPoint>,
    /// Outcome of the ride at `upper`, unless `upper` is 0.
    pub outcome: Option<Outcome>,
    /// That ride, if [`super::Search::efforts`].
    pub border: Option<Ride>,
    /// Cause of the fall of the nearest ride beyond `upper`; `None` if none fell.
    pub beyond: Option<FallCause>,
    /// Computing effort.
    pub work: Work,
}

/// A basin over speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Basin {
    /// The computed columns, in order of increasing speed. Incomplete after an interruption.
    pub columns: Vec<Column>,
}

impl Basin {
    /// Area between zero and `upper` by the trapezoidal rule \[rad/s m/s\]. The published areas are of this
    /// upper half. 0 for fewer than two speeds.
    pub fn area(&self) -> f64 {
        area(&self.outline())
    }

    /// [`Self::area`]; `None` for fewer than two speeds, where there is none.
    pub fn enclosed_area(&self) -> Option<f64> {
        (self.columns.len() > 1).then(|| self.area())
    }

    /// The outline: speed \[m/s\] and height \[rad/s\].
    pub fn outline(&self) -> Vec<(f64, f64)> {
        self.columns.iter().map(|c| (c.speed, c.upper)).collect()
    }

    /// Mean of `upper` over the speeds \[rad/s\], at unequal steps weighted by the width of the columns; `None` without a
    /// column.
    pub fn mean_height(&self) -> Option<f64> {
        let weights = weights(&self.columns.iter().map(|c| c.speed).collect::<Vec<_>>());
        let weighted = self.columns.iter().zip(&weights).map(|(c, weight)| weight * c.upper);
        (!self.columns.is_empty()).then(|| weighted.sum::<f64>() / weights.iter().sum::<f64>())
    }

    /// Number of rides of the scan that fell by `cause`.
    pub fn falls(&self, cause: FallCause) -> usize {
        let scans = self.columns.iter().flat_map(|c| &c.scan);
        scans.filter(|p| p.outcome.fall() == Some(cause)).count()
    }

    /// Computing effort.
    pub fn work(&self) -> Work {
        self.columns.iter().fold(Work::default(), |sum, c| sum.plus(&c.work))
    }
}

/// Area under an outline by the trapezoidal rule \[rad m/s^2\].
pub fn area(outline: &[(f64, f64)]) -> f64 {
    let strips = outline.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0));
    // The sum of an empty iterator is minus zero.
    strips.sum::<f64>() + 0.0
}

/// Largest difference of steps that count as equal \[m/s\]: speeds of a range are rounded to 1e-9.
const EQUAL: f64 = 1e-8;

/// Weights of increasing speeds in a mean: 1 at equal steps, else half the distance between the neighbours \[m/s\], an outer
/// speed reaching as far outwards as inwards.
pub(super) fn weights(speeds: &[f64]) -> Vec<f64> {
    let steps: Vec<f64> = speeds.windows(2).map(|w| w[1] - w[0]).collect();
    if steps.iter().all(|step| (step - steps[0]).abs() <= EQUAL) {
        return vec![1.0; speeds.len()];
    }
    let last = steps.len() - 1;
    (0..speeds.len()).map(|i| 0.5 * (steps[i.saturating_sub(1)] + steps[i.min(last)])).collect()
}
