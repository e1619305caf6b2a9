//! The state of a sweep's folder while processes compute in it.

use super::claim::{Claim, State, now_unix_s};
use super::{Folder, Plan, SweepError, Worker};
use crate::report::tool::{SCHEMA, Tool};
use schemars::JsonSchema;
use serde::Serialize;
use std::time::UNIX_EPOCH;

/// `sweep --status`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct StatusDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program that computes.
    pub tool: Tool,
    /// Number of cells.
    pub cells: usize,
    /// Number of stored cells. They are not read: a damaged one is found by the next run.
    pub done: usize,
    /// Number of cells that are not begun, or that were interrupted.
    pub free: usize,
    /// Cells that are being computed.
    pub running: Vec<ClaimedCell>,
    /// Cells whose process is lost; the next process takes them over.
    pub stale: Vec<ClaimedCell>,
    /// Cells whose process ended with an error; the next process tries them again.
    pub failed: Vec<ClaimedCell>,
    /// Estimated time until all cells are done at the present rate \[s\]; null if nothing is running or nothing is
    /// finished yet.
    pub remaining_s: Option<f64>,
}

/// A claimed cell.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ClaimedCell {
    /// Its identity.
    pub id: String,
    /// The axes' values.
    pub values: Vec<String>,
    /// The process that computes it; null if it ended with an error.
    pub worker: Option<Worker>,
    /// Time since the claim \[s\].
    pub age_s: u64,
    /// Time since its last renewal \[s\].
    pub renewed_s: u64,
    /// Time by which the last renewal is in the future, as the machines' clocks differ; 0 if it is not \[s\].
    pub ahead_s: u64,
    /// Time without renewal after which it is stale \[s\].
    pub stale_after_s: u64,
    /// Number of finished columns at the last renewal.
    pub columns: usize,
    /// Counts the processes that have begun it.
    pub attempt: u32,
    /// The error; null if there was none.
    pub error: Option<String>,
}

impl StatusDocument {
    /// The state of a folder.
    ///
    /// # Errors
    /// A file can't be read.
    pub fn new(folder: &Folder, plan: &Plan) -> Result<Self, SweepError> {
        let claims = folder.claims();
        // The claims first: a cell finished in between is counted as done.
        let claimed = claims.all()?;
        let stored = folder.stored()?;
        let of_plan = |id: &String| plan.cells.iter().position(|cell| cell == id);
        let in_state = |state: State| -> Vec<(usize, &Claim)> {
            let mine =
                claimed.iter().filter(|c| c.state(claims.worker()) == state && !stored.contains_key(&c.id));
            mine.filter_map(|claim| Some((of_plan(&claim.id)?, claim))).collect()
        };
        let [running, stale, failed] = [State::Running, State::Stale, State::Failed].map(in_state);
        let done = plan.cells.iter().filter(|id| stored.contains_key(*id)).count();
        let busy = running.len() + stale.len() + failed.len();
        let written =
            stored.values().filter_map(|time| Some(time.duration_since(UNIX_EPOCH).ok()?.as_secs_f64()));
        let cells =
            |claims: Vec<(usize, &Claim)>| claims.into_iter().map(|c| ClaimedCell::new(plan, c)).collect();
        Ok(Self {
            schema: SCHEMA,
            tool: plan.tool.clone(),
            cells: plan.cells.len(),
            done,
            free: plan.cells.len() - done - busy,
            remaining_s: remaining(plan, done, &running, written),
            running: cells(running),
            stale: cells(stale),
            failed: cells(failed),
        })
    }
}

/// Estimated time until the end \[s\], from the columns finished since the first of the running processes began; `written`
/// are the times of the stored units.
fn remaining(
    plan: &Plan,
    done: usize,
    running: &[(usize, &Claim)],
    written: impl Iterator<Item = f64>,
) -> Option<f64> {
    let workers = running.iter().filter_map(|(_, claim)| claim.worker.as_ref());
    let begin = workers.map(|worker| worker.started_unix_s).min()? as f64;
    let speeds = plan.search.speeds.len() as f64;
    let under_way: usize = running.iter().map(|(_, claim)| claim.columns.len()).sum();
    let finished = written.filter(|time| *time >= begin).count() as f64 * speeds + under_way as f64;
    let left = (plan.cells.len() - done) as f64 * speeds - under_way as f64;
    let elapsed = now_unix_s() as f64 - begin;
    (finished > 0.0 && elapsed > 0.0).then(|| (left * elapsed / finished).max(0.0))
}

impl ClaimedCell {
    fn new(plan: &Plan, (i, claim): (usize, &Claim)) -> Self {
        let now = now_unix_s();
        Self {
            id: claim.id.clone(),
            values: plan.values(i),
            worker: claim.worker.clone(),
            age_s: claim.age_s(now),
            renewed_s: claim.renewed_s(now),
            ahead_s: claim.ahead_s(now),
            stale_after_s: claim.stale_after_s,
            columns: claim.columns.len(),
            attempt: claim.attempt,
            error: claim.error.clone(),
        }
    }
}
