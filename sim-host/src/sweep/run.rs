//! Computes cells of a sweep and stores their results.

use super::unit::Unit;
use super::{Folder, SweepError};
use crate::basin::{Column, Search, border};
use crate::ride::Conditions;
use rayon::prelude::*;
use serde_json::Value;
use std::sync::Mutex;

/// A cell to compute.
pub struct Cell {
    /// Identity.
    pub id: String,
    /// Full configuration.
    pub config: Value,
    /// The scenario that gives its result again.
    pub scenario: Value,
    /// Conditions that follow from the configuration.
    pub conditions: Conditions,
}

/// Callbacks for progress and interruption.
pub struct Progress<'a> {
    /// Called after every column.
    pub advanced: &'a (dyn Fn() + Sync),
    /// Checked before every column; true stops the run.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

/// Computes `cells` on all cores of the current rayon pool and stores each in `folder` when it is finished;
/// returns their number. The results depend neither on the number of threads nor on earlier runs.
///
/// # Errors
/// The search or a cell's conditions fail their checks, or a file can't be written.
pub fn run(
    cells: &[&Cell],
    search: &Search,
    folder: &Folder,
    progress: &Progress,
) -> Result<usize, SweepError> {
    search.check()?;
    for cell in cells {
        cell.conditions.check()?;
    }
    let speeds = search.speeds.len();
    let columns: Vec<Mutex<Vec<(usize, Column)>>> = cells.iter().map(|_| Mutex::default()).collect();
    let done = Mutex::new(0);
    // Parallel over columns rather than cells: at most as many cells are unfinished as there are threads.
    (0..cells.len() * speeds).into_par_iter().try_for_each(|i| {
        if (progress.stop)() {
            return Ok::<(), SweepError>(());
        }
        let (cell, speed) = (i / speeds, i % speeds);
        let column = border(&cells[cell].conditions, search, search.speeds[speed]);
        (progress.advanced)();
        let mut there = lock(&columns[cell]);
        there.push((speed, column));
        if there.len() < speeds {
            return Ok(());
        }
        there.sort_by_key(|(speed, _)| *speed);
        let whole = std::mem::take(&mut *there).into_iter().map(|(_, column)| column).collect();
        folder.keep(&Unit::new(&cells[cell].id, (&cells[cell].config, &cells[cell].scenario), whole))?;
        *lock(&done) += 1;
        Ok(())
    })?;
    let done = *lock(&done);
    Ok(done)
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
