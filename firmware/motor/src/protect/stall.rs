//! Stall protection: without motion one phase carries all the heat, so the current is reduced to a holding current.

use control::param::{ParamSpec, ParamVisitor};

/// Definition of a stall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StallConfig {
    /// Holding current \[A\]; a larger current without motion becomes a stall.
    pub hold_a: f32,
    /// Motor speed below which the motor counts as standing \[turns/s\].
    pub still_turns_s: f32,
    /// Time for which a larger current is permitted \[s\]; motion or a smaller request restores it at the same rate.
    pub time_s: f32,
}

impl StallConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("stall", "hold_a", 0.1, 200.0), &mut self.hold_a);
        to.number(&ParamSpec::new("stall", "still_turns_s", 0.0, 100.0), &mut self.still_turns_s);
        to.number(&ParamSpec::new("stall", "time_s", 0.01, 100.0), &mut self.time_s);
    }
}

/// State of the stall protection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StallState {
    /// Calls without motion.
    calls: u32,
    /// Whether only the holding current is permitted.
    pub stalled: bool,
}

/// One call of `period_s`: the current limit \[A\], at most `max_a`, for the requested current `requested_a` and a speed.
pub fn step(
    config: &StallConfig,
    state: &mut StallState,
    period_s: f32,
    requested_a: f32,
    speed_turns_s: f32,
    max_a: f32,
) -> f32 {
    let stands = requested_a.abs() > config.hold_a && speed_turns_s.abs() < config.still_turns_s;
    state.calls = if stands { state.calls.saturating_add(1) } else { state.calls.saturating_sub(1) };
    let full = (config.time_s / period_s) as u32;
    state.calls = state.calls.min(full);
    state.stalled = state.calls >= full || (state.stalled && state.calls > full / 2);
    if state.stalled { config.hold_a.min(max_a) } else { max_a }
}
