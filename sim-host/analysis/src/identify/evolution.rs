//! Differential evolution (Storn and Price 1997, scheme rand/1/bin): a global search that needs no derivatives.

use physics::num::RandomStream;
use rayon::prelude::*;

/// Purpose of the random numbers.
const PURPOSE: u64 = 71;
const CROSSOVER: f64 = 0.9;

/// Extent of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Extent {
    pub(super) population: usize,
    pub(super) generations: usize,
    pub(super) seed: u64,
}

/// A member of the population.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub(super) numbers: Vec<f64>,
    pub(super) cost: f64,
}

/// Minimises `cost` over numbers that start within `ranges`, one per dimension, and are not limited to them. Returns the
/// last population, best first. `stop` ends the search early.
pub(super) fn minimise(
    ranges: &[(f64, f64)],
    extent: Extent,
    cost: impl Fn(&[f64]) -> f64 + Sync,
    stop: impl Fn() -> bool,
) -> Vec<Member> {
    let mut random = RandomStream::new(extent.seed, [0.0; 3], PURPOSE);
    let evaluated = |all: Vec<Vec<f64>>| -> Vec<Member> {
        let member = |numbers: Vec<f64>| {
            let cost = cost(&numbers);
            Member { cost: if cost.is_finite() { cost } else { f64::INFINITY }, numbers }
        };
        all.into_par_iter().map(member).collect()
    };
    let drawn = |random: &mut RandomStream| {
        ranges.iter().map(|(low, high)| low + (high - low) * random.uniform()).collect()
    };
    let mut population = evaluated((0..extent.population).map(|_| drawn(&mut random)).collect());
    for _ in 0..extent.generations {
        if stop() {
            break;
        }
        // A factor that differs from generation to generation avoids that the search stagnates (dither).
        let factor = 0.5 + 0.5 * random.uniform();
        let trials = (0..population.len()).map(|i| {
            let mut other = || loop {
                let j = random.below(population.len());
                if j != i {
                    return j;
                }
            };
            let (a, b, c) = (other(), other(), other());
            let always = random.below(ranges.len());
            let mut numbers = population[i].numbers.clone();
            for (dimension, x) in numbers.iter_mut().enumerate() {
                if dimension == always || random.chance(CROSSOVER) {
                    let [a, b, c] = [a, b, c].map(|j| population[j].numbers[dimension]);
                    *x = a + factor * (b - c);
                }
            }
            numbers
        });
        let trials = evaluated(trials.collect());
        for (member, trial) in population.iter_mut().zip(trials) {
            if trial.cost <= member.cost {
                *member = trial;
            }
        }
    }
    population.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    population
}
