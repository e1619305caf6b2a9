//! Torque without motion: one phase then carries the whole heat, so after a while only a holding current is left.

use control::param::{ParamSpec, ParamVisitor};

/// What a stall is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StallConfig {
    /// Current that may be held without motion \[A\]; more of it for long is a stall.
    pub hold_a: f32,
    /// Speed of the motor below which it stands \[turns/s\].
    pub still_turns_s: f32,
    /// Time for which more may be held \[s\]; motion, or less being asked for, gives it back as fast.
    pub time_s: f32,
}

impl StallConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("stall", "hold_a", 0.1, 200.0), &mut self.hold_a);
        to.number(&ParamSpec::new("stall", "still_turns_s", 0.0, 100.0), &mut self.still_turns_s);
        to.number(&ParamSpec::new("stall", "time_s", 0.01, 100.0), &mut self.time_s);
    }
}

/// What the watch remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StallState {
    /// Calls without motion.
    calls: u32,
    /// Whether only the holding current is left.
    pub stalled: bool,
}

/// One call of `period_s`: the largest current \[A\] of at most `max_a`, when `asked_a` is asked for at a speed.
pub fn step(
    config: &StallConfig,
    state: &mut StallState,
    period_s: f32,
    asked_a: f32,
    speed_turns_s: f32,
    max_a: f32,
) -> f32 {
    let stands = asked_a.abs() > config.hold_a && speed_turns_s.abs() < config.still_turns_s;
    state.calls = if stands { state.calls.saturating_add(1) } else { state.calls.saturating_sub(1) };
    let full = (config.time_s / period_s) as u32;
    state.calls = state.calls.min(full);
    state.stalled = state.calls >= full || (state.stalled && state.calls > full / 2);
    if state.stalled { config.hold_a.min(max_a) } else { max_a }
}
