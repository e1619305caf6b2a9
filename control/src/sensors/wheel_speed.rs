//! Forward speed and its bounds from the pulses of a wheel sensor.
//!
//! Between two pulses the wheel travels less than one pulse distance. The speed therefore falls while no pulse arrives,
//! and the bounds widen.

use crate::maths::bounded;
use crate::param::{ParamSpec, ParamVisitor};

/// Parameters of the wheel and its sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelPulsesConfig {
    /// Pulses per turn of the wheel, 1..=4096.
    pub pulses_per_turn: u16,
    /// Wheel radius \[m\].
    pub radius_m: f32,
    /// Largest relative error of the distance between two pulses: unevenly spaced magnets.
    pub spacing_error: f32,
    /// Largest acceleration \[m/s^2\].
    pub max_accel_m_s2: f32,
    /// Largest deceleration \[m/s^2\].
    pub max_brake_m_s2: f32,
    /// Shortest window over which pulses are counted \[s\].
    pub window_s: f32,
    /// Speed below which the speed is reported as zero \[m/s\].
    pub standing_m_s: f32,
}

impl Default for WheelPulsesConfig {
    /// 16 pulses per turn of a 28-inch wheel, spacing error 5 %; 2 m/s^2 pedalling, 6 m/s^2 braking.
    fn default() -> Self {
        Self {
            pulses_per_turn: 16,
            radius_m: 0.35,
            spacing_error: 0.05,
            max_accel_m_s2: 2.0,
            max_brake_m_s2: 6.0,
            window_s: 0.02,
            standing_m_s: 0.2,
        }
    }
}

impl WheelPulsesConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let own = |name, min, max| ParamSpec::new("pulses", name, min, max);
        to.count(&own("pulses_per_turn", 1.0, 4096.0), &mut self.pulses_per_turn);
        to.number(&own("radius_m", 0.02, 1.5), &mut self.radius_m);
        to.number(&own("spacing_error", 0.0, 0.5), &mut self.spacing_error);
        to.number(&own("max_accel_m_s2", 0.1, 100.0), &mut self.max_accel_m_s2);
        to.number(&own("max_brake_m_s2", 0.1, 100.0), &mut self.max_brake_m_s2);
        to.number(&own("window_s", 0.0, 1.0), &mut self.window_s);
        to.number(&own("standing_m_s", 0.0, 2.0), &mut self.standing_m_s);
    }
}

/// Direction in which the wheel turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// The sensor does not measure the direction; the speed is its magnitude.
    #[default]
    Unknown,
    /// Forward.
    Forward,
    /// Backward.
    Backward,
}

/// Reading of the pulse counter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WheelPulses {
    /// Number of pulses, wrapping.
    pub count: u16,
    /// Time since the last pulse \[us\]; `u32::MAX` before the first.
    pub last_edge_age_us: u32,
    /// Time between the last two pulses \[us\]; 0 before the second.
    pub last_period_us: u32,
    /// Direction.
    pub direction: Direction,
}

/// Speed, and its bounds for a wheel within the accelerations of [`WheelPulsesConfig`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelSpeed {
    /// Estimate \[m/s\]; negative only if the direction is known to be backward.
    pub speed_m_s: f32,
    /// Lower bound \[m/s\].
    pub low_m_s: f32,
    /// Upper bound \[m/s\].
    pub high_m_s: f32,
}

/// State of the pulse evaluation.
#[derive(Clone, Debug, Default)]
pub struct WheelPulsesState {
    /// Pulses of the last complete window, and its duration \[s\]; 0 before the first.
    pulses: f32,
    span_s: f32,
    /// Count at the window's end, and the time since then \[us\]; `None` before the first pulse.
    end: Option<(u16, u32)>,
    /// Time since start-up \[us\].
    running_us: u32,
}

/// Longest window \[us\].
const LONGEST_US: u32 = 10_000_000;
/// Largest reported speed \[m/s\].
const MAX_SPEED_M_S: f32 = 50.0;

/// One control period of duration `elapsed_us` \[us\].
pub fn step(
    config: &WheelPulsesConfig,
    state: &mut WheelPulsesState,
    pulses: &WheelPulses,
    elapsed_us: u32,
) -> WheelSpeed {
    state.running_us = state.running_us.saturating_add(elapsed_us);
    let age_us = pulses.last_edge_age_us.min(state.running_us);
    if pulses.last_edge_age_us != u32::MAX {
        let end = state.end.map(|(count, since)| (count, since.saturating_add(elapsed_us)));
        state.end = end;
        match end {
            Some((count, since)) if since <= LONGEST_US => {
                let new = pulses.count.wrapping_sub(count);
                let span_s = 1e-6 * since.saturating_sub(pulses.last_edge_age_us) as f32;
                if new > 0 && span_s > 0.0 && span_s >= config.window_s {
                    (state.pulses, state.span_s) = (f32::from(new), span_s);
                    state.end = Some((pulses.count, pulses.last_edge_age_us));
                }
            }
            _ => {
                let period_s = 1e-6 * pulses.last_period_us.min(LONGEST_US) as f32;
                (state.pulses, state.span_s) = (if period_s > 0.0 { 1.0 } else { 0.0 }, period_s);
                state.end = Some((pulses.count, pulses.last_edge_age_us));
            }
        }
    }
    let since_s = 1e-6 * state.end.map_or(age_us, |(_, since)| since) as f32;
    let speed = speed(config, state, 1e-6 * age_us as f32, since_s);
    match pulses.direction {
        Direction::Backward => {
            WheelSpeed { speed_m_s: -speed.speed_m_s, low_m_s: -speed.high_m_s, high_m_s: -speed.low_m_s }
        }
        Direction::Forward | Direction::Unknown => speed,
    }
}

/// Magnitude of the speed and its bounds, `age_s` after the last pulse and `since_s` after the end of the window \[s\].
///
/// Over the window the mean speed was `u`; at its end the speed differed from `u` by at most half the window's possible
/// change. Since the last pulse the wheel has travelled less than one pulse distance: the upper bound is that of a
/// wheel that accelerated throughout that distance, from rest at the slowest.
fn speed(c: &WheelPulsesConfig, state: &WheelPulsesState, age_s: f32, since_s: f32) -> WheelSpeed {
    let distance_m = core::f32::consts::TAU * c.radius_m / f32::from(c.pulses_per_turn.max(1));
    let max_distance_m = distance_m * (1.0 + c.spacing_error);
    let rise_s = libm::sqrtf(2.0 * max_distance_m / c.max_accel_m_s2);
    let age = if age_s < rise_s { age_s } else { rise_s }.max(1e-6);
    let mut high = bounded(max_distance_m / age + 0.5 * c.max_accel_m_s2 * age, MAX_SPEED_M_S);
    let (mut estimate, mut low) = (0.0, 0.0);
    if state.span_s > 0.0 {
        let u = bounded(state.pulses * distance_m / state.span_s, MAX_SPEED_M_S);
        let spacing = c.spacing_error * distance_m / state.span_s;
        let uncertain_s = 0.5 * state.span_s + since_s;
        high = high.min(u + spacing + c.max_accel_m_s2 * uncertain_s);
        low = (u - spacing - c.max_brake_m_s2 * uncertain_s).max(0.0).min(high);
        estimate = u.min(distance_m / age_s.max(1e-6));
        if estimate < c.standing_m_s {
            estimate = 0.0;
        }
    }
    WheelSpeed { speed_m_s: estimate.max(low).min(high), low_m_s: low, high_m_s: high }
}
