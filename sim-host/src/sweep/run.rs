//! Computes cells of a sweep and stores their results.

use super::claim::DoneColumn;
use super::claims::renewing;
use super::queue::{Next, Queue};
use super::{Folder, SweepError, Wait};
use crate::basin::{Search, borders, together};
use crate::ride::Conditions;
use serde_json::Value;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Pause of a thread while others compute all that is left.
const PAUSE: Duration = Duration::from_millis(50);

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
    /// Called for every column, also of other processes.
    pub advanced: &'a (dyn Fn() + Sync),
    /// Called when all that is left is computed by other processes: after a second, then every minute.
    pub waits: &'a (dyn Fn(&Wait) + Sync),
    /// Checked before the columns of a thread, of one cell; true stops the run.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

/// Cells of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// Number of finished cells.
    pub cells: usize,
    /// Number of them that other processes finished during the run.
    pub by_others: usize,
}

/// Computes `cells` on all cores of the current rayon pool and stores each in `folder` when it is finished. Processes with
/// the same folder share the cells: each is claimed before it is computed, and taken over if its process is lost. Ends
/// when all cells are finished, also by others, or `stop` is true: the finished columns of unfinished cells are then kept
/// with their claims. The results depend neither on the number of threads or processes nor on earlier runs.
///
/// # Errors
/// The search or a cell's conditions fail their checks, or a file can't be written.
pub fn run(
    cells: &[&Cell],
    search: &Search,
    folder: &Folder,
    progress: &Progress,
) -> Result<Done, SweepError> {
    search.check()?;
    for cell in cells {
        cell.conditions.check()?;
    }
    let queue = Mutex::new(Queue::new(cells, search.speeds.len(), folder));
    let failed = AtomicBool::new(false);
    // The claim is renewed until the unit is there.
    let store = |cell: usize| -> Result<(), SweepError> {
        let unit = lock(&queue).unit(cell);
        unit.map_or(Ok(()), |unit| folder.keep(&unit))?;
        lock(&queue).stored(cell);
        Ok(())
    };
    let together = |cell: &Cell, left| together(&cell.conditions, search, left);
    let thread = || -> Result<(), SweepError> {
        while !(progress.stop)() && !failed.load(Ordering::Relaxed) {
            let (next, given) = {
                let mut queue = lock(&queue);
                (queue.next(together)?, queue.given())
            };
            (0..given).for_each(|_| (progress.advanced)());
            match next {
                Next::Columns(cell, indices) => {
                    let speeds: Vec<f64> = indices.iter().map(|&speed| search.speeds[speed]).collect();
                    let columns = borders(&cells[cell].conditions, search, &speeds);
                    let mut whole = false;
                    for (speed, column) in indices.into_iter().zip(&columns) {
                        (progress.advanced)();
                        whole = lock(&queue).finished(cell, DoneColumn::new(speed, column));
                    }
                    if whole {
                        store(cell)?;
                    }
                }
                Next::Store(cell) => store(cell)?,
                Next::Again => {}
                Next::Later => {
                    let wait = lock(&queue).wait();
                    wait.iter().for_each(progress.waits);
                    std::thread::sleep(PAUSE);
                }
                Next::Over => break,
            }
        }
        Ok(())
    };
    // A claim that is not renewed costs computing time at most; a full disk is reported by the next unit.
    let renew = || drop(lock(&queue).renew());
    let ended: Vec<Result<(), SweepError>> = renewing(renew, || {
        rayon::broadcast(|_| thread().inspect_err(|_| failed.store(true, Ordering::Relaxed)))
    });
    let error = ended.into_iter().find_map(Result::err);
    let mut queue = lock(&queue);
    let left = queue.release(error.as_ref());
    let done = Done { cells: cells.len() - left, by_others: queue.others };
    error.map_or(Ok(done), Err)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
