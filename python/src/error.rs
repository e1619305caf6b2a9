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
    exception(py, "ScenarioError", (error.to_string(), error.key(), None::<(f64, f64)>))
}

/// An error of a command.
pub(crate) fn of_command(py: Python<'_>, error: &CommandError) -> PyErr {
    match error {
        CommandError::Scenario(error) => of_scenario(py, error),
        CommandError::Choice { name, .. } => {
            exception(py, "ScenarioError", (error.to_string(), *name, None::<(f64, f64)>))
        }
        other => exception(py, "ScenarioError", (other.to_string(),)),
    }
}

/// Any other error, as a message.
pub(crate) fn of_text(py: Python<'_>, error: &dyn std::fmt::Display) -> PyErr {
    exception(py, "ScenarioError", (error.to_string(),))
}

/// Any other error of the value of a key, as a message.
pub(crate) fn of_key(py: Python<'_>, key: &str, error: &dyn std::fmt::Display) -> PyErr {
    exception(py, "ScenarioError", (error.to_string(), key))
}
