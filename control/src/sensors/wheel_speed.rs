//! Forward speed from the pulses of a wheel, and between what bounds it lies.
//!
//! Between two pulses only one thing is known: less than a pulse's way was made. So the speed falls
//! as time passes without one, and the bounds say how little is known.

use crate::maths::bounded;
use crate::param::{ParamSpec, ParamVisitor};

/// The wheel and its sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelPulsesConfig {
    /// Pulses in a turn of the wheel, 1..=4096.
    pub pulses_per_turn: u16,
    /// Wheel radius \[m\].
    pub radius_m: f32,
    /// Largest error of the way between two pulses, as a part of it: magnets not evenly spaced.
    pub spacing_error: f32,
    /// Largest gain of speed \[m/s^2\].
    pub max_accel_m_s2: f32,
    /// Largest loss of speed \[m/s^2\].
    pub max_brake_m_s2: f32,
    /// Pulses are counted for at least this long \[s\].
    pub window_s: f32,
    /// Speed below which the wheel is said to stand \[m/s\].
    pub standing_m_s: f32,
}

impl Default for WheelPulsesConfig {
    /// 16 pulses a turn of a 28-inch wheel, 5 % uneven; 2 m/s^2 pedalled, 6 m/s^2 braked.
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
    /// Shows every parameter.
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

/// Which way the wheel turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// The sensor can't tell; the speed is its magnitude.
    #[default]
    Unknown,
    /// Forward.
    Forward,
    /// Backward.
    Backward,
}

/// What the pulse counter says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WheelPulses {
    /// Pulses so far, wrapping.
    pub count: u16,
    /// Time since the last one \[us\]; `u32::MAX` before the first.
    pub last_edge_age_us: u32,
    /// Time between the last two \[us\]; 0 before the second.
    pub last_period_us: u32,
    /// Which way.
    pub direction: Direction,
}

/// The speed, and what it lies between if the bicycle obeys [`WheelPulsesConfig`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelSpeed {
    /// Best guess \[m/s\]; negative only if the direction is known to be backward.
    pub speed_m_s: f32,
    /// Not below this \[m/s\].
    pub low_m_s: f32,
    /// Not above this \[m/s\].
    pub high_m_s: f32,
}

/// What is remembered of the pulses.
#[derive(Clone, Debug, Default)]
pub struct WheelPulsesState {
    /// The pulses of the last whole window, and how long they took \[s\]; 0 before the first.
    pulses: f32,
    span_s: f32,
    /// Count at the window's end, and the time since \[us\]; `None` before the first edge.
    end: Option<(u16, u32)>,
    /// Time since the start \[us\].
    running_us: u32,
}

/// Longest time over which pulses are counted \[us\].
const LONGEST_US: u32 = 10_000_000;
/// Fastest that anything is said to go \[m/s\].
const FASTEST_M_S: f32 = 50.0;

/// One control period of `elapsed_us`.
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

/// The speed's magnitude, `age_s` after the last pulse and `since_s` after the window.
///
/// Over the window the mean speed was `u`; at its end the speed was `u` but for half the window's change.
/// Since the last pulse less than a pulse's way was made, so at the quickest the wheel stood and then
/// gathered speed over that way.
fn speed(c: &WheelPulsesConfig, state: &WheelPulsesState, age_s: f32, since_s: f32) -> WheelSpeed {
    let way = core::f32::consts::TAU * c.radius_m / f32::from(c.pulses_per_turn.max(1));
    let most_way = way * (1.0 + c.spacing_error);
    let up = libm::sqrtf(2.0 * most_way / c.max_accel_m_s2);
    let age = if age_s < up { age_s } else { up }.max(1e-6);
    let mut high = bounded(most_way / age + 0.5 * c.max_accel_m_s2 * age, FASTEST_M_S);
    let (mut guess, mut low) = (0.0, 0.0);
    if state.span_s > 0.0 {
        let u = bounded(state.pulses * way / state.span_s, FASTEST_M_S);
        let uneven = c.spacing_error * way / state.span_s;
        let later = 0.5 * state.span_s + since_s;
        high = high.min(u + uneven + c.max_accel_m_s2 * later);
        low = (u - uneven - c.max_brake_m_s2 * later).max(0.0).min(high);
        guess = u.min(way / age_s.max(1e-6));
        if guess < c.standing_m_s {
            guess = 0.0;
        }
    }
    WheelSpeed { speed_m_s: guess.max(low).min(high), low_m_s: low, high_m_s: high }
}
