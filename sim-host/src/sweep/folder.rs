//! The folder of a sweep: its plan, and one file per finished cell.

use super::claim::STALE;
use super::claims::Claims;
use super::plan::PLAN;
use super::unit::Unit;
use super::{Plan, SweepError, seal};
use crate::report::output::{Output, TEMPORARY, replace, write_new};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

const UNITS: &str = "units";

/// A folder with a sweep, or a part of it.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Prepares a folder for `plan`; a folder with this sweep, or a part of it, is continued.
    ///
    /// # Errors
    /// The folder can't be created or written, or has other content.
    pub fn open(path: &Path, plan: &Plan) -> Result<Self, SweepError> {
        let folder = Self { path: path.into() };
        let failed = |e: std::io::Error| folder.failed(e);
        std::fs::create_dir_all(path).map_err(failed)?;
        if !path.join(PLAN).exists() {
            // Another shard may have started in the meantime, or a killed one may have left a partial start.
            let of_sweep = |name: &str| name.starts_with(TEMPORARY) || [PLAN, UNITS].contains(&name);
            for entry in std::fs::read_dir(path).map_err(failed)? {
                if !of_sweep(&entry.map_err(failed)?.file_name().to_string_lossy()) {
                    return Err(SweepError::OtherContent(path.into()));
                }
            }
            let json = serde_json::to_string_pretty(plan).unwrap_or_default() + "\n";
            write_new(&path.join(PLAN), json.as_bytes())?;
        }
        if let Some(difference) = plan.difference(&folder.plan()?) {
            return Err(SweepError::OtherSweep { folder: path.into(), difference });
        }
        std::fs::create_dir_all(path.join(UNITS)).map_err(failed)?;
        Ok(folder)
    }

    /// Opens the folder of a sweep that was started.
    ///
    /// # Errors
    /// The folder has no readable plan.
    pub fn there(path: &Path) -> Result<(Self, Plan), SweepError> {
        let folder = Self { path: path.into() };
        let plan = folder.plan()?;
        Ok((folder, plan))
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn plan(&self) -> Result<Plan, SweepError> {
        let path = self.path.join(PLAN);
        let text = std::fs::read_to_string(&path)
            .map_err(|error| SweepError::NoPlan { folder: self.path.clone(), error })?;
        let plan: Plan =
            serde_json::from_str(&text).map_err(|error| SweepError::Plan { path: path.clone(), error })?;
        match plan.cells.len() {
            cells if cells != super::plan::count(&plan.axes) => Err(SweepError::Cells { path, cells }),
            _ => Ok(plan),
        }
    }

    /// File of a unit, relative to the folder.
    pub fn file(id: &str) -> String {
        format!("{UNITS}/{id}.json")
    }

    /// Reads a unit; `None` if it has no file.
    ///
    /// # Errors
    /// Its file is damaged.
    pub fn unit(&self, id: &str) -> Result<Option<Unit>, SweepError> {
        let path = self.path.join(Self::file(id));
        match std::fs::read(&path) {
            Ok(bytes) => {
                let unit = seal::unsealed(&bytes).filter(|unit: &Unit| unit.id == id);
                unit.map(Some).ok_or(SweepError::Damaged(path))
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(SweepError::Read { path, error }),
        }
    }

    /// Stores a unit.
    ///
    /// # Errors
    /// Its file can't be written.
    pub fn keep(&self, unit: &Unit) -> Result<(), SweepError> {
        Ok(replace(&self.path.join(Self::file(&unit.id)), seal::sealed(unit).as_bytes())?)
    }

    /// Writes a file in the folder atomically.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), SweepError> {
        let path = self.path.join(name);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|e| self.failed(e))?;
        }
        Ok(Output::create(&path)?.finish(content)?)
    }

    /// The claims of its units.
    pub fn claims(&self) -> Claims {
        Claims::of(&self.path)
    }

    /// The stored units, by identity, with the times of their files; they are not read.
    ///
    /// # Errors
    /// The folder can't be read.
    pub fn stored(&self) -> Result<BTreeMap<String, SystemTime>, SweepError> {
        let path = self.path.join(UNITS);
        let failed = |error| SweepError::Read { path: path.clone(), error };
        let mut stored = BTreeMap::new();
        let entries = match std::fs::read_dir(&path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(stored),
            entries => entries.map_err(failed)?,
        };
        for entry in entries {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if let Some(id) = name.strip_suffix(".json") {
                let written = entry.metadata().and_then(|about| about.modified()).map_err(failed)?;
                stored.insert(id.to_owned(), written);
            }
        }
        Ok(stored)
    }

    /// Removes what only an unfinished sweep needs: claims, and temporary files of killed processes.
    pub fn tidy(&self) {
        self.claims().clear();
        let old = |entry: &std::fs::DirEntry| {
            let written = entry.metadata().ok()?.modified().ok()?;
            Some(written.elapsed().ok()? > STALE)
        };
        for folder in [self.path.clone(), self.path.join(UNITS)] {
            for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
                let temporary = entry.file_name().to_string_lossy().starts_with(TEMPORARY);
                if temporary && old(&entry) == Some(true) {
                    let _ = std::fs::remove_file(entry.path());
                }
            }
        }
    }

    fn failed(&self, error: std::io::Error) -> SweepError {
        SweepError::Write { folder: self.path.clone(), error }
    }
}
