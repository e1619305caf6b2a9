//! The claims in a folder of units. No locks: a new claim is a file that must not exist yet; others are replaced by
//! renaming.

use super::claim::{Claim, RENEWAL, State, now_unix_s};
use super::seal;
use super::worker::Worker;
use super::{DoneColumn, SweepError};
use crate::report::output::{replace, write_new};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};

const CLAIMS: &str = "claims";

/// The claims of the units in a folder, as one process makes and sees them.
#[derive(Clone, Debug)]
pub struct Claims {
    folder: PathBuf,
    worker: Worker,
}

impl Claims {
    /// The claims in `folder`, for the current process.
    pub fn of(folder: &Path) -> Self {
        Self { folder: folder.join(CLAIMS), worker: Worker::this() }
    }

    /// The current process.
    pub fn worker(&self) -> &Worker {
        &self.worker
    }

    /// Claims a unit that no process computes, with the columns that others have finished; `None` if another process
    /// computes it.
    ///
    /// # Errors
    /// The claim can't be written or read.
    pub fn take(&self, id: &str) -> Result<Option<Claim>, SweepError> {
        let mut claim = Claim::new(id, &self.worker);
        if self.write_new(&claim)? {
            return Ok(Some(claim));
        }
        if let Some(earlier) = self.read(id)? {
            match earlier.state(&self.worker) {
                State::Running => return Ok(None),
                State::Stale | State::Failed => claim.attempt = earlier.attempt + 1,
                State::Released => claim.attempt = earlier.attempt,
            }
            claim.columns = earlier.columns;
        }
        match replace(&self.path(id), seal::sealed(&claim).as_bytes()) {
            // Another process has found that nothing is left to do.
            Err(e) if e.is_not_found() => return Ok(None),
            written => written?,
        }
        // Of several that take it over at once the last has it, except for a race that costs computing time only.
        Ok(self.holds(&claim)?.then_some(claim))
    }

    /// Renews a claim while `work` runs.
    pub fn hold<T>(&self, claim: &mut Claim, work: impl FnOnce() -> T) -> T {
        // A claim that is not renewed costs computing time at most.
        renewing(|| drop(self.renew(claim, Vec::new())), work)
    }

    /// Renews a claim, with the columns finished since; not if another process has taken it over.
    ///
    /// # Errors
    /// The claim can't be written or read.
    pub fn renew(&self, claim: &mut Claim, columns: Vec<DoneColumn>) -> Result<(), SweepError> {
        if self.holds(claim)? {
            (claim.renewed_unix_s, claim.columns) = (now_unix_s(), columns);
            self.write(claim)?;
        }
        Ok(())
    }

    /// Gives a unit up that is not finished: its columns are kept for the next process. If there is no space for them, those of
    /// the last renewal are; if there is none for the error either, the claim is removed.
    pub fn release(&self, claim: Claim, columns: Vec<DoneColumn>, error: Option<String>) {
        if columns.is_empty() && error.is_none() {
            return self.done(&claim.id);
        }
        let id = claim.id.clone();
        let kept = claim.columns.clone();
        let released = Claim { worker: None, renewed_unix_s: now_unix_s(), columns, error, ..claim };
        if self.write(&released).is_err() && self.write_over(&Claim { columns: kept, ..released }).is_err() {
            self.done(&id);
        }
    }

    /// Writes a claim over its file, whose space suffices on a full disk. A reader may see a part of it, which counts as no
    /// claim.
    fn write_over(&self, claim: &Claim) -> std::io::Result<()> {
        let content = seal::sealed(claim);
        let mut file = OpenOptions::new().write(true).open(self.path(&claim.id))?;
        file.write_all(content.as_bytes())?;
        file.set_len(content.len() as u64)?;
        file.sync_all()
    }

    /// Removes the claim of a finished unit.
    pub fn done(&self, id: &str) {
        // It may be gone with the folder of claims, when another process has found the sweep complete.
        let _ = std::fs::remove_file(self.path(id));
    }

    /// Removes all claims.
    pub fn clear(&self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }

    /// Removes the folder of the claims if there is none.
    pub fn clear_empty(&self) {
        let _ = std::fs::remove_dir(&self.folder);
    }

    /// All claims, in the order of their units.
    ///
    /// # Errors
    /// The folder or a claim can't be read.
    pub fn all(&self) -> Result<Vec<Claim>, SweepError> {
        let failed = |error| SweepError::Read { path: self.folder.clone(), error };
        let entries = match std::fs::read_dir(&self.folder) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries.map_err(failed)?,
        };
        let mut names = Vec::new();
        for entry in entries {
            names.push(entry.map_err(failed)?.file_name().to_string_lossy().into_owned());
        }
        names.sort();
        let claims = names.iter().filter_map(|name| name.strip_suffix(".json")).map(|id| self.read(id));
        claims.filter_map(Result::transpose).collect()
    }

    fn path(&self, id: &str) -> PathBuf {
        self.folder.join(format!("{id}.json"))
    }

    /// The claim of a unit; `None` if there is none or it is damaged.
    ///
    /// # Errors
    /// Its file can't be read.
    pub fn read(&self, id: &str) -> Result<Option<Claim>, SweepError> {
        let path = self.path(id);
        match std::fs::read(&path) {
            Ok(bytes) => Ok(seal::unsealed(&bytes).filter(|claim: &Claim| claim.id == id)),
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(SweepError::Read { path, error }),
        }
    }

    /// Writes a claim of a unit that has none; false if it has one.
    fn write_new(&self, claim: &Claim) -> Result<bool, SweepError> {
        loop {
            std::fs::create_dir_all(&self.folder)
                .map_err(|error| SweepError::Write { folder: self.folder.clone(), error })?;
            match write_new(&self.path(&claim.id), seal::sealed(claim).as_bytes()) {
                // Another process has removed the folder in between.
                Err(e) if e.is_not_found() => {}
                written => return Ok(written?),
            }
        }
    }

    fn write(&self, claim: &Claim) -> Result<(), SweepError> {
        Ok(replace(&self.path(&claim.id), seal::sealed(claim).as_bytes())?)
    }

    fn holds(&self, claim: &Claim) -> Result<bool, SweepError> {
        Ok(self.read(&claim.id)?.is_some_and(|there| there.worker.as_ref() == Some(&self.worker)))
    }
}

/// Calls `renew` at the time for renewals while `work` runs.
pub(super) fn renewing<T>(mut renew: impl FnMut() + Send, work: impl FnOnce() -> T) -> T {
    std::thread::scope(|scope| {
        let (over, ends) = channel::<()>();
        scope.spawn(move || {
            while ends.recv_timeout(RENEWAL) == Err(RecvTimeoutError::Timeout) {
                renew();
            }
        });
        let done = work();
        drop(over);
        done
    })
}
