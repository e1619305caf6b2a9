//! Remarks about a file: the first few of each kind are listed, the rest counted.

use std::fmt::{self, Display};

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
    pub(crate) fn of_file(what: String) -> Self {
        Self { line: None, column: None, what }
    }

    /// A remark about a column, or about the whole file, without a line.
    pub(crate) fn of_column(column: Option<&str>, what: String) -> Self {
        Self { line: None, column: column.map(str::to_owned), what }
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

/// Most remarks of one kind that are listed.
const LISTED: u64 = 3;

/// The remarks so far, and the number of each kind.
#[derive(Debug, Default)]
pub(super) struct Remarks {
    listed: Vec<Remark>,
    counts: Vec<(&'static str, u64)>,
}

impl Remarks {
    /// Adds a remark. `kind` describes the unlisted ones of the same kind.
    pub(super) fn add(
        &mut self,
        kind: &'static str,
        line: Option<u64>,
        column: Option<&str>,
        what: impl FnOnce() -> String,
    ) {
        let place = self.counts.iter().position(|(other, _)| *other == kind).unwrap_or_else(|| {
            self.counts.push((kind, 0));
            self.counts.len() - 1
        });
        self.counts[place].1 += 1;
        if self.counts[place].1 <= LISTED {
            self.listed.push(Remark { line, column: column.map(str::to_owned), what: what() });
        }
    }

    /// All remarks, with the number of unlisted ones.
    pub(super) fn done(mut self) -> Vec<Remark> {
        for (kind, count) in self.counts.into_iter().filter(|(_, count)| *count > LISTED) {
            self.listed.push(Remark::of_file(format!("{} more {kind}", count - LISTED)));
        }
        self.listed
    }
}
