//! Files that `monitor` writes continuously: they replace an older file at once and remain however it ends.

use super::Failure;
use crate::report::mcap::Recorder;
use crate::report::table::heading;
use schemars::JsonSchema;
use serde::Serialize;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// A table whose rows are written at once.
pub(super) struct Table {
    path: String,
    rows: csv::Writer<Box<dyn Write>>,
}

impl Table {
    pub(super) fn create(path: &Path, config: &serde_json::Value) -> Result<Self, Failure> {
        let mut file = open(path)?;
        let name = path.display().to_string();
        file.write_all(heading(config).as_bytes()).map_err(|error| failed(&name, error))?;
        Ok(Self { path: name, rows: csv::Writer::from_writer(file) })
    }

    pub(super) fn write(&mut self, row: &impl Serialize) -> Result<(), Failure> {
        self.rows.serialize(row).map_err(|error| failed(&self.path, error.into()))
    }

    pub(super) fn flush(&mut self) -> Result<(), Failure> {
        self.rows.flush().map_err(|error| failed(&self.path, error))
    }
}

/// An MCAP file whose rows are written in chunks of a second or so.
pub(super) struct Mcap {
    path: String,
    recorder: Recorder<File>,
}

impl Mcap {
    pub(super) fn create<R: JsonSchema>(
        path: &Path,
        topic: &str,
        config: &serde_json::Value,
    ) -> Result<Self, Failure> {
        crate::report::mcap::available().map_err(|error| format!("--mcap: {error}"))?;
        let name = path.display().to_string();
        let file = File::create(path).map_err(|error| failed(&name, error))?;
        let recorder = Recorder::new::<R>(file, topic, config).map_err(|error| unwritten(&name, &error))?;
        Ok(Self { path: name, recorder })
    }

    pub(super) fn write(&mut self, time_s: f64, row: &impl Serialize) -> Result<(), Failure> {
        self.recorder.write(time_s, row).map_err(|error| unwritten(&self.path, &error))
    }

    pub(super) fn finish(self) -> Result<(), Failure> {
        self.recorder.finish().map_err(|error| unwritten(&self.path, &error))
    }
}

fn unwritten(path: &str, error: &impl std::fmt::Display) -> Failure {
    format!("can't write {path}: {error}").into()
}

/// Opens a file for writing at once; an older one is truncated.
pub(super) fn open(path: &Path) -> Result<Box<dyn Write>, Failure> {
    if path == Path::new("-") {
        return Ok(Box::new(io::stdout()));
    }
    let file = File::create(path).map_err(|error| failed(&path.display().to_string(), error))?;
    Ok(Box::new(file))
}

/// Keeps a closed standard output recognisable; other errors name the file.
pub(super) fn failed(path: &str, error: io::Error) -> Failure {
    if path == "-" { error.into() } else { unwritten(path, &error) }
}
