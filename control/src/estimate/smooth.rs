//! Smooths the roll rate for the law: removes the steps between the samples of a slow gyro, and vibration.
//!
//! * **Interpolation**: a gyro of 100 Hz changes every ten control periods of 1 ms by as much as the bicycle moves in
//!   10 ms. If the sample is held, each change is a step of the torque. Linear interpolation between samples removes
//!   the steps; each sample then acts in full one sampling period late. The samples of a gyro as fast as the control
//!   loop pass unchanged.
//! * **Low-pass**: vibration of road and motor is above 10 Hz, a fall of a bicycle below 2 Hz. The filter is of second
//!   order, maximally flat (Butterworth): `y'' = w^2 (x - y) - sqrt(2) w y'`, which delays slow signals by
//!   `sqrt(2) / w`. Vibration is also small, so the part that the low-pass removes is bounded: a fall, which is faster,
//!   is not delayed but reduced by at most half of [`SmoothConfig::most_rad_s`].

use crate::param::{ParamSpec, ParamVisitor};
use core::f32::consts::SQRT_2;

/// Longest time between two samples that is interpolated \[control periods\]; after a longer one the next sample acts
/// at once.
const LONGEST_TICKS: u16 = 100;

/// Parameters of the smoothing. The default passes the roll rate unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmoothConfig {
    /// Whether to interpolate linearly between the samples of a gyro slower than the control loop.
    pub interpolate: bool,
    /// Delay of slow signals by the low-pass \[s\]; 0 is off. The half-power frequency is `1 / (sqrt(2) pi lag_s)`.
    pub lag_s: f32,
    /// Bound of the low-pass \[rad/s\]: of a fast part `x` it removes `x / (1 + (x / most_rad_s)^2)`, at most half of
    /// the bound either way; `None` removes all of `x`.
    pub most_rad_s: Option<f32>,
}

impl SmoothConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.switch(&ParamSpec::switch("smooth", "interpolate"), &mut self.interpolate);
        to.number(&ParamSpec::new("smooth", "lag_s", 0.0, 0.1), &mut self.lag_s);
        to.optional_number(&ParamSpec::new("smooth", "most_rad_s", 0.001, 10.0), &mut self.most_rad_s);
    }
}

/// Constants derived from the parameters and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothPlan {
    interpolate: bool,
    /// Low-pass, if on: its angle in one period \[rad\] and `1 / (1 + sqrt(2) angle + angle^2)` of the implicit step,
    /// which is stable for every angle.
    low_pass: Option<(f32, f32)>,
    per_bound: f32,
}

impl SmoothPlan {
    /// For one call every `period_s` seconds.
    pub fn new(config: &SmoothConfig, period_s: f32) -> Self {
        let low_pass = (config.lag_s > 0.0).then(|| {
            let angle_rad = SQRT_2 * period_s / config.lag_s;
            (angle_rad, 1.0 / (1.0 + SQRT_2 * angle_rad + angle_rad * angle_rad))
        });
        Self {
            interpolate: config.interpolate,
            low_pass,
            per_bound: 1.0 / config.most_rad_s.unwrap_or(f32::INFINITY),
        }
    }
}

/// State of the smoothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct SmoothState {
    /// Age of the gyro's sample in the previous period \[control periods\].
    age_ticks: u16,
    /// Interpolation: periods left to the newest sample, change per period, present value.
    left_ticks: u16,
    change_rad_s: f32,
    interpolated_rad_s: f32,
    /// Low-pass output, and its rate divided by `w`; `None` before the first period.
    low_rad_s: Option<(f32, f32)>,
}

/// One control period: returns the smoothed roll rate \[rad/s\] from a gyro's sample of age `age_ticks`.
#[inline]
pub fn step(plan: &SmoothPlan, state: &mut SmoothState, rate_rad_s: f32, age_ticks: u16) -> f32 {
    let mut output_rad_s = rate_rad_s;
    // A gyro as fast as the control loop, the common case, needs no interpolation.
    if plan.interpolate && (age_ticks | state.age_ticks) > 0 {
        output_rad_s = state.interpolate_step(rate_rad_s, age_ticks);
    }
    if let Some((angle_rad, factor)) = plan.low_pass {
        let (low_rad_s, change_rad_s) = state.low_rad_s.unwrap_or((output_rad_s, 0.0));
        let change_rad_s = factor * (change_rad_s + angle_rad * (output_rad_s - low_rad_s));
        let low_rad_s = low_rad_s + angle_rad * change_rad_s;
        state.low_rad_s = Some((low_rad_s, change_rad_s));
        let fast_rad_s = output_rad_s - low_rad_s;
        let ratio = fast_rad_s * plan.per_bound;
        output_rad_s -= fast_rad_s / (1.0 + ratio * ratio);
    }
    output_rad_s
}

impl SmoothState {
    /// Output of the low-pass, and its rate divided by its angular frequency \[rad/s\]; `None` before the first period.
    pub fn low_pass(&self) -> Option<(f32, f32)> {
        self.low_rad_s
    }

    /// The interpolated roll rate.
    #[inline(always)]
    fn interpolate_step(&mut self, rate_rad_s: f32, age_ticks: u16) -> f32 {
        let interval_ticks = self.age_ticks.saturating_add(1);
        if interval_ticks == 1 && self.left_ticks == 0 {
            // No interpolation is running: the last period's output was this sample.
            self.interpolated_rad_s = rate_rad_s;
        }
        self.age_ticks = age_ticks;
        if age_ticks == 0 && interval_ticks <= LONGEST_TICKS {
            self.left_ticks = interval_ticks;
            self.change_rad_s = (rate_rad_s - self.interpolated_rad_s) / f32::from(interval_ticks);
        }
        if self.left_ticks > 1 {
            self.left_ticks -= 1;
            self.interpolated_rad_s += self.change_rad_s;
        } else {
            (self.left_ticks, self.interpolated_rad_s) = (0, rate_rad_s);
        }
        self.interpolated_rad_s
    }
}
