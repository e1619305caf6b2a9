//! Protections: each module checks one quantity, limits the current where that suffices, and raises a fault where it
//! does not.

pub mod angle;
pub mod back_emf;
pub mod current_tracking;
pub mod overload;
pub mod sensors;
pub mod stall;
pub mod supply;
pub mod temperature;

/// Linear share from 0 at `none` to 1 at `all`; NaN gives 0.
pub(crate) fn share(x: f32, none: f32, all: f32) -> f32 {
    let part = (x - none) / (all - none);
    if part > 0.0 { part.min(1.0) } else { 0.0 }
}

/// First-order low-pass filter with a time constant of `1 / gain` calls.
pub(crate) fn follow_mean(mean: &mut f32, x: f32, gain: f32) {
    *mean += (x - *mean) * gain;
}
