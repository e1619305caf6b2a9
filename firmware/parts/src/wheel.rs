//! A wheel's pulses to its speed, with the age of what is known.

use crate::age::Age;
use control::frame::Sample;
use control::pulses::{Pulses, PulsesConfig, PulsesState, step as speed};

/// Speed beyond which an edge is a disturbance of the line and no pulse \[m/s\].
const FASTEST_M_S: f32 = 30.0;

/// What is remembered of a wheel.
#[derive(Clone, Debug)]
pub struct WheelState {
    pulses: Pulses,
    state: PulsesState,
    age: Age,
}

impl Default for WheelState {
    fn default() -> Self {
        let pulses = Pulses { last_edge_age_us: u32::MAX, ..Pulses::default() };
        Self { pulses, state: PulsesState::default(), age: Age::default() }
    }
}

impl WheelState {
    /// Pulses so far, wrapping.
    pub fn count(&self) -> u16 {
        self.pulses.count
    }
}

/// One control period of `elapsed_us`, in which an edge came `edge_age_us` before its end, or none did. At most one
/// edge a period is seen, so pulses must stay apart by more than that.
///
/// The sample is new when a pulse came, while the next one is overdue, as that is news as well, and while the wheel
/// stands. A sensor that never says anything is a wheel that stands. The direction is not known: rolling back is positive too.
pub fn step(
    config: &PulsesConfig,
    wheel: &mut WheelState,
    edge_age_us: Option<u32>,
    elapsed_us: u32,
) -> Sample {
    let p = &mut wheel.pulses;
    let known = p.last_edge_age_us != u32::MAX;
    if known {
        // Before the value that stands for "never".
        p.last_edge_age_us = p.last_edge_age_us.saturating_add(elapsed_us).min(u32::MAX - 1);
    }
    let mut pulse = false;
    if let Some(age_us) = edge_age_us {
        let since_us = p.last_edge_age_us.saturating_sub(age_us);
        pulse = !known || since_us >= shortest_us(config);
        if pulse {
            p.last_period_us = if known { since_us } else { 0 };
            (p.count, p.last_edge_age_us) = (p.count.wrapping_add(1), age_us);
        }
    }
    let value = speed(config, &mut wheel.state, p, elapsed_us).speed_m_s;
    let overdue = p.last_edge_age_us > p.last_period_us;
    let new = pulse || overdue || value == 0.0;
    Sample { value, age_ticks: wheel.age.step(new) }
}

/// Least time between two pulses \[us\].
fn shortest_us(config: &PulsesConfig) -> u32 {
    let way_m = core::f32::consts::TAU * config.radius_m / f32::from(config.pulses_per_turn.max(1));
    (1e6 * way_m * (1.0 - config.spacing_error) / FASTEST_M_S) as u32
}
