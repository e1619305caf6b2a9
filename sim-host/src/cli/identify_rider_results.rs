//! Finished records of an identification, in a folder.

use super::Failure;
use crate::bicycle::catalogue::Bicycle;
use crate::report::figure::Chart;
use crate::report::identify::{RecordEntry, ResolvedIdentify};
use crate::report::output::Output;
use crate::report::resolved::ResolvedBicycle;
use crate::report::tool::Tool;
use crate::rider::{RiderTable, catalogue};
use crate::sweep::{Claims, Wait};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A finished record.
pub(super) struct Finished {
    pub(super) text: String,
    pub(super) chart: Chart,
    pub(super) rider: RiderTable,
    pub(super) document: Value,
    /// The report as an HTML page; empty if none was requested.
    pub(super) page: String,
}

/// The folder.
pub(super) struct Store {
    folder: PathBuf,
    claims: Claims,
}

impl Store {
    /// Creates the folder for the results of `files`, if needed.
    ///
    /// # Errors
    /// It can't be made, or two files would have results of the same name.
    pub(super) fn open(folder: &Path, files: &[PathBuf]) -> Result<Self, Failure> {
        let mut stems = BTreeMap::new();
        for file in files {
            if let Some(other) = stems.insert(file.file_stem().unwrap_or_default(), file) {
                let [one, two] = [other, file].map(|file| file.display());
                return Err(format!("--results: {one} and {two} would have results of the same name").into());
            }
        }
        std::fs::create_dir_all(folder).map_err(|e| format!("--results {}: {e}", folder.display()))?;
        Ok(Self { folder: folder.to_owned(), claims: Claims::of(folder) })
    }

    /// Runs `work` on a record, or returns `None` if another process with the same folder works on it.
    pub(super) fn alone<T>(&self, record: &Path, work: impl FnOnce() -> T) -> Result<Option<T>, Failure> {
        let Some(mut claim) = self.claims.take(&id(record))? else { return Ok(None) };
        let done = self.claims.hold(&mut claim, work);
        self.claims.done(&claim.id);
        self.claims.clear_empty();
        Ok(Some(done))
    }

    /// The wait for `records` that other processes work on.
    pub(super) fn wait<'a>(&self, records: impl Iterator<Item = &'a Path>) -> Wait {
        let ids: Vec<String> = records.map(id).collect();
        let claims: Vec<_> = ids.iter().filter_map(|id| self.claims.read(id).ok().flatten()).collect();
        Wait::new("record", ids.len(), 0, &claims)
    }

    fn place(&self, record: &Path, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", id(record)))
    }

    /// The result of a record with the same content and options; `None` if there is none.
    pub(super) fn finished(
        &self,
        file: &Path,
        record: &RecordEntry,
        config: &ResolvedIdentify,
        bicycle: &Bicycle,
    ) -> Option<Finished> {
        let document: Value = serde_json::from_slice(&std::fs::read(self.place(file, "json")).ok()?).ok()?;
        let same = document["tool"] == serde_json::to_value(Tool::this()).ok()?
            && document["record"]["sha256"] == record.sha256.as_str()
            && document["config"] == serde_json::to_value(config).ok()?
            && document["bicycle"] == serde_json::to_value(ResolvedBicycle::new(bicycle)).ok()?;
        let rider = catalogue::load(&self.place(file, "toml").display().to_string()).ok()?;
        let page = std::fs::read_to_string(self.place(file, "html")).ok()?;
        let text = std::fs::read_to_string(self.place(file, "txt")).ok()?;
        same.then(|| Finished { text, chart: Chart::default(), rider, document, page })
    }

    /// Writes the document, the rider, the report and the text of a record.
    pub(super) fn keep(&self, file: &Path, finished: &Finished) -> Result<(), Failure> {
        // The document last: it means that the record is finished.
        Output::create(&self.place(file, "toml"))?.finish(finished.rider.to_toml().as_bytes())?;
        Output::create(&self.place(file, "html"))?.finish(finished.page.as_bytes())?;
        Output::create(&self.place(file, "txt"))?.finish(finished.text.as_bytes())?;
        let text = serde_json::to_string_pretty(&finished.document)? + "\n";
        Ok(Output::create(&self.place(file, "json"))?.finish(text.as_bytes())?)
    }
}

/// Name of a record's results.
fn id(record: &Path) -> String {
    record.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
