//! `ride`.

use crate::error::of_command;
use crate::law::OwnFunction;
use crate::scenario::{json, setup};
use crate::work::{Options, run};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sim_host::commands::ride::ride as ride_once;
use sim_host::ride::TracePoint;

/// Columns of a record: name, and value at a point.
type Column = (&'static str, fn(&TracePoint) -> f64);

/// The columns of numbers with a unit.
const COLUMNS: [Column; 16] = [
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
    ("mode", |p| f64::from(p.mode)),
];

/// The bytes of numbers, in the machine's order.
pub(crate) fn bytes<'py>(py: Python<'py>, values: impl Iterator<Item = f64>) -> Bound<'py, PyBytes> {
    PyBytes::new(py, &values.flat_map(f64::to_ne_bytes).collect::<Vec<u8>>())
}

/// Rides once: the document as JSON, the record as bytes of 64-bit numbers by column, `limits` and `causes` as bits.
#[pyfunction]
#[pyo3(signature = (scenario, law=None))]
pub(crate) fn ride<'py>(
    py: Python<'py>,
    scenario: &str,
    law: Option<&Bound<'py, PyAny>>,
) -> PyResult<(String, Bound<'py, PyDict>, bool)> {
    let law = law.map(OwnFunction::new);
    let setup = setup(py, scenario, law.as_ref())?;
    let options = Options { parts: 1, threads: Some(1), progress: None, law: law.as_ref() };
    let (ridden, interrupted) = run(py, &options, |_| ride_once(&setup))?;
    let ridden = ridden.map_err(|error| of_command(py, &error))?;
    let columns = PyDict::new(py);
    for (name, value) in COLUMNS {
        columns.set_item(name, bytes(py, ridden.trace.iter().map(value)))?;
    }
    let whole = |bits: fn(&TracePoint) -> u64| -> Vec<u8> {
        ridden.trace.iter().flat_map(|p| bits(p).to_ne_bytes()).collect()
    };
    columns.set_item("limits", PyBytes::new(py, &whole(|p| p.limits.into())))?;
    columns.set_item("causes", PyBytes::new(py, &whole(|p| p.causes)))?;
    Ok((json(&ridden.document(&setup)), columns, interrupted))
}
