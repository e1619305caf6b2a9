//! A wheel's pulses to its speed, with the age of what is known.

use crate::age::Age;
use control::sensors::frame::{MISSING, Sample};
use control::sensors::wheel_speed::{WheelPulses, WheelPulsesConfig, WheelPulsesState, step as speed};

/// Speed beyond which an edge is a disturbance of the line and no pulse \[m/s\].
const FASTEST_M_S: f32 = 30.0;

/// Period from which on it is not known when an edge came: the board's timers are of 16 bits \[us\].
pub const SPAN_US: u32 = 1 << 16;

/// Silence after which a wheel stands whose last pulses are not known \[us\]: between two of them a wheel of 0.2 m/s
/// takes 0.69 s.
const STANDS_US: u32 = 1_000_000;

/// What is remembered of a wheel.
#[derive(Clone, Debug)]
pub struct WheelState {
    pulses: WheelPulses,
    state: WheelPulsesState,
    age: Age,
    /// The sample is missing until the next two pulses, or until there is none for [`STANDS_US`].
    lost: bool,
    /// Time since that began \[us\].
    lost_us: u32,
}

impl Default for WheelState {
    fn default() -> Self {
        let pulses = WheelPulses { last_edge_age_us: u32::MAX, ..WheelPulses::default() };
        Self { pulses, state: WheelPulsesState::default(), age: Age::default(), lost: false, lost_us: 0 }
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
/// An edge in a period of [`SPAN_US`] or more, the chip having stood still, came at an unknown time, and others may have
/// come with it: the wheel begins anew, and its sample is missing until two more pulses, or none for [`STANDS_US`].
///
/// The sample is new when a pulse came, while the next one is overdue, as that is news as well, and while the wheel
/// stands. A sensor that never says anything is a wheel that stands. The direction is not known: rolling back is
/// positive too.
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
    wheel.lost_us = if pulse { 0 } else { wheel.lost_us.saturating_add(elapsed_us) };
    wheel.lost &= p.last_period_us == 0 && wheel.lost_us < STANDS_US;
    let new = !wheel.lost && (pulse || overdue || value == 0.0);
    Sample { value, age_ticks: wheel.age.step(new) }
}

/// Least time between two pulses \[us\].
fn shortest_us(config: &WheelPulsesConfig) -> u32 {
    let way_m = core::f32::consts::TAU * config.radius_m / f32::from(config.pulses_per_turn.max(1));
    (1e6 * way_m * (1.0 - config.spacing_error) / FASTEST_M_S) as u32
}
