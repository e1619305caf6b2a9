//! Remarks about a file: the first few of each kind are listed, the rest counted by column.

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

/// The remarks so far, and the number of each kind that are not listed, by column.
#[derive(Debug, Default)]
pub(super) struct Remarks {
    listed: Vec<Remark>,
    counts: Vec<Count>,
}

/// Remarks of one kind about one column, or about none.
#[derive(Debug)]
struct Count {
    kind: &'static str,
    column: Option<String>,
    listed: u64,
    more: u64,
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
        let same = |count: &Count| count.kind == kind && count.column.as_deref() == column;
        let place = self.counts.iter().position(same).unwrap_or_else(|| {
            self.counts.push(Count { kind, column: column.map(str::to_owned), listed: 0, more: 0 });
            self.counts.len() - 1
        });
        let listed: u64 =
            self.counts.iter().filter(|count| count.kind == kind).map(|count| count.listed).sum();
        if listed < LISTED {
            self.counts[place].listed += 1;
            self.listed.push(Remark { line, column: column.map(str::to_owned), what: what() });
        } else {
            self.counts[place].more += 1;
        }
    }

    /// All remarks, with the number of unlisted ones.
    pub(super) fn done(mut self) -> Vec<Remark> {
        for Count { kind, column, more, .. } in self.counts.into_iter().filter(|count| count.more > 0) {
            self.listed.push(Remark { line: None, column, what: format!("{more} more {kind}") });
        }
        self.listed
    }
}
