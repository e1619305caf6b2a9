//! What a basin search finds.

use crate::ride::{FallCause, Outcome, Ride};

/// The ride from one point of the scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanPoint {
    /// Disturbance \[rad/s\].
    pub rate: f64,
    /// What became of it.
    pub outcome: Outcome,
}

/// A range of disturbances beyond the first fall from which the bicycle does not fall \[rad/s\].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Island {
    /// Least disturbance seen not to fall.
    pub from: f64,
    /// Largest disturbance seen not to fall.
    pub to: f64,
}

/// How much was computed.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
pub struct Work {
    /// Rides.
    pub rides: u64,
    /// Control periods ridden.
    pub steps: u64,
    /// Right-hand sides of the equations of motion: four a control period. Those of the shorter steps
    /// in which falls end are not counted.
    pub right_hand_sides: u64,
}

impl Work {
    /// Books finished rides.
    pub fn add(&mut self, rides: &[Ride]) {
        let steps: u64 = rides.iter().map(|r| u64::from(r.steps)).sum();
        self.rides += rides.len() as u64;
        self.steps += steps;
        self.right_hand_sides += 4 * steps;
    }

    /// The sum of both.
    pub fn plus(self, other: &Work) -> Work {
        Work {
            rides: self.rides + other.rides,
            steps: self.steps + other.steps,
            right_hand_sides: self.right_hand_sides + other.right_hand_sides,
        }
    }
}

/// The basin at one forward speed. Disturbances are to the right; to the left everything mirrors.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// Largest disturbance seen not to fall of the interval that contains zero \[rad/s\].
    pub upper: f64,
    /// Whether nothing fell up to the largest disturbance tried.
    pub capped: bool,
    /// What lies beyond.
    pub islands: Vec<Island>,
    /// The scan, disturbances rising.
    pub scan: Vec<ScanPoint>,
    /// The ride at `upper`, unless `upper` is 0.
    pub border: Option<Ride>,
    /// What made the nearest ride beyond `upper` count as fallen; `None` if nothing fell.
    pub beyond: Option<FallCause>,
    /// What it took.
    pub work: Work,
}

/// A basin over speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Basin {
    /// The columns that were computed, speeds rising. Fewer than asked for after an interruption.
    pub columns: Vec<Column>,
}

impl Basin {
    /// Area between zero and `upper` by the trapezoidal rule \[rad/s m/s\]; the published areas are
    /// of this upper half. 0 for fewer than two speeds.
    pub fn area(&self) -> f64 {
        area(&self.outline())
    }

    /// The outline: speed \[m/s\] and height \[rad/s\].
    pub fn outline(&self) -> Vec<(f64, f64)> {
        self.columns.iter().map(|c| (c.speed, c.upper)).collect()
    }

    /// Mean of `upper` over the speeds \[rad/s\]; `None` without a column.
    pub fn mean_height(&self) -> Option<f64> {
        let n = self.columns.len();
        (n > 0).then(|| self.columns.iter().map(|c| c.upper).sum::<f64>() / n as f64)
    }

    /// How many rides of the scan counted as fallen for `cause`.
    pub fn falls(&self, cause: FallCause) -> usize {
        let scans = self.columns.iter().flat_map(|c| &c.scan);
        scans.filter(|p| p.outcome.fall() == Some(cause)).count()
    }

    /// What it took.
    pub fn work(&self) -> Work {
        self.columns.iter().fold(Work::default(), |sum, c| sum.plus(&c.work))
    }
}

/// Area under an outline by the trapezoidal rule \[rad m/s^2\].
pub fn area(outline: &[(f64, f64)]) -> f64 {
    let strips = outline.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0));
    // The sum of nothing is minus zero.
    strips.sum::<f64>() + 0.0
}
