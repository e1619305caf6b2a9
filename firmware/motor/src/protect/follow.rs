//! Whether the current goes where it is sent: a phase that is cut, a driver that is dead.

use super::follow_mean;
use crate::fault::Fault;
use crate::transform::Vector;
use control::param::{Leaf, Visit};

/// How far the current may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowConfig {
    /// Largest mean distance from what is wanted \[A\].
    pub error_a: f32,
    /// Time constant of the mean \[calls\].
    pub mean_ticks: u16,
}

impl FollowConfig {
    /// Shows every parameter.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        to.number(&Leaf::new("follow", "error_a", 0.01, 100.0), &mut self.error_a);
        to.count(&Leaf::new("follow", "mean_ticks", 1.0, 10_000.0), &mut self.mean_ticks);
    }
}

/// Means of the distance, and of what each phase carries and should carry \[A\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FollowState {
    error_a: f32,
    carried_a: [f32; 3],
    wanted_a: [f32; 3],
}

/// A phase that carries less than this share of what it should is cut, if the others carry more than that.
const CUT: f32 = 0.25;

/// One call. `reachable`: the voltage would suffice; what it does not suffice for is no fault.
pub fn step(
    config: &FollowConfig,
    state: &mut FollowState,
    error: Vector,
    phases_a: [f32; 3],
    wanted_a: [f32; 3],
    reachable: bool,
) -> Option<Fault> {
    let gain = 1.0 / f32::from(config.mean_ticks);
    follow_mean(&mut state.error_a, if reachable { error.length() } else { 0.0 }, gain);
    let means = state.carried_a.iter_mut().zip(&mut state.wanted_a);
    for ((carried, wanted), (is, should)) in means.zip(phases_a.iter().zip(wanted_a)) {
        follow_mean(carried, is.abs(), gain);
        follow_mean(wanted, should.abs(), gain);
    }
    if state.error_a <= config.error_a {
        return None;
    }
    let mut cut = [false; 3];
    for (cut, (carried, wanted)) in cut.iter_mut().zip(state.carried_a.iter().zip(state.wanted_a)) {
        *cut = *carried < CUT * wanted;
    }
    Some(match cut {
        [true, false, false] => Fault::PhaseALost,
        [false, true, false] => Fault::PhaseBLost,
        [false, false, true] => Fault::PhaseCLost,
        _ => Fault::CurrentAstray,
    })
}
