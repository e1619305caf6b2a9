//! Claims: who computes a unit, and what of it is done. Processes that share a folder, on any number of machines, divide
//! its units by them; a claim that is lost or ignored costs computing time only, as each unit has the same bytes
//! in every process.

use super::Found;
use super::worker::Worker;
use crate::basin::{Column, Work};
use serde::{Deserialize, Serialize};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Time between renewals of a claim.
pub const RENEWAL: Duration = Duration::from_secs(20);
/// Time without renewal after which a claim is stale: above the minute for which network file systems may show an
/// older state, and the usual differences between clocks.
pub const STALE: Duration = Duration::from_secs(120);

/// A claim of a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// The unit's identity.
    pub id: String,
    /// The process that computes it; `None` once it was interrupted or has failed.
    pub worker: Option<Worker>,
    /// Time of the claim, seconds since 1970 UTC.
    pub since_unix_s: u64,
    /// Time of the last renewal, seconds since 1970 UTC.
    pub renewed_unix_s: u64,
    /// Time without renewal after which others take the unit over \[s\].
    pub stale_after_s: u64,
    /// Counts the processes that have begun the unit.
    pub attempt: u32,
    /// The error with which the last one ended.
    pub error: Option<String>,
    /// Finished columns, which need not be computed again.
    pub columns: Vec<DoneColumn>,
}

/// A finished column of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DoneColumn {
    /// Index of its speed in the search.
    pub speed: usize,
    /// The result.
    pub found: Found,
    /// Computing effort.
    pub work: Work,
}

impl DoneColumn {
    /// The column at a speed, given by its index in the search.
    pub fn new(speed: usize, column: &Column) -> Self {
        Self { speed, found: Found::of(column), work: column.work }
    }
}

/// State of a claimed unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Being computed.
    Running,
    /// No longer computed, as the process was lost: not renewed in time, or ended on this machine.
    Stale,
    /// Interrupted.
    Released,
    /// Ended with an error.
    Failed,
}

impl Claim {
    /// A first claim.
    pub(super) fn new(id: &str, worker: &Worker) -> Self {
        let now = now_unix_s();
        Self {
            id: id.into(),
            worker: Some(worker.clone()),
            since_unix_s: now,
            renewed_unix_s: now,
            stale_after_s: STALE.as_secs(),
            attempt: 1,
            error: None,
            columns: Vec::new(),
        }
    }

    /// The state, as seen by a process on the machine of `here`. A renewal further ahead than a stale one is behind comes from
    /// a wrong clock, and is stale as well.
    pub fn state(&self, here: &Worker) -> State {
        let late = now_unix_s().abs_diff(self.renewed_unix_s) > self.stale_after_s;
        match &self.worker {
            None if self.error.is_some() => State::Failed,
            None => State::Released,
            Some(worker) if late || worker.ended(here) => State::Stale,
            Some(_) => State::Running,
        }
    }
}

/// Difference that clocks in step may show, as times are whole seconds \[s\].
const SAME_CLOCK_S: u64 = 2;

impl Claim {
    /// Time since the claim \[s\], at `now` in seconds since 1970 UTC.
    pub(super) fn age_s(&self, now: u64) -> u64 {
        now.saturating_sub(self.since_unix_s)
    }

    /// Time since the last renewal \[s\].
    pub(super) fn renewed_s(&self, now: u64) -> u64 {
        now.saturating_sub(self.renewed_unix_s)
    }

    /// Time by which the last renewal is in the future, as the machines' clocks differ; 0 if it is not \[s\].
    pub(super) fn ahead_s(&self, now: u64) -> u64 {
        Some(self.renewed_unix_s.saturating_sub(now)).filter(|ahead| *ahead > SAME_CLOCK_S).unwrap_or(0)
    }

    /// Estimated time until its unit of `columns` columns is finished \[s\], at the rate since the claim; `None` if no
    /// column was finished at the last renewal.
    pub(super) fn remaining_s(&self, columns: usize, now: u64) -> Option<f64> {
        let (done, taken) = (self.columns.len(), self.renewed_unix_s.saturating_sub(self.since_unix_s));
        let left = columns.saturating_sub(done) as f64 * taken as f64 / done as f64;
        (done > 0 && taken > 0).then(|| (left - self.renewed_s(now) as f64).max(0.0))
    }
}

/// Seconds since 1970 UTC.
pub(super) fn now_unix_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
