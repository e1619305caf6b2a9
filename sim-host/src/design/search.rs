//! Maximises the smallest basin area over gain schedules: Nelder and Mead's simplex method, restarted around
//! the best schedule until the evaluations are used up.

use super::knots::{GAINS, Knots, roughness};
use crate::basin::Search;
use crate::simplex::{self, Corner};
use crate::study::trial::{Least, Trial, TrialError, least_area};
use crate::sweep::SweepError;
use control::Law;
use control::param::ParamError;

/// Settings of a search.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The schedule's knots.
    pub knots: Knots,
    /// Law from which the search starts.
    pub start: Law,
    /// Basin search for the areas; coarse, as there are many.
    pub search: Search,
    /// Weight of roughness: area given up for smoothness \[rad m/s^2 per (N m s/rad)^2\]; see [`Knots`].
    pub smoothness: f64,
    /// Seed of the restarts.
    pub seed: u64,
    /// Largest number of schedules evaluated.
    pub evaluations: u32,
}

/// Progress of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Schedules evaluated.
    pub evaluations: u32,
    /// Best smallest area so far \[rad m/s^2\].
    pub best: f64,
}

/// Result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Gains at the knots \[N m s/rad\].
    pub gains: Vec<f64>,
    /// Smallest area over the trials \[rad m/s^2\], coarse.
    pub worst_area: f64,
    /// Whether it is a lower bound, as no ride fell up to the largest rate tried at some speed.
    pub worst_capped: bool,
    /// The same for the start law.
    pub start_area: f64,
    /// Whether that is a lower bound.
    pub start_capped: bool,
    /// Schedules evaluated.
    pub evaluations: u32,
    /// False if the search was stopped before its evaluations were used up.
    pub complete: bool,
    /// Each improvement: schedules evaluated, smallest area.
    pub history: Vec<(u32, f64)>,
}

/// A search that failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// A trial can't be simulated.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// A folder of an evaluation that can't be used.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// A gain is outside the range of a law.
    #[error(transparent)]
    Gain(#[from] ParamError),
}

/// Initial steps of the simplex at the start law \[N m s/rad\].
const FIRST_STEP: f64 = 4.0;
/// Smallest and largest initial steps of a restarted simplex \[N m s/rad\].
const STEPS: (f64, f64) = (1.0, 6.0);
/// Spread of areas below which a simplex is restarted \[rad m/s^2\].
const ALIKE: f64 = 0.02;
/// Penalty per N m s/rad beyond the allowed range of a gain \[rad m/s^2\].
const BEYOND: f64 = 1.0;

/// Searches for the schedule with the largest smallest area over `trials`. The same plan gives the same
/// result on every machine. `stop` ends the search early with the best so far; `None` if no schedule was
/// evaluated before.
///
/// # Errors
/// A trial can't be simulated.
pub fn optimise(
    trials: &[Trial],
    plan: &Plan,
    advanced: &dyn Fn(Progress),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Found>, DesignError> {
    let mut search =
        SearchState { trials, plan, advanced, stop, worst: 0, found: None, failed: None, ended: false };
    let mut random = SplitMix(plan.seed);
    let mut corner = plan.knots.gains_of(&plan.start);
    let mut steps = vec![FIRST_STEP; corner.len()];
    while !search.ended {
        // The best schedule of all simplexes is kept in `search`.
        let _ = simplex::search(first_simplex(&corner, &steps), |gains| search.cost(gains), alike);
        if let Some(found) = &search.found {
            corner.clone_from(&found.gains);
        }
        steps.iter_mut().for_each(|step| *step = random.step());
    }
    search.failed.map_or(Ok(search.found), Err)
}

/// Whether the standard deviation of the costs is below that of a simplex to be restarted.
fn alike(corners: &[Corner]) -> bool {
    let costs = || corners.iter().map(|corner| corner.1);
    let mean = costs().sum::<f64>() / corners.len() as f64;
    let squares: f64 = costs().map(|cost| (cost - mean).powi(2)).sum();
    (squares / (corners.len() - 1) as f64).sqrt() < ALIKE
}

/// A simplex of `corner` and one step along each axis, reversed if it would leave the range.
fn first_simplex(corner: &[f64], steps: &[f64]) -> Vec<Vec<f64>> {
    let mut simplex = vec![corner.to_vec()];
    for (i, step) in steps.iter().enumerate() {
        let mut other = corner.to_vec();
        let stepped = other[i] + step;
        other[i] = if (GAINS.0..=GAINS.1).contains(&stepped) { stepped } else { other[i] - step };
        simplex.push(other);
    }
    simplex
}

/// State of a search.
struct SearchState<'a> {
    trials: &'a [Trial],
    plan: &'a Plan,
    advanced: &'a dyn Fn(Progress),
    stop: &'a (dyn Fn() -> bool + Sync),
    /// Index of the trial with the smallest area for the last schedule.
    worst: usize,
    found: Option<Found>,
    failed: Option<DesignError>,
    ended: bool,
}

impl SearchState<'_> {
    /// Cost of a schedule, to be minimised; `None` when the search is over.
    fn cost(&mut self, requested: &[f64]) -> Option<f64> {
        let tried = self.found.as_ref().map_or(0, |found| found.evaluations);
        if tried >= self.plan.evaluations {
            self.end(true);
            return None;
        }
        let gains: Vec<f64> = requested.iter().map(|gain| gain.clamp(GAINS.0, GAINS.1)).collect();
        let beyond: f64 = requested.iter().zip(&gains).map(|(a, b)| (a - b).abs()).sum();
        let worst = match self.worst_area(&gains) {
            Ok(Some(worst)) => worst,
            Ok(None) => {
                self.end(false);
                return None;
            }
            Err(error) => {
                self.failed = Some(error);
                self.end(false);
                return None;
            }
        };
        let cost = |area: f64, gains: &[f64]| self.plan.smoothness * roughness(gains) - area;
        let Least { area: worst, capped, .. } = worst;
        let now = cost(worst, &gains);
        let found = self.found.get_or_insert_with(|| Found {
            gains: gains.clone(),
            worst_area: worst,
            worst_capped: capped,
            start_area: worst,
            start_capped: capped,
            evaluations: 0,
            complete: true,
            history: vec![(1, worst)],
        });
        found.evaluations += 1;
        if now < cost(found.worst_area, &found.gains) {
            (found.gains, found.worst_area, found.worst_capped) = (gains, worst, capped);
            found.history.push((found.evaluations, worst));
        }
        (self.advanced)(Progress { evaluations: found.evaluations, best: found.worst_area });
        Some(now + BEYOND * beyond)
    }

    fn worst_area(&mut self, gains: &[f64]) -> Result<Option<Least>, DesignError> {
        let law = self.plan.knots.law(gains)?;
        let found = least_area(self.trials, &law, &self.plan.search, self.worst, self.stop)?;
        self.worst = found.map_or(self.worst, |least| least.of);
        Ok(found)
    }

    fn end(&mut self, complete: bool) {
        self.ended = true;
        if let Some(found) = &mut self.found {
            found.complete = complete;
        }
    }
}

/// SplitMix64 (Steele, Lea and Flood 2014).
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A step of random sign.
    fn step(&mut self) -> f64 {
        let part = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        let size = STEPS.0 + (STEPS.1 - STEPS.0) * part;
        if self.next().is_multiple_of(2) { size } else { -size }
    }
}
