//! Reads a recorded ride from a file into columns; a map assigns them to sensors later.
//!
//! Formats: text tables, CAN logs (candump, ASC) and MDF 4; recognised by the first bytes and lines.

pub mod asc;
pub mod bits;
pub mod candump;
pub mod dbc;
pub mod decode;
pub mod frames;
pub mod mdf;
mod remarks;
pub(crate) mod stamp;
pub mod table;

use dbc::Database;
use frames::Frames;
use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

/// A recorded ride with the names, units and numbers of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Columns sampled together: one group for a table, one per message of a bus.
    pub groups: Vec<Group>,
    /// Data that is unusable as it is, in the order of the file.
    pub remarks: Vec<Remark>,
}

/// Columns of the same length; the values of one row were recorded together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// The message's or channel group's name; empty for a table.
    pub name: String,
    /// Time of each row \[s\], if the format has one; in a table a column has it.
    pub times_s: Option<Vec<f64>>,
    /// Line of each row, from 1; empty where the format has no lines.
    pub lines: Vec<u64>,
    /// The columns.
    pub columns: Vec<Column>,
}

/// One column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Its name in the file.
    pub name: String,
    /// The unit in the file; empty without one.
    pub unit: String,
    /// Its values in that unit, one per row; NaN where the row has none.
    pub values: Vec<f64>,
}

/// Data in the file that is unusable as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// The line, from 1, if the format has lines.
    pub line: Option<u64>,
    /// The column's name, if the remark concerns one.
    pub column: Option<String>,
    /// The problem, and how it was handled.
    pub what: String,
}

impl Remark {
    /// A remark about the whole file.
    fn of_file(what: String) -> Self {
        Self { line: None, column: None, what }
    }
}

impl Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        if let Some(column) = &self.column {
            write!(f, "{column}: ")?;
        }
        f.write_str(&self.what)
    }
}

/// Why a file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be read.
    #[error("can't read {}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: std::io::Error,
    },
    /// The file has no usable data, or an error that must not be skipped.
    #[error("{}: {remark}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// The problem and its position.
        remark: Remark,
    },
}

/// Options of reading.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Reject a file at the first [`Remark`] instead of using the rest.
    pub strict: bool,
    /// The databases that decode CAN frames.
    pub dbc: Vec<PathBuf>,
}

/// Reads a recording. Its content determines the format, not its name.
///
/// The databases of the options decode CAN frames to groups: one per message, its signals as columns in the database's
/// units, with the file's times. Frames that are in no database become remarks.
///
/// # Errors
/// The file, with the line if there is one; CAN frames without a database, or with databases that decode none of them;
/// an unreadable database.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, RecordingError> {
    let bytes = std::fs::read(path)
        .and_then(|bytes| unpacked(path, bytes))
        .map_err(|error| RecordingError::Read { path: path.to_owned(), error })?;
    let content = |remark| RecordingError::Content { path: path.to_owned(), remark };
    let databases = options.dbc.iter().map(|path| database(path)).collect::<Result<Vec<_>, _>>()?;
    let recording = of_bytes(&bytes, &databases, &options.dbc).map_err(content)?;
    match recording.remarks.first() {
        Some(first) if options.strict => Err(content(first.clone())),
        _ => Ok(recording),
    }
}

/// Parses the bytes of a file; `names` are the paths of the databases.
fn of_bytes(bytes: &[u8], databases: &[Database], names: &[PathBuf]) -> Result<Recording, Remark> {
    let (decoded, frames) = if mdf::is_one(bytes) {
        let mdf::Content { groups, frames, remarks } = mdf::parse(bytes)?;
        (Recording { groups, remarks }, frames)
    } else if bytes.starts_with(b"LOGG") {
        let what = "is a log of Vector's in binary (BLF), which is not read; convert it to ASC";
        return Err(Remark::of_file(what.to_owned()));
    } else {
        let text = String::from_utf8_lossy(bytes);
        if candump::is_one(&text) {
            (Recording::default(), candump::parse(&text)?)
        } else if asc::is_one(&text) {
            (Recording::default(), asc::parse(&text)?)
        } else {
            (table::parse(&text)?, Frames::default())
        }
    };
    with_frames(decoded, &frames, databases, names)
}

/// Adds the decoded frames to a recording.
fn with_frames(
    mut recording: Recording,
    frames: &Frames,
    databases: &[Database],
    names: &[PathBuf],
) -> Result<Recording, Remark> {
    const GIVE: &str = "give the database that decodes them with --dbc FILE";
    let shown = |paths: &mut dyn Iterator<Item = &PathBuf>| {
        paths.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
    };
    recording.remarks.extend(frames.remarks.iter().cloned());
    if databases.is_empty() {
        if !frames.is_empty() {
            let remark = Remark::of_file(format!("has {} frames of CAN; {GIVE}", frames.len()));
            if recording.groups.is_empty() {
                return Err(remark);
            }
            recording.remarks.push(remark);
        }
        return Ok(recording);
    }
    let decoded = decode::groups(frames, databases);
    if decoded.groups.is_empty() {
        let what = match frames.is_empty() {
            true => "has no frame of CAN to decode by".to_owned(),
            false => format!("has {} frames of CAN, and none is decoded by", frames.len()),
        };
        return Err(Remark::of_file(format!("{what} {}", shown(&mut names.iter()))));
    }
    let idle: Vec<&PathBuf> =
        names.iter().zip(&decoded.used).filter(|(_, used)| **used == 0).map(|(name, _)| name).collect();
    if !idle.is_empty() {
        let what = format!("no frame of it is decoded by {}", shown(&mut idle.into_iter()));
        recording.remarks.push(Remark::of_file(what));
    }
    recording.remarks.extend(decoded.remarks);
    recording.groups.extend(decoded.groups);
    Ok(recording)
}

/// Reads a database.
fn database(path: &Path) -> Result<Database, RecordingError> {
    let bytes = std::fs::read(path).map_err(|error| RecordingError::Read { path: path.to_owned(), error })?;
    Database::parse(&bytes).map_err(|remark| RecordingError::Content { path: path.to_owned(), remark })
}

/// The bytes of a file, decompressed if necessary.
fn unpacked(path: &Path, bytes: Vec<u8>) -> std::io::Result<Vec<u8>> {
    const GZIP: [u8; 2] = [0x1f, 0x8b];
    if !bytes.starts_with(&GZIP) {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::MultiGzDecoder::new(bytes.as_slice()), &mut plain)
        .map_err(|error| std::io::Error::new(error.kind(), format!("{}: gzip: {error}", path.display())))?;
    Ok(plain)
}
