//! `ride`.

use crate::error::of_command;
use crate::flags;
use crate::law::{Given, OwnFunction};
use crate::scenario::{json, setup};
use crate::work::{Options, run};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sim_host::commands::ride::ride_until;
use sim_host::ride::TracePoint;

/// Columns of a record: name, and value at a point.
type Column = (&'static str, fn(&TracePoint) -> f64);

/// The columns of numbers with a unit.
const COLUMNS: [Column; 15] = [
    ("time_s", |p| p.t),
    ("roll_rad", |p| p.roll),
    ("steer_rad", |p| p.steer),
    ("pitch_rad", |p| p.pitch),
    ("roll_rate_rad_s", |p| p.roll_rate),
    ("steer_rate_rad_s", |p| p.steer_rate),
    ("yaw_rate_rad_s", |p| p.yaw_rate),
    ("rear_wheel_rate_rad_s", |p| p.rear_wheel_rate),
    ("rear_speed_m_s", |p| p.rear_speed),
    ("front_speed_m_s", |p| p.front_speed),
    ("measured_roll_rate_rad_s", |p| p.measured_roll_rate),
    ("measured_speed_m_s", |p| p.measured_speed),
    ("torque_nm", |p| p.torque),
    ("rider_torque_nm", |p| p.rider_torque),
    ("motor_torque_nm", |p| p.motor_torque),
];

/// The bytes of numbers, in the machine's order.
pub(crate) fn bytes<'py>(py: Python<'py>, values: impl Iterator<Item = f64>) -> Bound<'py, PyBytes> {
    PyBytes::new(py, &values.flat_map(f64::to_ne_bytes).collect::<Vec<u8>>())
}

/// Rides once: the document as JSON; the record as bytes of 64-bit numbers by column, `mode`, `limit_active` and `cause_active` as
/// one byte per flag. `None` if Ctrl-C ended it.
#[pyfunction]
#[pyo3(signature = (scenario, law=None))]
pub(crate) fn ride<'py>(
    py: Python<'py>,
    scenario: &str,
    law: Option<Given<'py>>,
) -> PyResult<Option<(String, Bound<'py, PyDict>)>> {
    let law = law.map(OwnFunction::new);
    let setup = setup(py, scenario, law.as_ref())?;
    let options = Options { parts: 1, threads: Some(1), progress: None, law: law.as_ref() };
    let (ridden, interrupted) = run(py, &options, |hooks| ride_until(&setup, hooks.stop))?;
    let ridden = ridden.map_err(|error| of_command(py, &error))?;
    let Some(ridden) = ridden.filter(|_| !interrupted) else { return Ok(None) };
    let columns = PyDict::new(py);
    for (name, value) in COLUMNS {
        columns.set_item(name, bytes(py, ridden.trace.iter().map(value)))?;
    }
    let modes: Vec<u8> = ridden.trace.iter().map(|p| p.mode).collect();
    columns.set_item("mode", PyBytes::new(py, &modes))?;
    columns.set_item("limit_active", flags::limits(py, ridden.trace.iter().map(|p| p.limits)))?;
    columns.set_item("cause_active", flags::causes(py, ridden.trace.iter().map(|p| p.causes)))?;
    Ok(Some((json(&ridden.document(&setup)), columns)))
}
