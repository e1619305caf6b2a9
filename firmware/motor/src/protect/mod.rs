//! What may not go on: each file watches one thing, limits the current where that helps, and calls a fault where it
//! does not.

pub mod angle;
pub mod back_emf;
pub mod current_tracking;
pub mod overload;
pub mod sensors;
pub mod stall;
pub mod supply;
pub mod temperature;

/// A share from 0 at `none` to 1 at `all`, straight between; NaN gives 0.
pub(crate) fn share(x: f32, none: f32, all: f32) -> f32 {
    let part = (x - none) / (all - none);
    if part > 0.0 { part.min(1.0) } else { 0.0 }
}

/// The mean of the last calls or so: the time constant is a number of calls, `1 / gain`.
pub(crate) fn follow_mean(mean: &mut f32, x: f32, gain: f32) {
    *mean += (x - *mean) * gain;
}
