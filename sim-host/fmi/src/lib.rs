//! The controller, the bicycle and the rider as co-simulation FMUs of FMI 2.0 and 3.0: `docs/fmi.md`.
//!
//! One dynamic library has all three models; the FMU's file `resources/model.json`, a [`Setup`], says which one, with every
//! number that it needs. A [`Table`] declares the variables of a model, once: the model description is written from it, and
//! [`Instance`] checks by it. All values are kept as `f64`, which holds every 32-bit integer exactly.

mod bicycle;
mod c_api;
mod controller;
mod instance;
mod model;
mod parameters;
mod rider;
mod setup;
mod variable;

pub use instance::{Instance, LogEntry, Snapshot};
pub use model::Model;
pub use setup::{MODEL_FILE, Setup, token};
pub use variable::{Kind, Role, Table, Variable};
