//! From a scenario to the conditions of its rides, with warnings on standard error.

use super::options::{Chosen, Settings};
use super::outputs::{complain_once, print};
use super::scenario_error::named;
use super::{Ended, Failure, warn};
use crate::bicycle::Parameters;
use crate::bicycle::uncertain::Measured;
use crate::report::resolved::ResolvedConfig;
use crate::ride::Conditions;
use crate::scenario::{LoadedRider, Resolved, Scenario};

/// What a command needs of its scenario.
pub(super) struct Setup {
    pub(super) conditions: Conditions,
    pub(super) config: ResolvedConfig,
    pub(super) parameters: Parameters,
    pub(super) measured: Option<Measured>,
    pub(super) rider: Option<LoadedRider>,
    /// The scenario that reproduces the result.
    pub(super) scenario: Scenario,
}

/// Loads and checks all conditions of a scenario.
pub(super) fn setup(scenario: &Scenario) -> Result<Setup, Failure> {
    let resolved = scenario.resolve().map_err(|e| named(scenario, &e))?;
    warn(&resolved.bicycle);
    resolved.notes.iter().for_each(|note| complain_once(&format!("note: {note}")));
    resolved.warnings.iter().for_each(|warning| complain_once(&format!("warning: {warning}")));
    let config = ResolvedConfig::new(&resolved);
    let Resolved { conditions, bicycle, rider, scenario, .. } = resolved;
    let (parameters, measured) = (bicycle.parameters, bicycle.measured);
    Ok(Setup { conditions, config, parameters, measured, rider, scenario })
}

/// Prints the scenario, if that is requested.
pub(super) fn printed<S: Settings>(
    chosen: &Chosen<S>,
    scenario: &Scenario,
) -> Result<Option<Ended>, Failure> {
    if !chosen.print_scenario {
        return Ok(None);
    }
    scenario.resolve().map_err(|e| named(scenario, &e))?;
    print(&scenario.to_toml()?)?;
    Ok(Some(Ended::Done))
}
