//! A recording: groups of columns, with the names, units and numbers of the file.

use super::Remark;

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
