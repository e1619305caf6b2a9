//! Measures the offsets of the current sensors once, while the bridge is open.

use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// Parameters of the offset measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentOffsetConfig {
    /// Number of samples to average.
    pub samples: u16,
    /// Largest valid offset \[A\].
    pub max_a: f32,
    /// Largest valid spread of the samples of a phase \[A\].
    pub spread_a: f32,
}

impl CurrentOffsetConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.count(&ParamSpec::new("zero", "samples", 1.0, 20_000.0), &mut self.samples);
        to.number(&ParamSpec::new("zero", "max_a", 0.0, 100.0), &mut self.max_a);
        to.number(&ParamSpec::new("zero", "spread_a", 0.0, 100.0), &mut self.spread_a);
    }
}

/// State of the measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurrentOffsetState {
    taken: u16,
    sum_a: [f32; 3],
    least_a: [f32; 3],
    most_a: [f32; 3],
    zeros_a: Option<[f32; 3]>,
}

impl CurrentOffsetState {
    /// The offsets, once measured \[A\].
    pub fn zeros_a(&self) -> Option<[f32; 3]> {
        self.zeros_a
    }
}

/// Adds one sample of the three currents; a fault ends the measurement.
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
        // Negated so that NaN, which compares false, is a fault.
        restless |= !zeros.iter().all(|zero| zero.abs() <= config.max_a);
        state.zeros_a = Some(zeros);
    }
    restless.then_some(Fault::CurrentZero)
}
