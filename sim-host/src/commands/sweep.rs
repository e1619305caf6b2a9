//! Basins over a grid of conditions. A cell is a scenario, changed by the common options and by one value of every axis.

use super::{CommandError, Hooks, Setup};
use crate::basin::{Column, Search, borders, together};
use crate::scenario::setting::{CONDITIONS, Given, GivenError, Setting};
use crate::scenario::{RiderChoice, Scenario, Speeds, named};
use crate::sweep::{Axis, Cell, DoneColumn, Plan, SweepError, Unit, check, combination, count, label};
use rayon::prelude::*;
use serde_json::Value;
use std::collections::BTreeSet;

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
pub struct SweepTask {
    /// The plan.
    pub plan: Plan,
    /// The cells, in the plan's order.
    pub cells: Vec<Cell>,
    /// The search of each.
    pub search: Search,
    /// Doubts and notes about the cells, each once, as text.
    pub remarks: BTreeSet<String>,
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
            Some(setting) if given && !setting.repeats => Err(format!("--{key} cannot be given in addition")),
            Some(setting) => Ok(Role::Setting(setting)),
            None => {
                let names: Vec<_> = CONDITIONS.iter().map(|setting| setting.name).collect();
                Err(format!(
                    "there is no option --{key}, nor {place} in another option's value; options are {}",
                    names.join(", ")
                ))
            }
        }
    };
    let named = |axis: &Axis| role(axis).map_err(|reason| SweepError::Axis { key: axis.key.clone(), reason });
    axes.iter().map(named).collect()
}

/// The scenario of one cell.
fn cell(
    base: &Scenario,
    shared: &[Given],
    roles: &[Role],
    values: &[String],
) -> Result<Scenario, GivenError> {
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
pub fn sweep(axes: &[Axis], base: &Scenario, shared: Vec<Given>) -> Result<SweepTask, CommandError> {
    check(axes)?;
    let roles = roles(axes, &shared)?;
    let cells = count(axes);
    if cells > MOST {
        return Err(CommandError::Cells { cells, most: MOST });
    }
    let (mut setups, mut remarks, mut ridden) = (Vec::with_capacity(cells), BTreeSet::new(), false);
    for i in 0..cells {
        let values = combination(axes, i);
        let of_cell = |(message, key, range)| {
            let cell = label(axes, &values);
            CommandError::Cell { cell, message, key, range }
        };
        let scenario = cell(base, &shared, &roles, &values);
        let scenario =
            scenario.map_err(|e| of_cell((e.to_string(), Some(e.given.setting.key.into()), e.range())))?;
        ridden |= scenario.is_ridden();
        let setup = Setup::new(&scenario);
        let setup = setup.map_err(|e| of_cell((named(&scenario, &e), e.key(), e.range())))?;
        remarks.extend(setup.notes.iter().map(|note| format!("note: {note}")));
        remarks.extend(setup.warnings().map(|warning| format!("warning: {warning}")));
        setups.push((json(&setup.config), setup.scenario, setup.conditions));
    }
    let search = base.search.resolve(ridden)?;
    // Without riders in a cell its own default would be other speeds.
    let speeds = base.search.speeds.clone().unwrap_or_else(|| Speeds::List(search.speeds.clone()));
    let configs: Vec<_> = setups.iter().map(|(config, ..)| config.clone()).collect();
    let options = shared.iter().map(Given::typed).collect();
    let plan = Plan::new(options, axes.to_vec(), &search, &configs);
    let mut cells = Vec::with_capacity(setups.len());
    for (id, (config, mut scenario, conditions)) in plan.cells.iter().zip(setups) {
        scenario.search.speeds = Some(speeds.clone());
        (scenario.uncertain, scenario.rider_draws, scenario.search.adaptive_speeds) = (None, None, None);
        cells.push(Cell { id: id.clone(), config, scenario: json(&scenario), conditions });
    }
    Ok(SweepTask { plan, cells, search, remarks })
}

/// A configuration or a scenario as JSON.
fn json(value: &impl serde::Serialize) -> Value {
    // Neither has keys other than text.
    serde_json::to_value(value).unwrap_or_default()
}

/// Computes one cell from its scenario alone, on all cores of the current rayon pool, to the same bits as
/// [`crate::sweep::run`]; `None` if it was stopped. `id` and `config` are those of the plan.
///
/// # Errors
/// The scenario can't be used.
pub fn unit(id: &str, config: &Value, scenario: &Value, hooks: Hooks) -> Result<Option<Unit>, CommandError> {
    let text = scenario.to_string();
    let read = Scenario::from_json(&text).map_err(|e| CommandError::Cell {
        cell: id.into(),
        message: e.to_string(),
        key: e.key().map(Into::into),
        range: None,
    })?;
    let setup = Setup::new(&read)?;
    let search = read.search.resolve(read.is_ridden())?;
    let size = together(&setup.conditions, &search, search.speeds.len());
    let group = |speeds: &[f64]| {
        let columns = (!(hooks.stop)()).then(|| borders(&setup.conditions, &search, speeds));
        speeds.iter().for_each(|_| (hooks.finished)());
        columns
    };
    let columns: Option<Vec<Vec<Column>>> = search.speeds.par_chunks(size).map(group).collect();
    let done = |columns: Vec<Vec<Column>>| {
        columns.iter().flatten().enumerate().map(|(i, column)| DoneColumn::new(i, column)).collect()
    };
    Ok(columns.map(|columns| Unit::new(id, (config, scenario), done(columns))))
}
