//! Alignment: finds the encoder's offset, and rejects it if the encoder does not follow the field.
//!
//! A current along d turns the rotor into the field's direction. The field moves
//!
//! ```text
//! -1/4 (current rises) -> 0 (rest, A) -> +1/4 (rest, B) -> 0 (rest, C)      electrical turns
//! ```
//!
//! The field begins a quarter turn off, so that a rotor that happens to point exactly against the final field does not
//! stay there. From A to B the encoder must move a quarter forward, from B to C back. The offset is the mean of the
//! offsets at B and C, which are approached from opposite sides, so that friction cancels.

use crate::angle::Angle;
use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// Parameters of the alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignConfig {
    /// Current along d \[A\].
    pub current_a: f32,
    /// Rise time of the current \[calls\].
    pub ramp_calls: u16,
    /// Duration of a move by a quarter turn \[calls\].
    pub move_calls: u16,
    /// Duration of a rest; the angle is the mean over its second half \[calls\].
    pub rest_calls: u16,
    /// Largest deviation of a move from a quarter turn, and largest motion during a rest \[electrical turns\].
    pub tolerance_turns: f32,
}

impl AlignConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("align", "current_a", 0.1, 100.0), &mut self.current_a);
        to.count(&ParamSpec::new("align", "ramp_calls", 1.0, 65535.0), &mut self.ramp_calls);
        to.count(&ParamSpec::new("align", "move_calls", 1.0, 65535.0), &mut self.move_calls);
        to.count(&ParamSpec::new("align", "rest_calls", 2.0, 65535.0), &mut self.rest_calls);
        to.number(&ParamSpec::new("align", "tolerance_turns", 0.001, 0.12), &mut self.tolerance_turns);
    }
}

/// Stage of the alignment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    #[default]
    Ramp,
    Move0,
    RestA,
    Forward,
    RestB,
    Back,
    RestC,
}

/// State of the alignment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AlignState {
    stage: Stage,
    /// Calls since the stage began.
    calls: u16,
    /// Electrical angles without offset during a rest \[turns\]: the first, and sum, count and extremes of the
    /// distances from it.
    first: Angle,
    sum_turns: f32,
    count: u16,
    least_turns: f32,
    most_turns: f32,
    /// Mean angles of the completed rests.
    a: Angle,
    b: Angle,
}

/// Output of the alignment in one call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Align {
    /// Apply a field at this electrical angle, with this d current \[A\].
    Field(Angle, f32),
    /// Completed: the offset \[electrical turns\].
    Found(Angle),
    /// Failed.
    Failed(Fault),
}

/// One call; `electrical` is the encoder's angle times the pole pairs, without offset.
pub fn step(config: &AlignConfig, state: &mut AlignState, electrical: Angle) -> Align {
    state.calls = state.calls.saturating_add(1);
    let (length, from, to) = match state.stage {
        Stage::Ramp => (config.ramp_calls, -0.25, -0.25),
        Stage::Move0 => (config.move_calls, -0.25, 0.0),
        Stage::RestA | Stage::RestC => (config.rest_calls, 0.0, 0.0),
        Stage::Forward => (config.move_calls, 0.0, 0.25),
        Stage::RestB => (config.rest_calls, 0.25, 0.25),
        Stage::Back => (config.move_calls, 0.25, 0.0),
    };
    let part = (f32::from(state.calls) / f32::from(length)).min(1.0);
    let rests = matches!(state.stage, Stage::RestA | Stage::RestB | Stage::RestC);
    if rests && part > 0.5 {
        watch(state, electrical);
    }
    let field = Angle::of(from + (to - from) * part);
    let current = if state.stage == Stage::Ramp { config.current_a * part } else { config.current_a };
    if state.calls < length { Align::Field(field, current) } else { next(config, state, field) }
}

/// Adds the angle to the mean of the rest.
fn watch(state: &mut AlignState, electrical: Angle) {
    if state.count == 0 {
        (state.first, state.sum_turns, state.least_turns, state.most_turns) = (electrical, 0.0, 0.0, 0.0);
    }
    let off = electrical.minus(state.first).signed();
    state.sum_turns += off;
    state.count = state.count.saturating_add(1);
    (state.least_turns, state.most_turns) = (state.least_turns.min(off), state.most_turns.max(off));
}

/// Ends a stage: checks the result and starts the next one.
fn next(config: &AlignConfig, state: &mut AlignState, field: Angle) -> Align {
    let tolerance = config.tolerance_turns;
    let mean = state.first.plus(Angle::of(state.sum_turns / f32::from(state.count.max(1))));
    let restless = state.most_turns - state.least_turns > tolerance;
    state.stage = match state.stage {
        Stage::Ramp => Stage::Move0,
        Stage::Move0 => Stage::RestA,
        Stage::RestA if restless => return Align::Failed(Fault::AlignRestless),
        Stage::RestA => {
            state.a = mean;
            Stage::Forward
        }
        Stage::Forward => Stage::RestB,
        Stage::RestB => {
            let moved = mean.minus(state.a).signed();
            if (moved + 0.25).abs() <= tolerance {
                return Align::Failed(Fault::AlignReversed);
            }
            if (moved - 0.25).abs() > tolerance {
                return Align::Failed(Fault::AlignLag);
            }
            if restless {
                return Align::Failed(Fault::AlignRestless);
            }
            state.b = mean;
            Stage::Back
        }
        Stage::Back => Stage::RestC,
        Stage::RestC => {
            if (state.b.minus(mean).signed() - 0.25).abs() > tolerance {
                return Align::Failed(Fault::AlignLag);
            }
            if restless {
                return Align::Failed(Fault::AlignRestless);
            }
            let apart = state.b.minus(Angle::QUARTER).minus(mean).signed();
            return Align::Found(mean.plus(Angle::of(0.5 * apart)));
        }
    };
    (state.calls, state.count) = (0, 0);
    Align::Field(field, config.current_a)
}
