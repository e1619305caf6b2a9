//! Converts a wheel's pulses to a speed sample with its age.

use crate::age::Age;
use control::sensors::frame::{MISSING, Sample};
use control::sensors::wheel_speed::{WheelPulses, WheelPulsesConfig, WheelPulsesState, step as speed};

/// Speed above which an edge is a disturbance and not a pulse \[m/s\].
const FASTEST_M_S: f32 = 30.0;

/// Control period from which on the time of an edge is unknown, as the board's timers have 16 bits \[us\].
pub const SPAN_US: u32 = 1 << 16;

/// Time without pulses after which a wheel with unknown last pulses counts as standing \[us\]: at 0.2 m/s pulses are
/// 0.69 s apart.
const STANDS_US: u32 = 1_000_000;

/// State of a wheel.
#[derive(Clone, Debug)]
pub struct WheelState {
    pulses: WheelPulses,
    state: WheelPulsesState,
    age: Age,
    /// The sample is missing until two more pulses, or until none for [`STANDS_US`].
    lost: bool,
    /// Time since the last pulse, or since the loss \[us\].
    lost_us: u32,
}

impl Default for WheelState {
    fn default() -> Self {
        let pulses = WheelPulses { last_edge_age_us: u32::MAX, ..WheelPulses::default() };
        Self { pulses, state: WheelPulsesState::default(), age: Age::default(), lost: false, lost_us: 0 }
    }
}

impl WheelState {
    /// Number of pulses, wrapping.
    pub fn count(&self) -> u16 {
        self.pulses.count
    }
}

/// One control period of `elapsed_us`, with an edge `edge_age_us` before its end, or without one. At most one edge per
/// period is seen, so pulses must be further apart than a period.
///
/// An edge in a period of [`SPAN_US`] or more (the chip was halted) has an unknown time, and there can be more of
/// them: the state is reset, and the sample is missing until two more pulses, or none for `STANDS_US`.
///
/// The sample is new with a pulse, while the next pulse is overdue, as that bounds the speed, and while the wheel
/// stands. A sensor that never gives a pulse is indistinguishable from a standing wheel. The direction is unknown:
/// rolling back is positive too.
pub fn step(
    config: &WheelPulsesConfig,
    wheel: &mut WheelState,
    edge_age_us: Option<u32>,
    elapsed_us: u32,
) -> Sample {
    if elapsed_us >= SPAN_US && edge_age_us.is_some() {
        *wheel = WheelState { lost: true, ..WheelState::default() };
        return Sample { value: 0.0, age_ticks: MISSING };
    }
    let p = &mut wheel.pulses;
    let known = p.last_edge_age_us != u32::MAX;
    if known {
        // Stays below the value that means "never".
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
    wheel.lost_us = if pulse { 0 } else { wheel.lost_us.saturating_add(elapsed_us) };
    wheel.lost &= p.last_period_us == 0 && wheel.lost_us < STANDS_US;
    let new = !wheel.lost && (pulse || overdue || value == 0.0);
    Sample { value, age_ticks: wheel.age.step(new) }
}

/// Smallest time between two pulses \[us\].
fn shortest_us(config: &WheelPulsesConfig) -> u32 {
    let distance_m = core::f32::consts::TAU * config.radius_m / f32::from(config.pulses_per_turn.max(1));
    (1e6 * distance_m * (1.0 - config.spacing_error) / FASTEST_M_S) as u32
}
