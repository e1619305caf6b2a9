//! The folder of a sweep: its plan, and one file per finished cell.

use super::plan::PLAN;
use super::unit::Unit;
use super::{Plan, SweepError};
use crate::report::output::{Output, TEMPORARY};
use std::path::{Path, PathBuf};

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
            folder.write(PLAN, json.as_bytes())?;
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
                let unit = std::str::from_utf8(&bytes).ok().and_then(|text| Unit::unsealed(text, id));
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
        self.write(&Self::file(&unit.id), unit.sealed().as_bytes())
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

    fn failed(&self, error: std::io::Error) -> SweepError {
        SweepError::Write { folder: self.path.clone(), error }
    }
}
