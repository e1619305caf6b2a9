//! The roll rate as the law gets it: without steps between two samples of a slow gyro, and without vibration.
//!
//! * **Interpolation**: a gyro of 100 Hz changes every ten control periods of 1 ms by as much as the bicycle moves in
//!   10 ms. Held, each change is a step of the torque; on a straight line from sample to sample it is none, and each
//!   sample counts in full one sampling period late. A gyro as fast as the control loop passes unchanged.
//! * **Low-pass**: vibration of road and motor lies above 10 Hz, a fall of a bicycle below 2 Hz. Of second order, maximally
//!   flat (Butterworth): `y'' = w^2 (x - y) - sqrt(2) w y'`, which delays what is slow by `sqrt(2) / w`. Vibration is also
//!   small: what the low-pass would take away counts up to a bound only, so that a fall, which is faster, is not late
//!   but by that bound smaller.

use crate::param::{ParamSpec, ParamVisitor};
use core::f32::consts::SQRT_2;

/// Longest time between two samples that is bridged \[control periods\]; after a longer one the next sample counts at once.
const LONGEST_TICKS: u16 = 100;

/// How the roll rate is smoothed. The default leaves it as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmoothConfig {
    /// Whether it moves on a straight line between two samples of a gyro slower than the control loop.
    pub interpolate: bool,
    /// By how much the low-pass delays what is slow \[s\]; 0 is none. It halves the power at `1 / (sqrt(2) pi lag_s)`.
    pub lag_s: f32,
    /// Most that the low-pass takes away, either way \[rad/s\]; `None` is any.
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

/// What follows from it for calls of one rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothPlan {
    interpolate: bool,
    /// Angle of the low-pass in one period \[rad\], if there is one, and `1 / (1 + sqrt(2) angle + angle^2)`, which makes the
    /// step an implicit one: stable for every angle.
    low_pass: Option<(f32, f32)>,
    per_most: f32,
}

impl SmoothPlan {
    /// For one call every `period_s`.
    pub fn new(config: &SmoothConfig, period_s: f32) -> Self {
        let low_pass = (config.lag_s > 0.0).then(|| {
            let angle_rad = SQRT_2 * period_s / config.lag_s;
            (angle_rad, 1.0 / (1.0 + SQRT_2 * angle_rad + angle_rad * angle_rad))
        });
        Self {
            interpolate: config.interpolate,
            low_pass,
            per_most: 1.0 / config.most_rad_s.unwrap_or(f32::INFINITY),
        }
    }
}

/// What is remembered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmoothState {
    /// Age of the gyro's sample in the period before.
    age_ticks: u16,
    /// Periods that are left to the newest sample, the change in each, and where the line is.
    left_ticks: u16,
    change_rad_s: f32,
    line_rad_s: f32,
    /// The low-pass and its rate by `w`; none before the first period.
    low_rad_s: Option<(f32, f32)>,
}

/// One control period: the roll rate \[rad/s\] by a gyro's sample of this age.
#[inline]
pub fn step(plan: &SmoothPlan, state: &mut SmoothState, rate_rad_s: f32, age_ticks: u16) -> f32 {
    let mut out_rad_s = rate_rad_s;
    // As nearly always the gyro is as fast as the control loop.
    if plan.interpolate && (age_ticks | state.age_ticks) > 0 {
        out_rad_s = state.between(rate_rad_s, age_ticks);
    }
    if let Some((angle_rad, share)) = plan.low_pass {
        let (low_rad_s, change_rad_s) = state.low_rad_s.unwrap_or((out_rad_s, 0.0));
        let change_rad_s = share * (change_rad_s + angle_rad * (out_rad_s - low_rad_s));
        let low_rad_s = low_rad_s + angle_rad * change_rad_s;
        state.low_rad_s = Some((low_rad_s, change_rad_s));
        let fast_rad_s = out_rad_s - low_rad_s;
        let ratio = fast_rad_s * plan.per_most;
        out_rad_s -= fast_rad_s / (1.0 + ratio * ratio);
    }
    out_rad_s
}

impl SmoothState {
    /// The line's value.
    #[inline(always)]
    fn between(&mut self, rate_rad_s: f32, age_ticks: u16) -> f32 {
        let apart_ticks = self.age_ticks.saturating_add(1);
        if apart_ticks == 1 && self.left_ticks == 0 {
            // Nothing is bridged: the last period had this sample for its own.
            self.line_rad_s = rate_rad_s;
        }
        self.age_ticks = age_ticks;
        if age_ticks == 0 && apart_ticks <= LONGEST_TICKS {
            self.left_ticks = apart_ticks;
            self.change_rad_s = (rate_rad_s - self.line_rad_s) / f32::from(apart_ticks);
        }
        if self.left_ticks > 1 {
            self.left_ticks -= 1;
            self.line_rad_s += self.change_rad_s;
        } else {
            (self.left_ticks, self.line_rad_s) = (0, rate_rad_s);
        }
        self.line_rad_s
    }
}
