//! The rider of a scenario: from a table and its use to the gains of a ride.

use super::content::{Content, NONE};
use super::error::ScenarioError;
use crate::range::within;
use crate::rider::{Fit, MAX_DELAY_S, Outside, Rider, RiderTable, catalogue};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The rider: a table of gains, and how it is used.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RiderChoice {
    /// Built-in name or file, or a file's content; absent or "none" for a rigid rider, hands off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<Content<RiderTable>>,
    /// Fit of the gains over speed; absent: mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gains: Option<Fit>,
    /// Neural delay, 0 to 1 \[s\]; absent: the table's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<f64>,
    /// Gains beyond the measured speeds; absent: extrapolate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outside: Option<Outside>,
}

impl From<String> for RiderChoice {
    fn from(name: String) -> Self {
        Self { table: Some(Content::Named(name)), ..Self::default() }
    }
}

/// A loaded rider.
#[derive(Clone, Debug)]
pub struct LoadedRider {
    /// The rider of a ride.
    pub rider: Rider,
    /// The table of its gains.
    pub table: RiderTable,
    /// Fit of the gains over speed.
    pub fit: Fit,
}

impl RiderChoice {
    /// The table; `None` without a rider.
    fn chosen(&self) -> Option<&Content<RiderTable>> {
        self.table.as_ref().filter(|table| table.name() != Some(NONE))
    }

    /// Whether there is a rider.
    pub fn is_some(&self) -> bool {
        self.chosen().is_some()
    }

    /// Loads the rider; `None` for a rigid one.
    ///
    /// # Errors
    /// The table can't be loaded, or gains can't be fitted to it; gains, delay or outside without a table.
    pub fn load(&self) -> Result<Option<LoadedRider>, ScenarioError> {
        let Some(table) = self.chosen() else {
            let alone = self.gains.is_some() || self.delay_s.is_some() || self.outside.is_some();
            return match self.table.is_none() && alone {
                true => {
                    Err(ScenarioError::value("rider.table", "gains, delay and outside need a rider's table"))
                }
                false => Ok(None),
            };
        };
        if let Some(delay_s) = self.delay_s {
            within("neural delay (s)", delay_s, 0.0, MAX_DELAY_S)
                .map_err(|e| ScenarioError::value("rider.delay_s", e))?;
        }
        let table = match table {
            Content::Named(name) => catalogue::load(name)?,
            Content::Given(table) => (**table).clone(),
        };
        let (fit, outside) = (self.gains.unwrap_or_default(), self.outside.unwrap_or_default());
        let rider = table.rider(fit, outside, self.delay_s).map_err(|error| ScenarioError::Fit {
            table: table.name.clone(),
            gains: fit.name(),
            error,
        })?;
        Ok(Some(LoadedRider { rider, table, fit }))
    }
}
