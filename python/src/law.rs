//! Laws that are functions: Python's, or compiled.

use crate::compiled::Compiled;
use crate::error::of_choice;
use pyo3::prelude::*;
use pyo3::types::PyFloat;
use sim_host::ride::OwnLaw;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A function from Python: the owner of its name and its code, and the address of the code if it is compiled; without one the
/// owner itself is called.
pub(crate) type Given<'py> = (Bound<'py, PyAny>, Option<NonZeroUsize>);

/// A function of roll rate \[rad/s\] and speed \[m/s\] to a torque \[N m\], with the first error that it raised.
pub(crate) struct OwnFunction {
    /// Its name.
    pub(crate) name: String,
    owner: Py<PyAny>,
    compiled: Option<Compiled>,
    raised: Arc<Raised>,
}

#[derive(Default)]
struct Raised {
    any: AtomicBool,
    first: Mutex<Option<PyErr>>,
}

impl Raised {
    /// The torque \[N m\] of `call` at these values; zero after an error, of this or an earlier call.
    fn unless(&self, values: (f64, f64), call: impl FnOnce((f64, f64)) -> PyResult<f64>) -> f64 {
        if self.any.load(Ordering::Relaxed) {
            return 0.0;
        }
        // A ride beyond its end, beside others that go on.
        if !(values.0.is_finite() && values.1.is_finite()) {
            return f64::NAN;
        }
        call(values).unwrap_or_else(|error| {
            self.first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            self.any.store(true, Ordering::Relaxed);
            0.0
        })
    }
}

impl OwnFunction {
    pub(crate) fn new((owner, address): Given<'_>) -> Self {
        let name = owner.getattr("__name__").and_then(|name| name.extract::<String>());
        let name = format!("python:{}", name.unwrap_or_else(|_| "function".into()));
        Self { name, owner: owner.unbind(), compiled: address.map(Compiled::at), raised: Arc::default() }
    }

    /// The law. After an error the torque is zero, and the computation is to be stopped.
    pub(crate) fn law(&self) -> OwnLaw {
        let raised = self.raised.clone();
        let owner = Python::attach(|py| self.owner.clone_ref(py));
        match self.compiled {
            None => OwnLaw::new(move |roll_rate_rad_s, speed_m_s| {
                raised.unless((roll_rate_rad_s, speed_m_s), |values| {
                    Python::attach(|py| torque(&owner.bind(py).call1(values)?, values))
                })
            }),
            Some(compiled) => OwnLaw::new(move |roll_rate_rad_s, speed_m_s| {
                // The code is there as long as its owner.
                let _kept = &owner;
                raised.unless((roll_rate_rad_s, speed_m_s), |values| {
                    let torque_nm = compiled.torque_nm(values.0, values.1);
                    if torque_nm.is_finite() { Ok(torque_nm) } else { Err(refused(torque_nm, values)) }
                })
            }),
        }
    }

    /// Whether every call needs the interpreter: it is not compiled.
    pub(crate) fn interpreted(&self) -> bool {
        self.compiled.is_none()
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

/// The error of a number that is no torque. The interpreter's lock is taken for it.
fn refused(torque_nm: f64, values: (f64, f64)) -> PyErr {
    Python::attach(|py| {
        not_finite(PyFloat::new(py, torque_nm).as_any(), values).unwrap_or_else(|error| error)
    })
}

/// The error of a value that is no torque, at these values.
fn not_finite(value: &Bound<'_, PyAny>, (roll_rate_rad_s, speed_m_s): (f64, f64)) -> PyResult<PyErr> {
    let returned = value.repr()?;
    let message = format!(
        "law: the function returned {returned} at {roll_rate_rad_s} rad/s and {speed_m_s} m/s; a torque in N m is one \
         finite number"
    );
    Ok(of_choice(value.py(), &message, Some("law"), None))
}

/// A torque \[N m\] that the function returned for these values.
fn torque(value: &Bound<'_, PyAny>, values: (f64, f64)) -> PyResult<f64> {
    // A number of numpy that is not a double is asked for its kind: a complex one would lose a part, an array of one would do.
    let plain = value.is_instance_of::<PyFloat>() || {
        let kind = value.getattr("dtype").and_then(|dtype| dtype.getattr("kind")?.extract::<String>());
        let array = value.getattr("ndim").and_then(|ndim| ndim.extract::<usize>()).is_ok_and(|ndim| ndim > 0);
        !array && !kind.is_ok_and(|kind| kind == "c")
    };
    let torque_nm = if plain { value.extract().unwrap_or(f64::NAN) } else { f64::NAN };
    if torque_nm.is_finite() { Ok(torque_nm) } else { Err(not_finite(value, values)?) }
}
