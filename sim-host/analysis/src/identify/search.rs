//! Global search: minima of the frequency domain, each followed by a search in time; the distinct optima.

use super::descent::{Found, descend};
use super::evolution::{Extent, minimise};
use super::gray_box::{GAINS, GrayBox, PerGain};
use super::objective::{Drift, Objective};
use super::record::Record;
use super::response::{Discrete, Disturbances, Hold};
use super::spectrum::Spectrum;
use physics::rider::{Row, catalogue};
use rayon::prelude::*;

/// Order of magnitude of each gain: half the largest of Tables F.3, G.3, J.1 of Kuipers 2020, rounded. It scales the
/// global search; gains may become larger.
pub(super) const TYPICAL: PerGain = [100.0, 150.0, 50.0, 4.0, 80.0, 1000.0, 10.0, 0.5];
/// Iterations of the linear fit.
const LINEAR_ITERATIONS: usize = 12;
/// The number of starts from the linear fits and from the evolution.
const STARTS: [usize; 2] = [3, 5];
/// Starts that differ by less than this, in units of [`TYPICAL`], count as one.
const START_APART: f64 = 0.05;
/// Optima whose costs differ by less than this ratio, and whose gains by less than [`SAME_GAIN`], count as one.
const SAME_COST: f64 = 1e-4;
const SAME_GAIN: f64 = 1e-2;

/// An optimum and the number of starts that led to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Optimum {
    pub(super) found: Found,
    pub(super) starts: usize,
}

/// Largest difference of two sets of gains, in units of [`TYPICAL`].
fn apart(a: &PerGain, b: &PerGain) -> f64 {
    (0..GAINS).map(|i| ((a[i] - b[i]) / TYPICAL[i]).abs()).fold(0.0, f64::max)
}

/// The best of `candidates`, given in order of preference, that differ.
fn distinct(candidates: impl Iterator<Item = PerGain>, most: usize) -> Vec<PerGain> {
    let mut chosen: Vec<PerGain> = Vec::new();
    for candidate in candidates {
        if chosen.len() < most && chosen.iter().all(|other| apart(other, &candidate) > START_APART) {
            chosen.push(candidate);
        }
    }
    chosen
}

/// Cost of the global search: what the frequency domain leaves unexplained, and more than all of that for unstable gains,
/// which the frequency domain does not tell from stable ones.
struct Cost {
    spectrum: Spectrum,
    discrete: Discrete,
    impulse: Disturbances,
}

/// Sample time and duration of the response that tells stable gains from unstable ones \[s\].
const STABILITY_SAMPLE_S: f64 = 0.02;
const STABILITY_S: f64 = 12.0;
/// Growth from the first to the last third of that response from which gains count as unstable: riders who drift slowly are
/// upright for a minute.
const GROWTH: f64 = 3.0;
/// Unexplained power from which stability is not looked at, in units of the signals' power.
const WORTH_A_LOOK: f64 = 3.0;
/// Tables whose rows at the nearest speed are starts, too.
const PUBLISHED: [&str; 3] = ["young", "smart", "undelayed"];
/// Largest gain of the global search, in units of [`TYPICAL`]. Infinite gains explain nothing, which is better than many others.
const LARGEST: f64 = 5.0;
/// Cost of unstable gains: more than the power of all signals.
const UNSTABLE: f64 = 10.0;

impl Cost {
    fn new(problem: &Global) -> Self {
        let mut samples = vec![[0.0; 2]; (STABILITY_S / STABILITY_SAMPLE_S) as usize];
        samples[0] = [1.0, 1.0];
        Self {
            spectrum: Spectrum::new(problem.record, problem.model),
            discrete: Discrete::new(problem.model, STABILITY_SAMPLE_S),
            impulse: Disturbances { sample_s: STABILITY_SAMPLE_S, samples, hold: Hold::Zero },
        }
    }

    fn stable(&self, gains: &PerGain) -> bool {
        let Some(response) = self.discrete.respond(&self.impulse, gains, false) else { return false };
        let third = response.states.len() / 3;
        let peak = |states: &[[f64; 3]]| states.iter().map(|x| x[0].abs() + x[1].abs()).fold(0.0, f64::max);
        peak(&response.states[2 * third..]) < GROWTH * peak(&response.states[..third])
    }

    fn of(&self, gains: &PerGain) -> f64 {
        if (0..GAINS).any(|i| gains[i].abs() > LARGEST * TYPICAL[i]) {
            return f64::INFINITY;
        }
        let unexplained = self.spectrum.unexplained(gains);
        // Much worse gains are not chosen anyway.
        if unexplained < WORTH_A_LOOK && !self.stable(gains) { unexplained + UNSTABLE } else { unexplained }
    }
}

fn starts(problem: &Global, stop: &(impl Fn() -> bool + Sync)) -> Vec<PerGain> {
    let (cost, active) = (Cost::new(problem), problem.active);
    let mut linear = cost.spectrum.linear_fits(active, LINEAR_ITERATIONS);
    linear.sort_by(|a, b| cost.of(a).total_cmp(&cost.of(b)));
    let gains = |numbers: &[f64]| {
        let mut gains = PerGain::default();
        active.iter().zip(numbers).for_each(|(place, x)| gains[*place] = *x);
        gains
    };
    let ranges: Vec<(f64, f64)> = active.iter().map(|i| (-TYPICAL[*i], TYPICAL[*i])).collect();
    let extent = Extent { population: 20 + 5 * active.len(), generations: 120, seed: problem.seed };
    let population = minimise(&ranges, extent, |numbers| cost.of(&gains(numbers)), stop);
    let mut all = distinct(linear.into_iter(), STARTS[0]);
    all.extend(published(problem.model.speed_m_s, active));
    all.extend(distinct(population.iter().map(|member| gains(&member.numbers)), STARTS[1]));
    all
}

/// Published gains at the nearest speed: riders of other bicycles ride alike.
fn published(speed_m_s: f64, active: &[usize]) -> Vec<PerGain> {
    let nearest = |name: &&str| {
        let table = catalogue::load(name).ok()?;
        let far = |row: &&Row| (row.speed_m_s - speed_m_s).abs();
        let row = table.rows.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        let mut gains = PerGain::default();
        active.iter().for_each(|i| gains[*i] = row.gains.0[*i]);
        Some(gains)
    };
    PUBLISHED.iter().filter_map(nearest).collect()
}

/// The optimum reached from `start`. If the response there is unbounded, the record's first part is fitted before longer
/// ones: over a short time every response is bounded.
fn reached(objective: &Objective, problem: &Global, start: &PerGain) -> Option<Found> {
    let Global { record, model, drift, active, .. } = problem;
    if let Some(found) = descend(objective, active, start) {
        return Some(found);
    }
    let mut gains = *start;
    for part in [64, 32, 16, 8, 4, 2] {
        let short = record.first(record.len() / part);
        let drift = if *drift == Drift::None { Drift::None } else { Drift::Offset };
        let shorter = Objective::new(&short, model, drift, &|_| true);
        gains = descend(&shorter, active, &gains)?.gains;
    }
    descend(objective, active, &gains)
}

/// Optima reached from the best one by way of a fit without each of its gains: valleys that narrow near the limit of stability
/// end the search early in one of them.
fn detours(objective: &Objective, active: &[usize], best: &PerGain) -> Vec<Found> {
    let detour = |place: usize| {
        let mut without = active.to_vec();
        let mut start = *best;
        start[without.remove(place)] = 0.0;
        let around = if without.is_empty() { start } else { descend(objective, &without, &start)?.gains };
        descend(objective, active, &around)
    };
    (0..active.len()).into_par_iter().filter_map(detour).collect()
}

/// A global search.
pub(super) struct Global<'a> {
    pub(super) record: &'a Record,
    pub(super) model: &'a GrayBox,
    pub(super) drift: Drift,
    /// Indices of the gains to fit.
    pub(super) active: &'a [usize],
    pub(super) seed: u64,
}

/// The distinct optima, best first.
pub(super) fn optima(
    objective: &Objective,
    problem: &Global,
    stop: &(impl Fn() -> bool + Sync),
) -> Vec<Optimum> {
    let starts = starts(problem, stop);
    let ends: Vec<Option<Found>> = starts
        .par_iter()
        .map(|start| if stop() { None } else { reached(objective, problem, start) })
        .collect();
    let mut optima: Vec<Optimum> = Vec::new();
    let mut ends: Vec<Found> = ends.into_iter().flatten().collect();
    if let Some(best) = ends.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).map(|found| found.gains)
        && !stop()
    {
        ends.extend(detours(objective, problem.active, &best));
    }
    ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    for found in ends {
        let same = |other: &&mut Optimum| {
            apart(&other.found.gains, &found.gains) < SAME_GAIN
                && (found.cost - other.found.cost).abs()
                    < SAME_COST * (1e-12 + found.cost.max(other.found.cost))
        };
        match optima.iter_mut().find(same) {
            Some(known) => known.starts += 1,
            None => optima.push(Optimum { found, starts: 1 }),
        }
    }
    optima
}
