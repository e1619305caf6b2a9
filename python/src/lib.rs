//! The simulator as the Python module `steer_assist._core`. Scenarios and documents pass the border as JSON, records as
//! columns of bytes; the package around it (`python/steer_assist`) makes them Python's.
#![allow(unsafe_code, reason = "the macros of PyO3 write it: functions that the interpreter calls")]

mod basin;
mod catalogue;
mod compiled;
mod eigen;
mod error;
mod flags;
mod identify;
mod law;
mod plane;
mod replay;
mod ride;
mod scenario;
mod sweep;
mod work;

use pyo3::prelude::*;

/// The module.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::basin::basin;
    #[pymodule_export]
    use super::catalogue::{bicycle_keys, bicycle_of_text, bicycles, riders};
    #[pymodule_export]
    use super::eigen::eigen;
    #[pymodule_export]
    use super::flags::flags;
    #[pymodule_export]
    use super::identify::identify;
    #[pymodule_export]
    use super::plane::plane;
    #[pymodule_export]
    use super::replay::replay;
    #[pymodule_export]
    use super::ride::ride;
    #[pymodule_export]
    use super::scenario::{check, read, unit_of};
    #[pymodule_export]
    use super::sweep::{axes, axis_coordinate, sweep_cell, sweep_document, sweep_plan};
}
