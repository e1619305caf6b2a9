//! Conditions and searches shared by the tests of rides and basins.

use crate::rides::shipped;
use control::{Config, Law};
use sim_host::basin::{Axis, Method, Search};
use sim_host::bicycle::Geometry;
use sim_host::ride::{Assist, Conditions};

/// The thesis bicycle without assist.
pub fn alone() -> Conditions {
    Conditions::thesis(Geometry::new(&shipped("rigid_jason").parameters), Assist::None)
}

/// The thesis bicycle under a law in the control crate, every limit off.
pub fn assisted(law: Law) -> Conditions {
    configured(Config::thesis(law))
}

/// The thesis bicycle under a configuration of the control crate.
///
/// # Panics
/// If the configuration is out of range.
pub fn configured(config: Config) -> Conditions {
    let plan = config.plan().unwrap_or_else(|e| panic!("{e}"));
    Conditions { assist: Assist::Firmware(Box::new(plan)), ..alone() }
}

/// The thesis bicycle under the bare continuous law.
pub fn ideal(law: Law) -> Conditions {
    Conditions { assist: Assist::Ideal(Box::new(law.into())), ..alone() }
}

/// A search over `speeds` \[m/s\] up to `max_rate` \[rad/s\], the other settings the default ones.
pub fn search(speeds: &[f64], max_rate: f64) -> Search {
    Search {
        speeds: speeds.to_vec(),
        axis: Axis::SteerRate,
        max_rate,
        scan_step: 0.25,
        tolerance: 0.01,
        method: Method::Fast,
        efforts: true,
    }
}

/// The law whose gain changes sign at 7.5 m/s.
pub const H: Law = Law::H { cut: false };
