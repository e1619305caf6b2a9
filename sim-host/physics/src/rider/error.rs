//! Errors of rider files.

use super::ScheduleError;
use super::table::SCHEMA;
use crate::range::RangeError;
use std::path::PathBuf;

/// Reason why a rider cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RiderError {
    /// Neither a shipped name nor a file.
    #[error("unknown rider `{name}`: no such file, and no such shipped rider; shipped are {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The shipped names.
        known: String,
    },
    /// The file can't be read.
    #[error("can't read rider file {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The file is not TOML, or a key is missing, unknown or of a wrong type.
    #[error("rider file {path}: {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line and column.
        reason: String,
    },
    /// A value is wrong.
    #[error("rider file {path}: {reason}")]
    Table {
        /// The file.
        path: PathBuf,
        /// Key or row, value and range.
        reason: TableError,
    },
}

/// A wrong value in a table of measured gains.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// An unknown version of the schema.
    #[error("`schema` = {0} is not known; this program reads {SCHEMA}")]
    Schema(u32),
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A neuromuscular parameter outside its range.
    #[error("`neuromuscular`: {0}")]
    Neuromuscular(RangeError),
    /// A column that no table has.
    #[error("`columns`: unknown column `{column}`; known are {known}")]
    UnknownColumn {
        /// The column.
        column: String,
        /// The known ones.
        known: String,
    },
    /// A column listed twice.
    #[error("`columns`: `{0}` is listed twice")]
    RepeatedColumn(String),
    /// No column of speeds.
    #[error("`columns`: `speed_m_s` is missing")]
    NoSpeed,
    /// No column of a gain.
    #[error("`columns`: no gains; known are {known}")]
    NoGains {
        /// The known gains.
        known: String,
    },
    /// A regression of something that has no column.
    #[error("`regression`: `{key}` is not a gain with a column ({gains})")]
    RegressionKey {
        /// The key.
        key: String,
        /// The gains with a column.
        gains: String,
    },
    /// A gain without its regression.
    #[error("`regression`: `{0}` is missing")]
    RegressionMissing(&'static str),
    /// Not one covariance for each row.
    #[error("`covariances` has {matrices} matrices for {rows} `rows`; a row without one has an empty list")]
    Covariances {
        /// The number of matrices.
        matrices: usize,
        /// The number of rows.
        rows: usize,
    },
    /// Covariances of nested gains, of which products are stored.
    #[error(
        "`covariances` of gains with `feedback` = \"nested\" are not supported; multiply the loops out first"
    )]
    NestedCovariances,
    /// A wrong row.
    #[error("row {row}: {error}")]
    Row {
        /// Its number, from 1.
        row: usize,
        /// The error.
        error: RowError,
    },
    /// A best run that no row has.
    #[error("`best_runs`: no row has run {0}")]
    BestRun(u32),
    /// Not one best run in a group.
    #[error("`best_runs` names {rows} rows of the group at {speed_m_s} m/s; it must be one of each group")]
    BestRuns {
        /// The number of rows.
        rows: usize,
        /// Speed of the group \[m/s\].
        speed_m_s: f64,
    },
    /// The means of the groups are no schedule.
    #[error("means of groups: {0}")]
    Means(ScheduleError),
}

/// A wrong row of a table of measured gains.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RowError {
    /// More or fewer values than columns.
    #[error("{values} values for {columns} columns ({names})")]
    Length {
        /// Number of values.
        values: usize,
        /// Number of columns.
        columns: usize,
        /// Their names.
        names: String,
    },
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A wrong covariance.
    #[error("`covariances`: {0}")]
    Covariance(#[from] CovarianceError),
    /// A number that must be whole.
    #[error("`{key}` = {value} is not a whole number")]
    NotWhole {
        /// The column.
        key: String,
        /// The value.
        value: f64,
    },
    /// A speed below that of the row before.
    #[error("`speed_m_s` = {speed_m_s} after {before_m_s}: rows must be sorted by speed")]
    Speed {
        /// The speed \[m/s\].
        speed_m_s: f64,
        /// The speed before it \[m/s\].
        before_m_s: f64,
    },
    /// A group below that of the row before.
    #[error("`group` = {group} after {before}: groups must rise with speed")]
    Group {
        /// The group.
        group: u32,
        /// The group before it.
        before: u32,
    },
}

/// Reason why a matrix is not the covariance of a set of gains.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CovarianceError {
    /// More or fewer rows or columns than gains.
    #[error("{rows} x {columns} values, but {gains} gains need {gains} x {gains}")]
    Shape {
        /// Number of gains.
        gains: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns of the first wrong row.
        columns: usize,
    },
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Not symmetric.
    #[error("{pair} = {above}, but {below} across the diagonal; a covariance is symmetric")]
    Asymmetric {
        /// The two gains.
        pair: String,
        /// The value.
        above: f64,
        /// The value across the diagonal.
        below: f64,
    },
}

/// Reason why several tables are not one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// No tables.
    #[error("no tables to merge")]
    None,
    /// Tables that differ in what the sets of a table share.
    #[error("riders `{first}` and `{other}` differ in {what}: {value} and {other_value}")]
    Differs {
        /// The first table's name.
        first: String,
        /// The other table's name.
        other: String,
        /// What differs.
        what: &'static str,
        /// The first table's value.
        value: String,
        /// The other table's value.
        other_value: String,
    },
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
}

/// A table from which no riders can be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "rider `{rider}`: row {row}, at {speed_m_s} m/s, has no covariance, and there is one set alone at {alone_m_s} m/s; \
     drawn riders need `covariances` of all rows, or several sets in each group"
)]
pub struct DrawError {
    /// The table's name.
    pub rider: String,
    /// Number of the first row without a covariance, from 1.
    pub row: usize,
    /// Its speed \[m/s\].
    pub speed_m_s: f64,
    /// Speed of the first group of one set \[m/s\].
    pub alone_m_s: f64,
}
