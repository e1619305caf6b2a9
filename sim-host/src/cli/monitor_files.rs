//! Files that `monitor` writes continuously: they replace an older file at once and remain however it ends.

use super::Failure;
use super::outputs::complain;
use crate::report::mcap::{McapError, Recorder};
use crate::report::table::heading;
use schemars::JsonSchema;
use serde::Serialize;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The files of a session. One that can't be written on is left out from then on; the others continue and are completed.
pub(super) struct Files {
    table: Option<Table>,
    mcap: Option<Mcap>,
}

impl Files {
    /// Creates the files that are requested, with rows of the type `R`; `live` if the rows can't be had again.
    pub(super) fn create<R: JsonSchema>(
        csv: Option<&Path>,
        mcap: Option<&Path>,
        topic: &str,
        config: &serde_json::Value,
        live: bool,
    ) -> Result<Self, Failure> {
        let table = csv.map(|path| Table::create(path, config)).transpose()?;
        let mcap = mcap.map(|path| Mcap::create::<R>(path, topic, config, live)).transpose()?;
        Ok(Self { table, mcap })
    }

    /// Adds a row to each file.
    pub(super) fn write(&mut self, time_s: f64, row: &impl Serialize) -> Result<(), Failure> {
        let in_table = kept(&mut self.table, |table| table.write(row));
        both(in_table, kept(&mut self.mcap, |mcap| mcap.write(time_s, row))).map(drop)
    }

    /// Writes the table's rows that are still in memory.
    pub(super) fn flush(&mut self) -> Result<(), Failure> {
        kept(&mut self.table, Table::flush)
    }

    /// Completes each file.
    pub(super) fn finish(&mut self) -> Result<(), Failure> {
        both(self.flush(), self.mcap.take().map_or(Ok(()), Mcap::finish)).map(drop)
    }
}

/// Writes to a file, which is kept if it can be written on.
fn kept<F>(file: &mut Option<F>, write: impl FnOnce(F) -> Result<F, Failure>) -> Result<(), Failure> {
    *file = file.take().map(write).transpose()?;
    Ok(())
}

/// Two results, or the first error; if both failed, the second is told at once.
pub(super) fn both<A, B>(first: Result<A, Failure>, second: Result<B, Failure>) -> Result<(A, B), Failure> {
    if let (Err(_), Err(second)) = (&first, &second) {
        complain(&format!("error: {second}"));
    }
    Ok((first?, second?))
}

/// Rows of a table that are written together.
const TOGETHER: u32 = 50;

/// A table whose rows are written soon, and only whole. If it can't be written on, as on a full disk, it ends with its last whole
/// row.
struct Table {
    path: PathBuf,
    to: Box<dyn Write>,
    /// What is not written yet.
    rows: csv::Writer<Vec<u8>>,
    waiting: u32,
    /// Bytes up to the end of the last whole row in the file.
    whole: u64,
}

impl Table {
    fn create(path: &Path, config: &serde_json::Value) -> Result<Self, Failure> {
        let rows = csv::Writer::from_writer(Vec::new());
        let table = Self { path: path.into(), to: open(path)?, rows, waiting: 0, whole: 0 };
        table.append(heading(config).as_bytes())
    }

    /// Adds a row; the table, if it can be written on.
    fn write(mut self, row: &impl Serialize) -> Result<Self, Failure> {
        self.rows.serialize(row).map_err(|error| failed(&self.path, error.into()))?;
        self.waiting += 1;
        if self.waiting < TOGETHER { Ok(self) } else { self.flush() }
    }

    /// Writes the rows that are still in memory.
    fn flush(mut self) -> Result<Self, Failure> {
        if self.waiting == 0 {
            return Ok(self);
        }
        self.waiting = 0;
        let further = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        let rows = std::mem::replace(&mut self.rows, further).into_inner();
        let rows = rows.map_err(|error| failed(&self.path, error.into_error()))?;
        self.append(&rows)
    }

    fn append(mut self, bytes: &[u8]) -> Result<Self, Failure> {
        match self.to.write_all(bytes).and_then(|()| self.to.flush()) {
            Ok(()) => {
                self.whole += bytes.len() as u64;
                Ok(self)
            }
            Err(error) => {
                cut(&self.path, self.whole);
                Err(failed(&self.path, error))
            }
        }
    }
}

/// Cuts a file to its first `whole` bytes; what is no file has none.
fn cut(path: &Path, whole: u64) {
    let file = path.is_file().then(|| File::options().write(true).open(path));
    if let Some(Ok(file)) = file {
        // What remains ends within a row: the error before says so.
        let _ = file.set_len(whole);
    }
}

/// An MCAP file whose rows are written in chunks of a second or so. If it can't be written on, as on a full disk, it is removed,
/// except that of a live board, which ends with its last whole chunk.
struct Mcap {
    path: PathBuf,
    recorder: Recorder<File>,
    file: File,
    /// Whether the rows can't be had again.
    live: bool,
    /// Bytes up to the end of the last whole chunk of a live board; 0 before the first.
    whole: u64,
}

impl Mcap {
    fn create<R: JsonSchema>(
        path: &Path,
        topic: &str,
        config: &serde_json::Value,
        live: bool,
    ) -> Result<Self, Failure> {
        crate::report::mcap::available().map_err(|error| format!("--mcap: {error}"))?;
        let opened = File::create(path).and_then(|file| Ok((file.try_clone()?, file)));
        let (file, to) = opened.map_err(|error| failed(path, error))?;
        match Recorder::new::<R>(to, topic, config) {
            Ok(recorder) => Ok(Self { path: path.into(), recorder, file, live, whole: 0 }),
            Err(error) => Err(ended_early(path, &file, 0, &error)),
        }
    }

    /// Adds a row; the file, if it can be written on.
    fn write(mut self, time_s: f64, row: &impl Serialize) -> Result<Self, Failure> {
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

    fn finish(self) -> Result<(), Failure> {
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
    let file = File::create(path).map_err(|error| failed(path, error))?;
    Ok(Box::new(file))
}

/// Keeps a closed standard output recognisable; other errors name the file.
pub(super) fn failed(path: &Path, error: io::Error) -> Failure {
    if path == Path::new("-") {
        error.into()
    } else {
        format!("can't write {}: {error}", path.display()).into()
    }
}
