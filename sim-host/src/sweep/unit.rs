//! The result of one cell, and its file.

use super::seal::hash;
use crate::basin::{Basin, Column, Work};
use crate::ride::Effort;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The basin at one speed, as stored in a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Found {
    /// Height: largest disturbance that does not fall, in the interval around zero \[rad/s\].
    pub height: f64,
    /// Whether no ride fell up to the largest disturbance tried.
    pub capped: bool,
    /// Torques and work of the ride at `height`; null if `height` is 0.
    pub effort: Option<Effort>,
    /// Cause of the fall of the nearest ride beyond `height`: "roll", "steer", "laid-flat", "too-quick" or
    /// "no-motion"; null if none fell.
    pub fall: Option<String>,
}

/// The basin of one cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// The cell's identity.
    pub id: String,
    /// The full configuration.
    pub config: Value,
    /// The scenario that gives this result again.
    pub scenario: Value,
    /// Result at each speed of the search.
    pub found: Vec<Found>,
    /// Computing effort.
    pub work: Work,
}

/// A unit with its hash, as written.
#[derive(Serialize, Deserialize)]
struct Sealed<U> {
    sha256: String,
    unit: U,
}

impl Unit {
    /// Result of a cell from all of its columns, in the order of the search.
    pub fn new(id: &str, (config, scenario): (&Value, &Value), columns: Vec<Column>) -> Self {
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
            scenario: scenario.clone(),
            found: basin.columns.iter().map(found).collect(),
            work: basin.work(),
        }
    }

    /// Contents of the unit's file.
    pub(super) fn sealed(&self) -> String {
        let sealed = Sealed { sha256: hash(self), unit: self };
        serde_json::to_string_pretty(&sealed).unwrap_or_default() + "\n"
    }

    /// Parses a unit's file; `None` if it is damaged or has another identity than `id`.
    pub(super) fn unsealed(text: &str, id: &str) -> Option<Self> {
        let Sealed { sha256, unit } = serde_json::from_str::<Sealed<Self>>(text).ok()?;
        (unit.id == id && sha256 == hash(&unit)).then_some(unit)
    }
}
