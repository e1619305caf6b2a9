//! Checks that the current follows its set-point; detects an open phase or a dead driver.

use super::follow_mean;
use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// Tolerance of the current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentTrackingConfig {
    /// Largest mean deviation from the set-point \[A\].
    pub error_a: f32,
    /// Time constant of the mean \[calls\].
    pub mean_calls: u16,
}

impl CurrentTrackingConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("follow", "error_a", 0.01, 100.0), &mut self.error_a);
        to.count(&ParamSpec::new("follow", "mean_calls", 1.0, 10_000.0), &mut self.mean_calls);
    }
}

/// State of the check.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurrentTrackingState {
    /// Mean deviation of the current from the set-point \[A\].
    error_a: f32,
    /// Consecutive calls in which a phase carried no current.
    dead: [u16; 3],
}

/// Fraction of `error_a` below which a current counts as zero.
const NOTHING: f32 = 0.2;
/// Calls without current after which a phase counts as open, if the others carry current.
const DEAD: u16 = 10;

/// One call with the deviation of the current from its set-point. `reachable`: the voltage suffices for the set-point;
/// otherwise a deviation is no fault.
pub fn step(
    config: &CurrentTrackingConfig,
    state: &mut CurrentTrackingState,
    error_a: f32,
    phases_a: [f32; 3],
    reachable: bool,
) -> Option<Fault> {
    let gain = 1.0 / f32::from(config.mean_calls);
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
        _ => Fault::CurrentTracking,
    })
}
