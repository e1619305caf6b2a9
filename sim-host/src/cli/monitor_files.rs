//! Files that `monitor` writes continuously: they replace an older file at once and remain however it ends.

use super::Failure;
use crate::report::mcap::{McapError, Recorder};
use crate::report::table::heading;
use schemars::JsonSchema;
use serde::Serialize;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

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

/// An MCAP file whose rows are written in chunks of a second or so. If it can't be written on, as on a full disk, it is removed,
/// except that of a live board, which ends with its last whole chunk.
pub(super) struct Mcap {
    path: PathBuf,
    recorder: Recorder<File>,
    file: File,
    /// Whether the rows can't be had again.
    live: bool,
    /// Bytes up to the end of the last whole chunk of a live board; 0 before the first.
    whole: u64,
}

impl Mcap {
    pub(super) fn create<R: JsonSchema>(
        path: &Path,
        topic: &str,
        config: &serde_json::Value,
        live: bool,
    ) -> Result<Self, Failure> {
        crate::report::mcap::available().map_err(|error| format!("--mcap: {error}"))?;
        let name = path.display().to_string();
        let opened = File::create(path).and_then(|file| Ok((file.try_clone()?, file)));
        let (file, to) = opened.map_err(|error| failed(&name, error))?;
        match Recorder::new::<R>(to, topic, config) {
            Ok(recorder) => Ok(Self { path: path.into(), recorder, file, live, whole: 0 }),
            Err(error) => Err(ended_early(path, &file, 0, &error)),
        }
    }

    /// Adds a row; the file, if it can be written on.
    pub(super) fn write(mut self, time_s: f64, row: &impl Serialize) -> Result<Self, Failure> {
        match self.recorder.write(time_s, row) {
            Ok(true) if self.live => self.whole = self.file.metadata().map_or(self.whole, |file| file.len()),
            Ok(_) => {}
            Err(error) => {
                // It may still write when it is dropped.
                #[cfg_attr(not(feature = "mcap"), allow(clippy::drop_non_drop))]
                drop(self.recorder);
                return Err(ended_early(&self.path, &self.file, self.whole, &error));
            }
        }
        Ok(self)
    }

    pub(super) fn finish(self) -> Result<(), Failure> {
        let Self { path, recorder, file, whole, .. } = self;
        recorder.finish().map_err(|error| ended_early(&path, &file, whole, &error))
    }
}

/// Cuts a file that can't be written on to its `whole` chunks, or removes it.
fn ended_early(path: &Path, file: &File, whole: u64, error: &McapError) -> Failure {
    let kept = whole > 0 && file.set_len(whole).is_ok();
    if !kept && file.metadata().is_ok_and(|file| file.is_file()) {
        // What is left of it is named in the error.
        let _ = std::fs::remove_file(path);
    }
    let rest = if kept { "; the rows before are in it, without the file's end (`mcap recover`)" } else { "" };
    format!("can't write {}: {error}{rest}", path.display()).into()
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
    if path == "-" { error.into() } else { format!("can't write {path}: {error}").into() }
}
