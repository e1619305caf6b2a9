//! Errors of the simulator as Python exceptions.

use pyo3::prelude::*;
use sim_host::commands::CommandError;
use sim_host::scenario::{ScenarioError, SyntaxError};

/// An exception class of the package.
fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("steer_assist.errors")?.getattr(name)
}

/// The exception of the package's class `name` with these arguments, or the error that prevents it.
fn exception<'py>(py: Python<'py>, name: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    match class(py, name).and_then(|class| class.call1(arguments)) {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// An error of a scenario: its message, the key and the range, if they are known.
pub(crate) fn of_scenario(py: Python<'_>, error: &ScenarioError) -> PyErr {
    exception(py, "ScenarioError", (error.to_string(), error.key(), error.range()))
}

/// A text that is no scenario.
pub(crate) fn of_syntax(py: Python<'_>, error: &SyntaxError) -> PyErr {
    of_choice(py, &error.to_string(), error.key(), None)
}

/// An error of a command.
pub(crate) fn of_command(py: Python<'_>, error: &CommandError) -> PyErr {
    of_renamed(py, error, &[])
}

/// An error of a command whose keys have other names here: theirs, and ours.
pub(crate) fn of_renamed(py: Python<'_>, error: &CommandError, names: &[(&str, &str)]) -> PyErr {
    let ours = |key: String| {
        let name = names.iter().find(|(theirs, _)| *theirs == key);
        name.map_or(key, |(_, ours)| (*ours).to_owned())
    };
    exception(py, "ScenarioError", (error.to_string(), error.key().map(ours), error.range()))
}

/// A choice that can't be used: its message, its key, and the range of a number outside its own.
pub(crate) fn of_choice(
    py: Python<'_>,
    message: &str,
    key: Option<&str>,
    range: Option<(f64, f64)>,
) -> PyErr {
    exception(py, "ScenarioError", (message, key, range))
}

/// Any other error, as a message.
pub(crate) fn of_text(py: Python<'_>, error: &dyn std::fmt::Display) -> PyErr {
    exception(py, "ScenarioError", (error.to_string(),))
}

/// Any other error of the value of a key, as a message.
pub(crate) fn of_key(py: Python<'_>, key: &str, error: &dyn std::fmt::Display) -> PyErr {
    exception(py, "ScenarioError", (error.to_string(), key))
}
