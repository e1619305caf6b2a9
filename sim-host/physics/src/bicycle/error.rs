//! Errors of bicycles: of their parameters and of their files.

use super::KEYS;
use super::combine::RIDER_KEYS;
use super::describe;
use crate::range::{RangeError, plain};
use std::path::PathBuf;

/// Supported schema version of a set's file.
pub(super) const SCHEMA: i64 = 1;

/// Reason why a bicycle cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BicycleError {
    /// Neither a shipped name nor a file.
    #[error("unknown bicycle `{name}`: no such file, and no such shipped set; shipped are {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The shipped names.
        known: String,
    },
    /// The file can't be read.
    #[error("can't read bicycle file {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The file's syntax is wrong.
    #[error("{path} {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The error, with its line.
        reason: FormatError,
    },
    /// The file has several sets, and no or an unknown name was given.
    #[error("{path} holds several sets; choose one with {path}#NAME, NAME one of {known}")]
    Collection {
        /// The file.
        path: PathBuf,
        /// Names of its sets.
        known: String,
    },
    /// A set has a wrong value or key.
    #[error("{set}: {reason}")]
    Set {
        /// The file, and the set's name in a collection.
        set: String,
        /// Key, value and range.
        reason: SetError,
    },
}

/// A bicycle that cannot exist.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// A value outside its range, or NaN.
    #[error("`{key}` = {} is out of range; it must be a number from {min} to {max} {unit}", plain(*.value))]
    Range {
        /// The parameter.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
        /// Unit of all three.
        unit: &'static str,
    },
    /// The inertia matrix of a body is not positive definite.
    #[error(
        "`{body}xz` = {xz} is too large for `{body}xx` = {xx} and `{body}zz` = {zz}: the inertia matrix is not positive \
         definite (allowed: |{body}xz| below {:.6})", (.xx * .zz).sqrt()
    )]
    NotPositiveDefinite {
        /// The matrix: "IB", "IH", "IR" or "IF".
        body: &'static str,
        /// Moment of inertia about x \[kg m^2\].
        xx: f64,
        /// Moment of inertia about z \[kg m^2\].
        zz: f64,
        /// Product of inertia \[kg m^2\].
        xz: f64,
    },
}

/// A value that is no number with or without uncertainty.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NumberError {
    /// Text of another form.
    #[error("`{0}` is not VALUE+/-STANDARD_DEVIATION")]
    Form(String),
    /// A negative standard deviation.
    #[error("`{0}`: a standard deviation is 0 or more")]
    Deviation(String),
    /// Another type.
    #[error("must be a number, not the {found} {value}")]
    Type {
        /// The type found.
        found: &'static str,
        /// The value.
        value: String,
    },
}

/// A wrong set of parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// The name of a set in a file that has one set without a name.
    #[error("holds one set without a name, not `{0}`; leave out #{0}")]
    OneSet(String),
    /// An unknown key.
    #[error("{}; the parameters are {}", unknown(.key, *.body), KEYS.join(", "))]
    Key {
        /// The key.
        key: String,
        /// The body that the key is about, if the model does not have it.
        body: Option<char>,
    },
    /// A missing parameter.
    #[error("`{key}` is missing; {}{}", describe(.key), hint(*.rider_alone))]
    Missing {
        /// The parameter.
        key: &'static str,
        /// Whether the file has the keys of a rider's body only.
        rider_alone: bool,
    },
    /// A key with a value of another type.
    #[error("`{key}` must be a {kind}, not the {found} {value}")]
    Type {
        /// The key.
        key: &'static str,
        /// The expected type.
        kind: &'static str,
        /// The type found.
        found: &'static str,
        /// The value.
        value: String,
    },
    /// An unknown version of the schema.
    #[error("`schema` = {0} is not known; this program reads {SCHEMA}")]
    Schema(String),
    /// A parameter that is no number.
    #[error("`{key}` {error}")]
    Number {
        /// The parameter.
        key: &'static str,
        /// The error.
        error: NumberError,
    },
    /// An unused key, or a key of a rider's body, that is no number.
    #[error("`{key}`: {error}")]
    OtherNumber {
        /// The key.
        key: String,
        /// The error.
        error: NumberError,
    },
    /// A bicycle that cannot exist.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Values with uncertainties that are not those without.
    #[error("`measured` and `parameters` have different values")]
    Measured,
    /// Masses of the parts of H that are not that of H \[kg\].
    #[error(
        "mG = {g} and mS = {s} kg, but mH = {h} kg: G and S are the parts of H, so that mG + mS must equal mH"
    )]
    Parts {
        /// Handlebar.
        g: f64,
        /// Fork.
        s: f64,
        /// Both.
        h: f64,
    },
    /// An unknown key of a rider's body.
    #[error("unknown key `{0}`; a rider's body has {keys}", keys = RIDER_KEYS.join(", "))]
    RiderKey(String),
    /// A missing key of a rider's body.
    #[error("`{0}` is missing")]
    RiderMissing(&'static str),
    /// A value of a rider's body outside its range.
    #[error(transparent)]
    RiderRange(#[from] RangeError),
    /// A rider on a bicycle that has one.
    #[error("the bicycle {0} has a rider already (rider_included = true)")]
    HasRider(String),
}

fn unknown(key: &str, body: Option<char>) -> String {
    body.map_or(format!("unknown key `{key}`"), |body| {
        format!(
            "`{key}` belongs to a body `{body}`; the model has the bodies B, F, H and R, and G and S as parts of H"
        )
    })
}

const fn hint(rider_alone: bool) -> &'static str {
    match rider_alone {
        true => "; the file holds a rider's body alone; give it after a bicycle: BICYCLE+FILE",
        false => "",
    }
}

/// A file whose text is not of its format.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// Not of the format that the file's ending names.
    #[error("is not valid {format}: {reason}")]
    Invalid {
        /// The format.
        format: &'static str,
        /// The parser's message.
        reason: String,
    },
    /// A set in YAML, which only a build with the feature `yaml` reads.
    #[error("this build reads no YAML: build sim-host with `--features full`")]
    NoYaml,
    /// A line without a key and a value.
    #[error("line {line}: `{text}`: expected KEY = VALUE")]
    Line {
        /// Its number, from 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// A line with a wrong value.
    #[error("line {line}: `{text}`: {error}")]
    Number {
        /// Its number, from 1.
        line: usize,
        /// The line.
        text: String,
        /// The error.
        error: NumberError,
    },
    /// A key listed twice.
    #[error("line {line}: `{text}`: the key is listed twice")]
    Twice {
        /// Its number, from 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// Values of another type.
    #[error("`values` must be a mapping")]
    NoMapping,
    /// An unknown parameterization.
    #[error("has parameterization `{found}`, which is not known; {known} are (Meijaard et al. 2007)")]
    Parameterization {
        /// The name found.
        found: String,
        /// The known names.
        known: String,
    },
}

/// A change of a bicycle that is not possible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VariationError {
    /// A key that is no parameter.
    #[error("`{0}`: no such parameter; there are {keys}", keys = KEYS.join(", "))]
    Key(String),
    /// A parameter to which a rider's body contributes.
    #[error("{key}={value}: it combines frame and rider; change their files")]
    Combined {
        /// The parameter.
        key: String,
        /// The value.
        value: f64,
    },
    /// The changed bicycle cannot exist.
    #[error("{name}: {error}")]
    Parameter {
        /// The bicycle with the changes.
        name: String,
        /// The error.
        error: ParameterError,
    },
}
