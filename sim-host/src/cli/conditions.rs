//! From a scenario to the conditions of its rides, with warnings on standard error.

use super::options::{Chosen, Settings};
use super::outputs::{complain_once, print};
use super::scenario_error::named;
use super::{Ended, Failure};
use crate::commands::Setup;
use crate::scenario::Scenario;
use crate::scenario::setting::{RIDERS, Setting};

/// Loads and checks all conditions of a scenario.
pub(super) fn setup(scenario: &Scenario) -> Result<Setup, Failure> {
    let setup = Setup::new(scenario).map_err(|e| named(scenario, &e))?;
    setup.notes.iter().for_each(|note| complain_once(&format!("note: {note}")));
    setup.warnings().for_each(|warning| complain_once(&format!("warning: {warning}")));
    let drawn = scenario.uncertain.is_some() || scenario.rider_draws.is_some();
    if scenario.options.contains("plant.seed") && !drawn && setup.conditions.plant.exact() {
        complain_once("warning: --seed has no effect: sensors and motor are exact, and nothing is drawn");
    }
    warn_of_idle_rider(scenario);
    Ok(setup)
}

/// Warns of options that describe a rider if there is none.
pub(super) fn warn_of_idle_rider(scenario: &Scenario) {
    let given = |setting: &&Setting| setting.name != "rider" && scenario.options.contains(setting.key);
    for setting in RIDERS.iter().filter(given).filter(|_| !scenario.rider.is_some()) {
        complain_once(&format!("warning: --{} has no effect: the rider is none", setting.name));
    }
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
