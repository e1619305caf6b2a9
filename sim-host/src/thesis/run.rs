//! Computes the requested items.

use super::case::Case;
use super::catalogue::{Entry, Made};
use super::figures_of_merit::is_reading;
use super::item::Item;
use super::study::Study;
use rayon::prelude::*;

/// Progress callback and interruption of a run.
pub struct Progress<'a> {
    /// Called after each piece of work with its size in columns of a basin.
    pub advanced: &'a (dyn Fn(u64) + Sync),
    /// Called before every column and every item; true stops the run.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

/// A requested item and its result.
#[derive(Debug)]
pub struct Outcome {
    /// The item.
    pub entry: &'static Entry,
    /// Its content; `None` if it is unavailable or interrupted.
    pub item: Option<Item>,
}

/// The basins that an item needs; without the riders' other readings in a quick study.
fn cases(study: &Study, entry: &Entry) -> Vec<Case> {
    let Made::Computed { cases, .. } = entry.made else { return Vec::new() };
    let wanted = |case: &Case| !(study.quick && is_reading(case));
    cases().into_iter().filter(wanted).collect()
}

/// Work of `entries`, in columns of a basin.
pub fn work(study: &Study, entries: &[&Entry]) -> u64 {
    let mut all: Vec<Case> = Vec::new();
    for case in entries.iter().flat_map(|e| cases(study, e)) {
        if !all.contains(&case) {
            all.push(case);
        }
    }
    let own = |e: &&Entry| match e.made {
        Made::Computed { work, .. } => work,
        Made::Unavailable(_) => 0,
    };
    study.columns(&all) as u64 + entries.iter().map(own).sum::<u64>()
}

/// Computes `entries`: those without basins first and in parallel, the others in sequence, each with its basins on all
/// cores. After an interruption, each item is complete or missing.
pub fn run(study: &Study, entries: &[&'static Entry], progress: &Progress) -> Vec<Outcome> {
    let compute = |entry: &'static Entry| {
        let Made::Computed { compute, work, .. } = entry.made else { return Outcome { entry, item: None } };
        let needed = cases(study, entry);
        study.prepare(&needed, || (progress.advanced)(1), progress.stop);
        let ready = !(progress.stop)() && needed.iter().all(|case| study.has(case));
        let item = ready.then(|| compute(study));
        (progress.advanced)(work);
        Outcome { entry, item }
    };
    let (without, with): (Vec<_>, Vec<_>) = entries.iter().partition(|e| cases(study, e).is_empty());
    let mut done: Vec<Outcome> = without.into_par_iter().map(compute).collect();
    done.extend(with.into_iter().map(compute));
    done.sort_by_key(|o| entries.iter().position(|e| e.name == o.entry.name));
    done
}
