//! The folder of a sweep: its plan, and a file for every cell that is done.

use super::unit::Unit;
use super::{Plan, SweepError};
use crate::report::output::{Output, TEMPORARY};
use std::path::{Path, PathBuf};

/// The plan's file.
pub const PLAN: &str = "plan.json";
const UNITS: &str = "units";

/// A folder that holds a sweep, or a part of one.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes a folder ready for `plan`; one that holds it already, or a part of it, is gone on with.
    ///
    /// # Errors
    /// When it can't be made or written to, or holds something else.
    pub fn open(path: &Path, plan: &Plan) -> Result<Self, SweepError> {
        let folder = Self { path: path.into() };
        let failed = |e: std::io::Error| folder.failed(e);
        std::fs::create_dir_all(path).map_err(failed)?;
        if !path.join(PLAN).exists() {
            // Another shard may have begun meanwhile, or one that was killed may have left its beginning.
            let of_sweep = |name: &str| name.starts_with(TEMPORARY) || [PLAN, UNITS].contains(&name);
            for entry in std::fs::read_dir(path).map_err(failed)? {
                if !of_sweep(&entry.map_err(failed)?.file_name().to_string_lossy()) {
                    let folder = path.display();
                    return Err(SweepError(format!("{folder} is neither empty nor the folder of a sweep")));
                }
            }
            let json = serde_json::to_string_pretty(plan).unwrap_or_default() + "\n";
            folder.write(PLAN, json.as_bytes())?;
        }
        if let Some(what) = plan.difference(&folder.plan()?) {
            let folder = path.display();
            return Err(SweepError(format!(
                "{folder} holds another sweep: {what} differs ({PLAN}); choose another --out, or empty it"
            )));
        }
        std::fs::create_dir_all(path.join(UNITS)).map_err(failed)?;
        Ok(folder)
    }

    /// A folder of which a sweep's run has made something.
    ///
    /// # Errors
    /// When there is no plan in it that can be read.
    pub fn there(path: &Path) -> Result<(Self, Plan), SweepError> {
        let folder = Self { path: path.into() };
        let plan = folder.plan()?;
        Ok((folder, plan))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn plan(&self) -> Result<Plan, SweepError> {
        let path = self.path.join(PLAN);
        let shown = path.display();
        let text = std::fs::read_to_string(&path).map_err(|e| {
            SweepError(format!("{} is not the folder of a sweep: {PLAN}: {e}", self.path.display()))
        })?;
        let plan: Plan = serde_json::from_str(&text)
            .map_err(|e| SweepError(format!("{shown} is not a sweep's plan: {e}")))?;
        if plan.cells.len() != super::plan::count(&plan.axes) {
            return Err(SweepError(format!("{shown}: {} cells do not fit the axes", plan.cells.len())));
        }
        Ok(plan)
    }

    /// The file of a unit, within the folder.
    pub fn file(id: &str) -> String {
        format!("{UNITS}/{id}.json")
    }

    /// The unit, if it is there.
    ///
    /// # Errors
    /// When its file is damaged.
    pub fn unit(&self, id: &str) -> Result<Option<Unit>, SweepError> {
        let path = self.path.join(Self::file(id));
        match std::fs::read(&path) {
            Ok(bytes) => {
                let unit = std::str::from_utf8(&bytes).ok().and_then(|text| Unit::unsealed(text, id));
                unit.map(Some).ok_or_else(|| SweepError(format!("{} is damaged", path.display())))
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(SweepError(format!("can't read {}: {e}", path.display()))),
        }
    }

    /// Keeps a unit.
    ///
    /// # Errors
    /// When its file can't be written.
    pub fn keep(&self, unit: &Unit) -> Result<(), SweepError> {
        self.write(&Self::file(&unit.id), unit.sealed().as_bytes())
    }

    /// Writes a file within the folder, whole or not at all.
    ///
    /// # Errors
    /// When it can't be written.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), SweepError> {
        let path = self.path.join(name);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|e| self.failed(e))?;
        }
        Ok(Output::create(&path)?.finish(content)?)
    }

    fn failed(&self, e: std::io::Error) -> SweepError {
        SweepError(format!("can't write to {}: {e}", self.path.display()))
    }
}
