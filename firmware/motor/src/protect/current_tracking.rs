//! Whether the current goes where it is sent: a phase that is cut, a driver that is dead.

use super::follow_mean;
use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// How far the current may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentTrackingConfig {
    /// Largest mean distance from what is wanted \[A\].
    pub error_a: f32,
    /// Time constant of the mean \[calls\].
    pub mean_ticks: u16,
}

impl CurrentTrackingConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("follow", "error_a", 0.01, 100.0), &mut self.error_a);
        to.count(&ParamSpec::new("follow", "mean_ticks", 1.0, 10_000.0), &mut self.mean_ticks);
    }
}

/// What is remembered of the currents.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurrentTrackingState {
    /// Mean distance of the current from what is wanted \[A\].
    error_a: f32,
    /// Calls in a row in which a phase carried nothing.
    dead: [u16; 3],
}

/// Part of the largest distance that is as good as nothing.
const NOTHING: f32 = 0.2;
/// Calls without current after which a phase counts as cut, if the others carry some.
const DEAD: u16 = 10;

/// One call, by the distance of the current from what is wanted. `reachable`: the voltage would suffice; what it
/// does not suffice for is no fault.
pub fn step(
    config: &CurrentTrackingConfig,
    state: &mut CurrentTrackingState,
    error_a: f32,
    phases_a: [f32; 3],
    reachable: bool,
) -> Option<Fault> {
    let gain = 1.0 / f32::from(config.mean_ticks);
    follow_mean(&mut state.error_a, if reachable { error_a } else { 0.0 }, gain);
    for (dead, i) in state.dead.iter_mut().zip(phases_a) {
        *dead = if i.abs() < NOTHING * config.error_a { dead.saturating_add(1) } else { 0 };
    }
    if state.error_a <= config.error_a {
        return None;
    }
    Some(match state.dead.map(|calls| calls >= DEAD) {
        [true, false, false] => Fault::PhaseALost,
        [false, true, false] => Fault::PhaseBLost,
        [false, false, true] => Fault::PhaseCLost,
        _ => Fault::CurrentAstray,
    })
}
