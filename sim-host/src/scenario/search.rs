//! The search of a scenario: speeds, disturbance and resolution of a basin.

use super::error::ScenarioError;
use super::speeds::{self, SpeedsError};
use crate::basin::{Axis, Method, Rounds, Search};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Speeds of the basins: a range as text, a list, or one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "speeds: \"A:B:STEP\" in m/s, a list of numbers, or one number")]
pub enum Speeds {
    /// `A:B:STEP` with B included, or one speed \[m/s\].
    Range(String),
    /// Each speed \[m/s\].
    List(Vec<f64>),
    /// One speed \[m/s\].
    One(f64),
}

impl Speeds {
    /// The speeds \[m/s\].
    ///
    /// # Errors
    /// States the speed or range, and what is allowed.
    pub fn list(&self) -> Result<Vec<f64>, SpeedsError> {
        match self {
            Self::Range(text) => speeds::parse(text),
            Self::List(speeds) => Ok(speeds.clone()),
            Self::One(speed) => Ok(vec![*speed]),
        }
    }
}

/// Range and resolution of a basin's search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SearchChoice {
    /// Forward speeds; absent: 0:10:0.1, and with a rider 2:7.5:0.1, where gains are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speeds: Option<Speeds>,
    /// Rate that is disturbed at t = 0.
    pub axis: Axis,
    /// Largest disturbance tried \[rad/s\].
    pub max_rate: f64,
    /// Step of the scan \[rad/s\].
    pub scan_step: f64,
    /// Accuracy of the borders \[rad/s\].
    pub tolerance: f64,
    /// How the rides are simulated.
    pub method: Method,
    /// Of `basin`: further speeds are added halfway between others until the outline deviates from straight lines by at
    /// most this part of the largest height, 0.0001 to 1; absent: the given speeds only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adaptive_speeds: Option<f64>,
}

impl Default for SearchChoice {
    fn default() -> Self {
        Self {
            speeds: None,
            axis: Axis::SteerRate,
            max_rate: 30.0,
            scan_step: 0.25,
            tolerance: 0.01,
            method: Method::Fast,
            adaptive_speeds: None,
        }
    }
}

impl SearchChoice {
    /// The checked search; `ridden` selects the default speeds.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn resolve(&self, ridden: bool) -> Result<Search, ScenarioError> {
        let default = Speeds::Range(if ridden { "2:7.5:0.1" } else { "0:10:0.1" }.into());
        let speeds = self.speeds.as_ref().unwrap_or(&default);
        let search = Search {
            speeds: speeds.list().map_err(|e| ScenarioError::value("search.speeds", e))?,
            axis: self.axis,
            max_rate: self.max_rate,
            scan_step: self.scan_step,
            tolerance: self.tolerance,
            method: self.method,
            efforts: true,
        };
        search.check()?;
        if self.adaptive_speeds.is_some() && search.speeds.len() < 2 {
            let reason = "speeds are added between two or more, and search.speeds has one";
            return Err(ScenarioError::value("search.adaptive_speeds", reason));
        }
        Rounds { adaptive: self.adaptive_speeds, ..Rounds::default() }.check()?;
        Ok(search)
    }
}
