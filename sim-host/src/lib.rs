//! The simulator: a nonlinear Whipple bicycle, steered by the flashed control crate. Computes basins of
//! attraction: the disturbances from which a ride does not fall.
//!
//! A [`scenario::Scenario`] is an experiment as data. [`scenario::Scenario::resolve`] gives the conditions of its rides,
//! [`ride::traced`] simulates one ride, [`basin::basin`] searches a basin. Units are SI, angles in radians; roll to the
//! right, steer to the right and torque to the right are positive (axes of Meijaard et al. 2007).
//!
//! ```
//! use sim_host::basin::basin;
//! use sim_host::scenario::{OrNone, Scenario, SearchChoice, Speeds};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scenario = Scenario {
//!     law: Some("h".into()),
//!     torque_limit_nm: Some(OrNone::At(7.0)),
//!     search: SearchChoice { speeds: Some(Speeds::List(vec![3.0, 4.0])), tolerance: 0.1, ..SearchChoice::default() },
//!     ..Scenario::default()
//! };
//! let search = scenario.search.resolve(scenario.is_ridden())?;
//! let found = basin(&scenario.resolve()?.conditions, &search, |_| (), || false)?;
//! // Steer rates up to this one do not end in a fall [rad/s].
//! assert!((4.0..9.0).contains(&found.columns[1].upper));
//! # Ok(())
//! # }
//! ```
//!
//! More in `sim-host/examples`: a ride, a basin, an own law, an own rider, an own sensor. The feature `cli`, on by default,
//! is the command line; without it the library has no clap or terminal code.

pub mod board;
#[cfg(feature = "cli")]
pub mod cli;
pub mod closed_loop;
pub mod commands;
mod counted;
pub mod design;
#[cfg(feature = "fmu")]
pub mod fmu;
pub mod parameters;
pub mod pil;
pub mod recording;
pub mod replay;
pub mod report;
pub mod rider_record;
pub mod scenario;
pub mod sensor_fit;
pub mod study;
pub mod sweep;
pub mod thesis;
pub mod weave;

pub use analysis::{damped, eigen, exponential, identify, matrix_pencil, simplex, tracking};
use physics::json;
pub use physics::{basin, bicycle, input_file, integrate, num, perturbation, plant, range, ride, rider};
