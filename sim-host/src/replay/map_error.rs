//! Errors of maps from columns to sensors.

use std::io;

/// A map that can't be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Neither a built-in map nor a readable file.
    #[error("can't read the map {name}: {error}; built-in maps are {known}")]
    Read {
        /// As given.
        name: String,
        /// The system's error.
        error: io::Error,
        /// The built-in maps.
        known: String,
    },
    /// Its content is wrong.
    #[error("{name}: {error}")]
    Content {
        /// Name or file.
        name: String,
        /// The error.
        error: Box<MapTextError>,
    },
}

/// Columns that fit no built-in map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnsError {
    /// Those of `ride --csv`: the motion, not the samples of the sensors.
    #[error(
        "this is the table of `ride --csv`, which lacks the samples of the sensors; `ride --frames FILE` writes them"
    )]
    Ride,
    /// Others.
    #[error("no built-in map has these columns; give one with --map")]
    Unknown,
}

/// Text that is no map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapTextError {
    /// Not TOML, or a key is missing, unknown or of a wrong type: the parser's message.
    #[error("{0}")]
    Syntax(String),
    /// An unknown unit of the time.
    #[error("time: {0}")]
    TimeUnit(UnitError),
    /// A rate outside its range \[Hz\].
    #[error("time: rate_hz = {0} is outside 0.01 to 100000")]
    Rate(f64),
    /// Neither a column nor a rate, or both.
    #[error("time: either column or rate_hz must be there")]
    Time,
    /// A wrong signal.
    #[error("{key}: {error}")]
    Signal {
        /// The sensor's key.
        key: String,
        /// The error.
        error: SignalError,
    },
}

/// A wrong signal in a map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SignalError {
    /// Another number of columns than the sensor has axes.
    #[error("columns: {given} given, expected {expected}")]
    Columns {
        /// Number of columns.
        given: usize,
        /// Number of axes.
        expected: usize,
    },
    /// An unknown unit.
    #[error(transparent)]
    Unit(#[from] UnitError),
    /// A number too large.
    #[error("{key} = {value} is outside -{most} to {most}")]
    Range {
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Largest magnitude.
        most: f64,
    },
    /// A scale of zero.
    #[error("scale = 0 is not allowed")]
    Scale,
    /// A delay outside its range \[s\].
    #[error("late_s = {0} is outside 0 to 1")]
    Late(f64),
    /// Axes of a sensor that does not have three.
    #[error("axes: only allowed for a sensor with three axes")]
    NoAxes,
    /// An unknown axis.
    #[error("axes: `{0}`: expected one of x, y, z, -x, -y, -z")]
    Axis(String),
    /// An axis named twice.
    #[error("axes: {0:?} names an axis twice")]
    Twice([String; 3]),
    /// A mirror image.
    #[error("axes: {0:?} is left-handed (a mirror image), which no orientation is; change a sign")]
    LeftHanded([String; 3]),
}

/// A unit that the quantity does not have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("unit = \"{unit}\": expected one of {known}")]
pub struct UnitError {
    /// As given.
    pub unit: String,
    /// The quantity's units.
    pub known: String,
}
