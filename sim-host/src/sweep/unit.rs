//! The result of one cell, and its file.

use super::seal::hash;
use crate::basin::{Basin, Column, Work};
use crate::ride::Effort;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The basin at one speed, as a sweep keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Found {
    /// Largest disturbance of the interval around zero that does not fall \[rad/s\].
    pub height: f64,
    /// Whether nothing fell up to the largest disturbance tried.
    pub capped: bool,
    /// What the ride at `height` took; null if that is 0.
    pub effort: Option<Effort>,
    /// What made the nearest ride beyond `height` count as fallen: "roll", "steer", "laid-flat", "too-quick" or
    /// "no-motion"; null if nothing fell.
    pub fall: Option<String>,
}

/// The basin of one cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// The cell's identity.
    pub id: String,
    /// The full configuration.
    pub config: Value,
    /// Per speed of the search.
    pub found: Vec<Found>,
    /// What it took.
    pub work: Work,
}

/// A unit with its hash, as it is written.
#[derive(Serialize, Deserialize)]
struct Sealed<U> {
    sha256: String,
    unit: U,
}

impl Unit {
    /// The result of a cell whose columns are all there, in the order of the search.
    pub fn new(id: &str, config: &Value, columns: Vec<Column>) -> Self {
        let basin = Basin { columns };
        let found = |c: &Column| Found {
            height: c.upper,
            capped: c.capped,
            effort: c.border.map(|ride| ride.effort),
            fall: c.beyond.map(|cause| cause.name().into()),
        };
        Self {
            id: id.into(),
            config: config.clone(),
            found: basin.columns.iter().map(found).collect(),
            work: basin.work(),
        }
    }

    /// Its file's content.
    pub(super) fn sealed(&self) -> String {
        let sealed = Sealed { sha256: hash(self), unit: self };
        serde_json::to_string_pretty(&sealed).unwrap_or_default() + "\n"
    }

    /// The unit in a file, if it is whole and the one of `id`.
    pub(super) fn unsealed(text: &str, id: &str) -> Option<Self> {
        let Sealed { sha256, unit } = serde_json::from_str::<Sealed<Self>>(text).ok()?;
        (unit.id == id && sha256 == hash(&unit)).then_some(unit)
    }
}
