//! The picture of a basin during its computation, above the progress bar.

use crate::basin::{Axis, Basin, Column, Search};
use crate::report::terminal;
use console::Term;
use indicatif::ProgressBar;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Width of the picture: that of the final one.
const WIDTH: usize = 80;
/// Rows of the highest picture and the bar.
const ROWS: usize = 24;
/// Interval between looks at the columns.
const EVERY: Duration = Duration::from_millis(20);
/// Number of columns of the first drawing.
const FIRST: f64 = 3.0;
/// Growth of the number of columns between drawings: a few drawings for any number and speed of columns.
const GROWTH: f64 = 2.0;
/// Most columns that are kept for the picture: two for each character. As coarse ones come first, these cover the range.
const MOST: usize = 2 * WIDTH;

/// A picture that is drawn again and again while columns are added.
pub(super) struct LivePicture<'a> {
    bar: &'a ProgressBar,
    axis: Axis,
    /// First and last speed \[m/s\].
    speeds: (f64, f64),
    basin: Mutex<Basin>,
}

impl<'a> LivePicture<'a> {
    /// A picture above `bar`; `None` if the terminal is too small for it.
    pub(super) fn new(bar: &'a ProgressBar, search: &Search) -> Option<Self> {
        let (rows, width) = Term::stderr().size();
        let speeds = search.speeds.first().copied().zip(search.speeds.last().copied())?;
        let fits = usize::from(rows) >= ROWS && usize::from(width) >= WIDTH;
        let basin = Mutex::new(Basin { columns: Vec::new() });
        fits.then_some(Self { bar, axis: search.axis, speeds, basin })
    }

    /// Adds a finished column.
    pub(super) fn add(&self, column: &Column) {
        let columns = &mut self.locked().columns;
        if columns.len() < MOST {
            let at = columns.partition_point(|other| other.speed < column.speed);
            columns.insert(at, column.clone());
        }
    }

    /// Runs `compute`, and draws meanwhile.
    pub(super) fn during<T>(&self, compute: impl FnOnce() -> T) -> T {
        let (running, ended) = channel::<()>();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                let mut next = FIRST;
                while ended.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                    let basin = self.locked().clone();
                    let count = basin.columns.len() as f64;
                    if count >= next {
                        next = GROWTH * count;
                        let picture = terminal::partial_basin(&basin, self.axis, self.speeds, WIDTH);
                        self.bar.set_message(picture);
                    }
                }
            });
            let computed = compute();
            drop(running);
            computed
        })
    }

    fn locked(&self) -> MutexGuard<'_, Basin> {
        self.basin.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
