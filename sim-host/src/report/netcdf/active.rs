//! Modes of the controller, and which limits and causes are active, as flags.

use control::{ActiveLimits, CAUSES, Causes, LIMITS, Mode};

/// Meanings of the flags of limits and causes.
pub const ACTIVE: [&str; 2] = ["inactive", "active"];

/// Names of the modes, in the order of their numbers.
pub fn mode_names() -> Vec<String> {
    (0..).map_while(Mode::numbered).map(|mode| mode.name().to_owned()).collect()
}

/// Names of the limits.
pub fn limit_names() -> Vec<String> {
    LIMITS.map(|named| named.name.to_owned()).to_vec()
}

/// Whether each limit is among these bits, in the order of [`limit_names`].
// Compiled, and optimised, where it is called: once per point of a record.
#[inline]
pub fn active_limits(bits: u16) -> [bool; LIMITS.len()] {
    LIMITS.map(|named| ActiveLimits(bits).contains(named.limit))
}

/// Names of the causes with their numbers.
pub fn cause_names() -> Vec<(String, u8)> {
    CAUSES.map(|cause| (cause.name().to_owned(), cause.code())).to_vec()
}

/// Whether each cause is among these bits, in the order of [`cause_names`].
// Compiled, and optimised, where it is called: once per point of a record.
#[inline]
pub fn active_causes(bits: u64) -> [bool; CAUSES.len()] {
    CAUSES.map(|cause| Causes(bits).has(cause))
}
