//! The physics of the simulator: a nonlinear Whipple bicycle with rider, sensors and actuator, steered by the flashed
//! control crate; its rides and basins of attraction.
//!
//! ```
//! use control::{Config, Law};
//! use physics::bicycle::{Geometry, catalogue};
//! use physics::ride::{Assist, Conditions, Start, traced};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let bicycle = catalogue::load("rigid_jason")?;
//! // The flashed control step with law h, at 1 kHz, without limits.
//! let plan = Config::thesis(Law::H { cut: false }).plan().map_err(|e| e.to_string())?;
//! let conditions = Conditions::thesis(Geometry::new(&bicycle.parameters), Assist::Firmware(Box::new(plan)));
//! let start = Start { speed_m_s: 4.0, steer_rate_rad_s: 3.0, ..Start::default() };
//! let (ride, trace) = traced(&conditions, start);
//! assert!(!ride.fell() && trace[0].steer_rate == 3.0);
//!
//! // The same knock without an assist ends in a fall.
//! let alone = Conditions { assist: Assist::None, ..conditions };
//! assert!(traced(&alone, start).0.outcome.time_to_fall_s().is_some_and(|t| (0.5..3.0).contains(&t)));
//! # Ok(())
//! # }
//! ```

pub mod basin;
pub mod bicycle;
pub mod input_file;
pub mod json;
pub mod perturbation;
pub mod plant;
pub mod rider;

pub use motion::{integrate, num, range, ride};
