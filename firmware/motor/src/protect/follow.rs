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

/// A phase is cut that carries less than this share of what it should, and of what either of the others carries.
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
    let [a, b, c] = state.carried_a;
    let [wanted_a, wanted_b, wanted_c] = state.wanted_a;
    let cut = |carried: f32, wanted: f32, others: f32| carried < CUT * wanted.min(others);
    Some(if cut(a, wanted_a, b.min(c)) {
        Fault::PhaseALost
    } else if cut(b, wanted_b, c.min(a)) {
        Fault::PhaseBLost
    } else if cut(c, wanted_c, a.min(b)) {
        Fault::PhaseCLost
    } else {
        Fault::CurrentAstray
    })
}
