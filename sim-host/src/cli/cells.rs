//! The cells of a sweep: a scenario, changed by the common options and by one value of every axis.

use super::conditions::setup;
use super::options::Given;
use super::scenario_error::named;
use crate::basin::Search;
use crate::scenario::setting::{CONDITIONS, Setting};
use crate::scenario::{RiderChoice, Scenario, Speeds};
use crate::sweep::{Axis, Cell, Plan, SweepError, check, combination, count, label};

/// Most cells of a sweep.
const MOST: usize = 100_000;

/// How the values of an axis change a cell.
enum Role {
    /// Values of a setting.
    Setting(&'static Setting),
    /// Replacements for the axis's key in braces in the common options.
    Place(String),
}

/// A valid sweep: its plan and its cells.
pub(super) struct Resolved {
    pub(super) plan: Plan,
    pub(super) cells: Vec<Cell>,
    pub(super) search: Search,
}

/// Finds the role of every axis.
fn roles(axes: &[Axis], shared: &[Given]) -> Result<Vec<Role>, SweepError> {
    let role = |axis: &Axis| {
        let key = &axis.key;
        let place = format!("{{{key}}}");
        let used = shared.iter().any(|given| given.text.contains(&place));
        let given = shared.iter().any(|given| given.setting.name == key);
        match CONDITIONS.iter().find(|setting| setting.name == key) {
            _ if used => Ok(Role::Place(place)),
            Some(setting) if given && !setting.repeats => {
                Err(format!("--over {key}: --{key} cannot be given in addition"))
            }
            Some(setting) => Ok(Role::Setting(setting)),
            None => {
                let names: Vec<_> = CONDITIONS.iter().map(|setting| setting.name).collect();
                Err(format!(
                    "--over {key}: there is no option --{key}, nor {place} in another option's value; options are {}",
                    names.join(", ")
                ))
            }
        }
    };
    axes.iter().map(|axis| role(axis).map_err(SweepError::Axis)).collect()
}

/// The scenario of one cell.
fn cell(base: &Scenario, shared: &[Given], roles: &[Role], values: &[String]) -> Result<Scenario, String> {
    let mut scenario = base.clone();
    if roles.iter().any(|role| matches!(role, Role::Setting(setting) if setting.name == "rider")) {
        scenario.rider = RiderChoice::default();
    }
    for given in shared {
        let mut given = given.clone();
        for (role, value) in roles.iter().zip(values) {
            if let Role::Place(place) = role {
                given.text = given.text.replace(place, value);
            }
        }
        given.apply(&mut scenario)?;
    }
    for (role, value) in roles.iter().zip(values) {
        if let Role::Setting(setting) = role {
            Given { setting, text: value.clone() }.apply(&mut scenario)?;
        }
    }
    Ok(scenario)
}

/// Loads and checks every cell. `base` has the search; the speeds that are searched by default are those of a rider if
/// any cell has one.
///
/// # Errors
/// The axis, or the cell with its error.
pub(super) fn resolve(
    axes: &[Axis],
    base: &Scenario,
    shared: Vec<Given>,
) -> Result<Resolved, super::Failure> {
    check(axes)?;
    let roles = roles(axes, &shared)?;
    let cells = count(axes);
    if cells > MOST {
        return Err(format!("the sweep has {cells} cells; at most {MOST}").into());
    }
    let (mut setups, mut ridden) = (Vec::with_capacity(cells), false);
    for i in 0..cells {
        let values = combination(axes, i);
        let of_cell = |e: &dyn std::fmt::Display| format!("cell {}: {e}", label(axes, &values));
        let scenario = cell(base, &shared, &roles, &values).map_err(|e| of_cell(&e))?;
        ridden |= scenario.is_ridden();
        let setup = setup(&scenario).map_err(|e| of_cell(&e))?;
        setups.push((serde_json::to_value(&setup.config)?, setup.scenario, setup.conditions));
    }
    let search = base.search.resolve(ridden).map_err(|e| named(base, &e))?;
    // Without riders in a cell its own default would be other speeds.
    let speeds = base.search.speeds.clone().unwrap_or_else(|| Speeds::List(search.speeds.clone()));
    let configs: Vec<_> = setups.iter().map(|(config, ..)| config.clone()).collect();
    let options = shared.iter().map(Given::typed).collect();
    let plan = Plan::new(options, axes.to_vec(), &search, &configs);
    let mut cells = Vec::with_capacity(setups.len());
    for (id, (config, mut scenario, conditions)) in plan.cells.iter().zip(setups) {
        scenario.search.speeds = Some(speeds.clone());
        (scenario.uncertain, scenario.rider_draws, scenario.search.adaptive_speeds) = (None, None, None);
        cells.push(Cell { id: id.clone(), config, scenario: serde_json::to_value(&scenario)?, conditions });
    }
    Ok(Resolved { plan, cells, search })
}
