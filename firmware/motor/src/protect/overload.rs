//! Thermal model of the winding (squared current): limits the current to the continuous one in time.

use super::{follow_mean, share};
use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// Parameters of the thermal model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverloadConfig {
    /// Continuous current, as the length of a vector \[A\].
    pub continuous_a: f32,
    /// Thermal time constant of the winding \[s\].
    pub time_s: f32,
}

impl OverloadConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("overload", "continuous_a", 0.1, 200.0), &mut self.continuous_a);
        to.number(&ParamSpec::new("overload", "time_s", 0.01, 1000.0), &mut self.time_s);
    }
}

/// Fraction of the allowed heat at which the limit begins to fall.
const BEGIN: f32 = 0.8;
/// Fraction of the allowed heat that the limited current can't reach: the bridge opens there.
const FAULT: f32 = 1.1;
/// Number of calls averaged per update of the heat: the change in one call is below f32 resolution.
const BLOCK: u16 = 64;

/// Heat as a mean square of the current \[A^2\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OverloadState {
    heat_a2: f32,
    block_a2: f32,
    count: u16,
}

/// One call of `period_s` with a squared current \[A^2\]: returns the current limit \[A\], at most `max_a`, and a
/// fault.
pub fn step(
    config: &OverloadConfig,
    state: &mut OverloadState,
    period_s: f32,
    current_a2: f32,
    max_a: f32,
) -> (f32, Option<Fault>) {
    state.block_a2 += current_a2;
    state.count += 1;
    if state.count >= BLOCK {
        let mean = state.block_a2 / f32::from(BLOCK);
        follow_mean(&mut state.heat_a2, mean, (f32::from(BLOCK) * period_s / config.time_s).min(1.0));
        (state.block_a2, state.count) = (0.0, 0);
    }
    let allowed = config.continuous_a * config.continuous_a;
    let left = share(state.heat_a2, allowed, BEGIN * allowed);
    let most = config.continuous_a.min(max_a);
    let limit = (most + (max_a - most) * left).min(max_a);
    (limit, (state.heat_a2 > FAULT * allowed).then_some(Fault::Overload))
}
