//! The cells of a sweep: the common options with one value of every axis, parsed like those of `basin`.

use super::conditions::ConditionArgs;
use super::words::{Choice, choice, conditions};
use crate::basin::Search;
use crate::sweep::{Axis, Cell, Plan, SweepError, check, combination, count, label};

/// Most cells of a sweep.
const MOST: usize = 100_000;

/// How the values of an axis become options.
enum Role {
    /// Values of an option.
    Option(Box<Choice>),
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
fn roles(axes: &[Axis], words: &[String]) -> Result<Vec<Role>, SweepError> {
    let role = |axis: &Axis| {
        let key = &axis.key;
        let place = format!("{{{key}}}");
        let used = words.iter().any(|word| word.contains(&place));
        let given = words.iter().any(|word| word.split('=').next() == Some(&format!("--{key}")));
        match choice::<ConditionArgs>(key) {
            _ if used => Ok(Role::Place(place)),
            Ok(choice) if given && !choice.repeats() => {
                Err(format!("--over {key}: --{key} cannot be given in addition"))
            }
            Ok(choice) => Ok(Role::Option(Box::new(choice))),
            Err(names) => Err(format!(
                "--over {key}: there is no option --{key}, nor {place} in another option's value; options are {}",
                names.join(", ")
            )),
        }
    };
    axes.iter().map(|axis| role(axis).map_err(SweepError::Axis)).collect()
}

/// The command-line words of one cell.
fn words_of(shared: &[String], roles: &[Role], values: &[String]) -> Result<Vec<String>, String> {
    let mut words = shared.to_vec();
    for (role, value) in roles.iter().zip(values) {
        match role {
            Role::Option(choice) => words.extend(choice.word(value)?),
            Role::Place(place) => words.iter_mut().for_each(|word| *word = word.replace(place, value)),
        }
    }
    Ok(words)
}

/// Loads and checks every cell; `search` receives whether any cell has a rider.
///
/// # Errors
/// The axis, or the cell with its error.
pub(super) fn resolve(
    axes: &[Axis],
    shared: &[String],
    search: impl FnOnce(bool) -> Result<Search, super::Failure>,
) -> Result<Resolved, super::Failure> {
    check(axes)?;
    let roles = roles(axes, shared)?;
    let cells = count(axes);
    if cells > MOST {
        return Err(format!("the sweep has {cells} cells; at most {MOST}").into());
    }
    let (mut setups, mut ridden) = (Vec::with_capacity(cells), false);
    for i in 0..cells {
        let values = combination(axes, i);
        let named = |e: &dyn std::fmt::Display| format!("cell {}: {e}", label(axes, &values));
        let words = words_of(shared, &roles, &values).map_err(|e| named(&e))?;
        let requested = conditions(&words).map_err(|e| named(&e))?;
        ridden |= requested.ridden();
        let setup = requested.setup().map_err(|e| named(&e))?;
        setups.push((serde_json::to_value(&setup.config)?, setup.conditions));
    }
    let search = search(ridden)?;
    let configs: Vec<_> = setups.iter().map(|(config, _)| config.clone()).collect();
    let plan = Plan::new(shared.to_vec(), axes.to_vec(), &search, &configs);
    let cell = |(id, (config, conditions)): (&String, _)| Cell { id: id.clone(), config, conditions };
    let cells = plan.cells.iter().zip(setups).map(cell).collect();
    Ok(Resolved { plan, cells, search })
}
