//! Simulates many rides on one core with the widest available vector instructions, or one.

use super::backend::Backend;
use super::instructions::Instructions;
use super::lanes::Needed;
use super::{Conditions, Remote, RemoteError, Ride, Start, TracePoint};
use crate::bicycle::{Accelerations, Geometry, State, Torques};

/// Most rides that are simulated side by side: 16 on a processor with AVX-512, 4 with AVX2 or on aarch64, otherwise 1.
pub fn side_by_side() -> usize {
    Instructions::of_this_processor().lanes()
}

/// Simulates every ride to its end; results in the order of `starts`.
///
/// In as many lanes as take the least time, at most [`side_by_side`], without fused multiply-add. The bits are the same.
pub fn rides(conditions: &Conditions, starts: &[Start]) -> Vec<Ride> {
    Instructions::of_this_processor().rides(conditions, starts, Needed::Effort, equal(starts.len()))
}

/// Rides that last equally long.
pub(super) fn equal(count: usize) -> impl Iterator<Item = f64> + Clone {
    std::iter::repeat_n(1.0, count)
}

/// The accelerations at every state under the same torques, as many side by side as rides.
pub fn accelerations(b: &Geometry, states: &[State<f64>], torques: &Torques<f64>) -> Vec<Accelerations<f64>> {
    Instructions::of_this_processor().accelerations(b, states, torques)
}

/// Simulates one ride and records every control period; the bits are the same as in a batch.
pub fn traced(conditions: &Conditions, start: Start) -> (Ride, Vec<TracePoint>) {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut done = alone(conditions, start, &mut trace, &mut Backend::Local);
    (done.remove(0), trace)
}

/// As [`traced`]; `stop` is called in every control period, and there is no ride once it returns true.
pub fn traced_until(
    conditions: &Conditions,
    start: Start,
    stop: &dyn Fn() -> bool,
) -> Option<(Ride, Vec<TracePoint>)> {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut done = alone(conditions, start, &mut trace, &mut Backend::Until(stop));
    done.pop().map(|ride| (ride, trace))
}

fn alone(
    conditions: &Conditions,
    start: Start,
    trace: &mut Vec<TracePoint>,
    backend: &mut Backend<'_>,
) -> Vec<Ride> {
    Instructions::of_this_processor().in_turn(conditions, &[start], Needed::Trace(trace), backend)
}

/// As [`rides`], one after the other, with the control step on an external processor.
///
/// # Errors
/// The processor fails.
pub fn rides_on(
    conditions: &Conditions,
    starts: &[Start],
    remote: &mut dyn Remote,
) -> Result<Vec<Ride>, RemoteError> {
    let mut backend = Backend::remote(remote);
    let done = Instructions::of_this_processor().in_turn(conditions, starts, Needed::Effort, &mut backend);
    backend.end().map(|()| done)
}

/// As [`traced`], with the control step on an external processor.
///
/// # Errors
/// The processor fails.
pub fn traced_on(
    conditions: &Conditions,
    start: Start,
    remote: &mut dyn Remote,
) -> Result<(Ride, Vec<TracePoint>), RemoteError> {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut backend = Backend::remote(remote);
    let mut done = alone(conditions, start, &mut trace, &mut backend);
    backend.end().map(|()| (done.remove(0), trace))
}
