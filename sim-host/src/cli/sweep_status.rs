//! `sim-host sweep --status`: what is done of a sweep, and who computes the rest.

use super::outputs::{print, write_json};
use super::{Ended, Failure};
use crate::report::output::Output;
use crate::sweep::status::{ClaimedCell, StatusDocument};
use crate::sweep::{Folder, in_the_future};
use std::fmt::Write;
use std::path::Path;

pub(super) fn run(folder: &Path, json: Option<&Path>) -> Result<Ended, Failure> {
    let json = json.map(Output::create).transpose()?;
    let (folder, plan) = Folder::there(folder)?;
    let status = StatusDocument::new(&folder, &plan)?;
    if let Some(output) = &json {
        write_json(output, &status)?;
    }
    if !json.is_some_and(|output| output.is_standard()) {
        let label = |cell: &ClaimedCell| crate::sweep::label(&plan.axes, &cell.values);
        print(&text(&status, plan.search.speeds.len(), label))?;
    }
    Ok(Ended::Done)
}

fn text(status: &StatusDocument, speeds: usize, label: impl Fn(&ClaimedCell) -> String) -> String {
    let StatusDocument { cells, done, free, running, stale, failed, .. } = status;
    let mut text = format!(
        "{done} of {cells} cells done, {} running, {} stale, {} failed, {free} free",
        running.len(),
        stale.len(),
        failed.len()
    );
    let left = status.remaining_s.map(|s| format!("; about {} left", super::sweep::duration(s)));
    let _ = writeln!(text, "{}", left.unwrap_or_default());
    for (state, cells) in [("running", running), ("stale", stale), ("failed", failed)] {
        for cell in cells {
            let worker = cell.worker.as_ref().map(|worker| format!(" by {}", worker.name()));
            let attempt =
                if cell.attempt > 1 { format!(", attempt {}", cell.attempt) } else { String::new() };
            let renewed = match cell.ahead_s {
                0 => format!("renewed {} s ago", cell.renewed_s),
                ahead => in_the_future(ahead),
            };
            let error = cell.error.as_ref().map(|error| format!(": {error}"));
            let _ = writeln!(
                text,
                "{state}  {}{}, for {} s, {} of {speeds} columns{attempt}, {renewed}{}",
                label(cell),
                worker.unwrap_or_default(),
                cell.age_s,
                cell.columns,
                error.unwrap_or_default()
            );
        }
    }
    text
}
