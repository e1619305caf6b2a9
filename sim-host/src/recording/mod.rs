//! What a file with a recorded ride holds, column by column, before a map says what the columns mean.

mod remarks;
pub mod table;

use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

/// A recorded ride as the file has it: names, units and numbers of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Columns that were sampled together: one group for a table, one for each message of a bus.
    pub groups: Vec<Group>,
    /// What could not be used as it stands, in the order of the file.
    pub remarks: Vec<Remark>,
}

/// Columns of the same length, whose values of one row were recorded together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// The message's or channel group's name; empty for a table.
    pub name: String,
    /// When each row was recorded \[s\], where the format itself says so; in a table a column does.
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
    /// The unit that the file states; empty where it states none.
    pub unit: String,
    /// Its values in that unit, one a row; NaN where the row has none.
    pub values: Vec<f64>,
}

/// Something in the file that can't be used as it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// The line, from 1, where there are lines.
    pub line: Option<u64>,
    /// The column's name, if it is about one.
    pub column: Option<String>,
    /// What is wrong, and what was done.
    pub what: String,
}

impl Remark {
    /// One about the file as a whole.
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

/// A file that can't be used.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// It can't be read.
    #[error("can't read {}: {why}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        why: std::io::Error,
    },
    /// It was read, and holds nothing that can be used, or something that must not be passed over.
    #[error("{}: {remark}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        remark: Remark,
    },
}

/// How a file is read.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Refuse a file for the first [`Remark`] instead of using the rest of it.
    pub strict: bool,
    /// The databases that decode the frames of a bus.
    pub dbc: Vec<PathBuf>,
}

/// Reads a recording; which kind it is, its name and its first bytes say.
///
/// # Errors
/// The file, and where it names a line what is wrong there.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, RecordingError> {
    let bytes = std::fs::read(path)
        .and_then(|bytes| unpacked(path, bytes))
        .map_err(|why| RecordingError::Read { path: path.to_owned(), why })?;
    let content = |remark| RecordingError::Content { path: path.to_owned(), remark };
    let recording = table::parse(&String::from_utf8_lossy(&bytes)).map_err(content)?;
    match recording.remarks.first() {
        Some(first) if options.strict => Err(content(first.clone())),
        _ => Ok(recording),
    }
}

/// The bytes of a file, unpacked if they are packed.
fn unpacked(path: &Path, bytes: Vec<u8>) -> std::io::Result<Vec<u8>> {
    const GZIP: [u8; 2] = [0x1f, 0x8b];
    if !bytes.starts_with(&GZIP) {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::MultiGzDecoder::new(bytes.as_slice()), &mut plain)
        .map_err(|why| std::io::Error::new(why.kind(), format!("{}: gzip: {why}", path.display())))?;
    Ok(plain)
}
