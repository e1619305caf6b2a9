//! Reads a file of any of the formats, and decodes its CAN frames.

use super::database::Database;
use super::frames::Frames;
use super::{Recording, Remark, asc, blf, candump, decode, mdf, table};
use crate::input_file::{self, LARGEST_RECORDING, LARGEST_TEXT};
use std::path::{Path, PathBuf};

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

impl RecordingError {
    /// The message for a text that names `file` already: without that name, or with the name of another file.
    pub fn beside(&self, file: &Path) -> String {
        match self {
            Self::Read { path, error } if path == file => format!("can't be read: {error}"),
            Self::Content { path, remark } if path == file => remark.to_string(),
            other => other.to_string(),
        }
    }
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
    let bytes = bytes(path)?;
    let content = |remark| RecordingError::Content { path: path.to_owned(), remark };
    let databases = options.dbc.iter().map(|path| database(path)).collect::<Result<Vec<_>, _>>()?;
    let recording = of_bytes(&bytes, &databases, &options.dbc).map_err(content)?;
    match recording.remarks.first() {
        Some(first) if options.strict => Err(content(first.clone())),
        _ => Ok(recording),
    }
}

/// Reads the CAN frames of a recording, without decoding them. Its content determines the format, not its name.
///
/// # Errors
/// The file, with the line if there is one; a file without frames.
pub fn frames(path: &Path) -> Result<Frames, RecordingError> {
    let bytes = bytes(path)?;
    let frames = undecoded(&bytes).and_then(|(_, frames)| match frames.is_empty() {
        true => Err(Remark::of_file("has no frame of CAN".to_owned())),
        false => Ok(frames),
    });
    frames.map_err(|remark| RecordingError::Content { path: path.to_owned(), remark })
}

/// Parses the bytes of a file; `names` are the paths of the databases.
fn of_bytes(bytes: &[u8], databases: &[Database], names: &[PathBuf]) -> Result<Recording, Remark> {
    let (decoded, frames) = undecoded(bytes)?;
    with_frames(decoded, &frames, databases, names)
}

/// The columns and the CAN frames of a file.
fn undecoded(bytes: &[u8]) -> Result<(Recording, Frames), Remark> {
    Ok(if mdf::is_one(bytes) {
        let mdf::Content { groups, frames, remarks } = mdf::parse(bytes)?;
        (Recording { groups, remarks }, frames)
    } else if blf::is_one(bytes) {
        (Recording::default(), blf::parse(bytes)?)
    } else {
        let text = String::from_utf8_lossy(bytes);
        let (mut recording, frames) = if candump::is_one(&text) {
            (Recording::default(), candump::parse(&text)?)
        } else if asc::is_one(&text) {
            (Recording::default(), asc::parse(&text)?)
        } else {
            (table::parse(&text)?, Frames::default())
        };
        let cut = cut_line(&text);
        let mut known = recording.remarks.iter().chain(&frames.remarks);
        if cut.is_some() && !known.any(|remark| remark.line == cut.as_ref().and_then(|cut| cut.line)) {
            recording.remarks.extend(cut);
        }
        (recording, frames)
    })
}

/// A remark on a last line without its end, which may be cut within its last value; the line is used as it is, as
/// some loggers never end it.
pub fn cut_line(text: &str) -> Option<Remark> {
    let line = text.lines().count() as u64;
    let what = "the last line has no end; if the file was cut, its last value may be truncated".to_owned();
    let cut = !text.is_empty() && !text.ends_with(['\n', '\r']);
    cut.then_some(Remark { line: Some(line), column: None, what })
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
    let bytes = input_file::bytes(path, LARGEST_TEXT)
        .map_err(|error| RecordingError::Read { path: path.to_owned(), error })?;
    parsed(&bytes).map_err(|remark| RecordingError::Content { path: path.to_owned(), remark })
}

#[cfg(feature = "dbc")]
fn parsed(bytes: &[u8]) -> Result<Database, Remark> {
    Database::parse(bytes)
}

#[cfg(not(feature = "dbc"))]
fn parsed(_: &[u8]) -> Result<Database, Remark> {
    Err(Remark::of_file("this build reads no CAN database: build sim-host with `--features full`".to_owned()))
}

/// The bytes of a file, decompressed if necessary.
fn bytes(path: &Path) -> Result<Vec<u8>, RecordingError> {
    input_file::bytes(path, LARGEST_RECORDING)
        .and_then(unpacked)
        .map_err(|error| RecordingError::Read { path: path.to_owned(), error })
}

fn unpacked(bytes: Vec<u8>) -> std::io::Result<Vec<u8>> {
    const GZIP: [u8; 2] = [0x1f, 0x8b];
    if !bytes.starts_with(&GZIP) {
        return Ok(bytes);
    }
    input_file::within(flate2::read::MultiGzDecoder::new(bytes.as_slice()), LARGEST_RECORDING)
        .map_err(|error| std::io::Error::new(error.kind(), format!("gzip: {error}")))
}
