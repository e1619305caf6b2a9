//! The current sensors' zeros, taken once while the bridge is off.

use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// How the zeros are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentOffsetConfig {
    /// Samples of which they are the mean.
    pub samples: u16,
    /// Largest zero that is no fault \[A\].
    pub max_a: f32,
    /// Largest distance between two samples of a phase meanwhile that is no fault \[A\].
    pub spread_a: f32,
}

impl CurrentOffsetConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.count(&ParamSpec::new("zero", "samples", 1.0, 20_000.0), &mut self.samples);
        to.number(&ParamSpec::new("zero", "max_a", 0.0, 100.0), &mut self.max_a);
        to.number(&ParamSpec::new("zero", "spread_a", 0.0, 100.0), &mut self.spread_a);
    }
}

/// What has been taken so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurrentOffsetState {
    taken: u16,
    sum_a: [f32; 3],
    least_a: [f32; 3],
    most_a: [f32; 3],
    zeros_a: Option<[f32; 3]>,
}

impl CurrentOffsetState {
    /// The zeros, once they are taken \[A\].
    pub fn zeros_a(&self) -> Option<[f32; 3]> {
        self.zeros_a
    }
}

/// One more sample of the three currents; a fault ends it.
pub fn step(config: &CurrentOffsetConfig, state: &mut CurrentOffsetState, raw_a: [f32; 3]) -> Option<Fault> {
    if state.taken == 0 {
        (state.least_a, state.most_a) = (raw_a, raw_a);
    }
    state.taken = state.taken.saturating_add(1);
    let mut restless = false;
    let ranges = state.least_a.iter_mut().zip(&mut state.most_a);
    for ((sum, (least, most)), raw) in state.sum_a.iter_mut().zip(ranges).zip(raw_a) {
        *sum += raw;
        (*least, *most) = (least.min(raw), most.max(raw));
        restless |= *most - *least > config.spread_a;
    }
    let zeros = state.sum_a.map(|sum| sum / f32::from(state.taken));
    if state.taken >= config.samples {
        // Written so that NaN, which compares false, is a fault.
        restless |= !zeros.iter().all(|zero| zero.abs() <= config.max_a);
        state.zeros_a = Some(zeros);
    }
    restless.then_some(Fault::CurrentZero)
}
