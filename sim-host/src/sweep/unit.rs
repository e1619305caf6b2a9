//! The result of one cell, and its file.

use super::DoneColumn;
use crate::basin::{Column, Work};
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

impl Found {
    /// The result of a column.
    pub(super) fn of(column: &Column) -> Self {
        Self {
            height: column.upper,
            capped: column.capped,
            effort: column.border.map(|ride| ride.effort),
            fall: column.beyond.map(|cause| cause.name().into()),
        }
    }
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

impl Unit {
    /// Result of a cell from all of its columns, in the order of the search.
    pub fn new(id: &str, (config, scenario): (&Value, &Value), columns: Vec<DoneColumn>) -> Self {
        Self {
            id: id.into(),
            config: config.clone(),
            scenario: scenario.clone(),
            work: columns.iter().fold(Work::default(), |sum, column| sum.plus(&column.work)),
            found: columns.into_iter().map(|column| column.found).collect(),
        }
    }
}
