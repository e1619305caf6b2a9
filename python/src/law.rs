//! Laws that are Python functions.

use crate::error::of_choice;
use pyo3::prelude::*;
use pyo3::types::PyFloat;
use sim_host::ride::OwnLaw;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A Python function of roll rate \[rad/s\] and speed \[m/s\] to a torque \[N m\], with the first error that it raised.
pub(crate) struct OwnFunction {
    /// Its name.
    pub(crate) name: String,
    function: Py<PyAny>,
    raised: Arc<Raised>,
}

#[derive(Default)]
struct Raised {
    any: AtomicBool,
    first: Mutex<Option<PyErr>>,
}

impl OwnFunction {
    pub(crate) fn new(function: &Bound<'_, PyAny>) -> Self {
        let name = function.getattr("__name__").and_then(|name| name.extract::<String>());
        let name = name.unwrap_or_else(|_| "function".into());
        Self { name: format!("python:{name}"), function: function.clone().unbind(), raised: Arc::default() }
    }

    /// The law. After an error the torque is zero, and the computation is to be stopped.
    pub(crate) fn law(&self) -> OwnLaw {
        let raised = self.raised.clone();
        let function = Python::attach(|py| self.function.clone_ref(py));
        OwnLaw::new(move |roll_rate_rad_s, speed_m_s| {
            if raised.any.load(Ordering::Relaxed) {
                return 0.0;
            }
            // A ride beyond its end, beside others that go on.
            if !(roll_rate_rad_s.is_finite() && speed_m_s.is_finite()) {
                return f64::NAN;
            }
            Python::attach(|py| {
                let torque_nm = function.bind(py).call1((roll_rate_rad_s, speed_m_s));
                torque_nm.and_then(|value| torque(&value, roll_rate_rad_s, speed_m_s)).unwrap_or_else(
                    |error| {
                        *raised.first.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                        raised.any.store(true, Ordering::Relaxed);
                        0.0
                    },
                )
            })
        })
    }

    /// Whether the function raised an error.
    pub(crate) fn failed(&self) -> bool {
        self.raised.any.load(Ordering::Relaxed)
    }

    /// The error that the function raised.
    pub(crate) fn error(&self) -> Option<PyErr> {
        self.raised.first.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// A torque \[N m\] that the function returned for these values.
fn torque(value: &Bound<'_, PyAny>, roll_rate_rad_s: f64, speed_m_s: f64) -> PyResult<f64> {
    // A number of numpy that is not a double is asked for its kind: a complex one would lose a part, an array of one would do.
    let plain = value.is_instance_of::<PyFloat>() || {
        let kind = value.getattr("dtype").and_then(|dtype| dtype.getattr("kind")?.extract::<String>());
        let array = value.getattr("ndim").and_then(|ndim| ndim.extract::<usize>()).is_ok_and(|ndim| ndim > 0);
        !array && !kind.is_ok_and(|kind| kind == "c")
    };
    let torque_nm = if plain { value.extract().unwrap_or(f64::NAN) } else { f64::NAN };
    if torque_nm.is_finite() {
        return Ok(torque_nm);
    }
    let returned = value.repr()?;
    let message = format!(
        "law: the function returned {returned} at {roll_rate_rad_s} rad/s and {speed_m_s} m/s; a torque in N m is one \
         finite number"
    );
    Err(of_choice(value.py(), &message, Some("law"), None))
}
