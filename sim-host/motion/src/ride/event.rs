//! Finds the instant of a fall within a time step.

use super::{FallCause, FallCriterion};
use crate::bicycle::State;

/// Whether a state counts as fallen by its angles, or is not finite (the model has no solution).
pub(super) fn fallen(fall: &FallCriterion, state: &State<f64>) -> bool {
    let upright = state.roll.abs() < fall.roll_rad && state.steer.abs() < fall.steer_rad;
    !(upright && state.rear_wheel_rate.is_finite())
}

/// Time in a step of `h` seconds, 0 to `h`, at which the first of roll and steer passes its limit, and which
/// one.
///
/// Bisection to 1e-9 s on the cubic through both ends' values and rates, whose error at a time step of 1 ms
/// is below a nanosecond. A step that ends in a state that is not finite counts as a fall at its start.
pub(super) fn time_of_fall(
    fall: &FallCriterion,
    (before, after): (&State<f64>, &State<f64>),
    h: f64,
) -> (f64, FallCause) {
    let roll = [before.roll, after.roll, before.roll_rate * h, after.roll_rate * h];
    let steer = [before.steer, after.steer, before.steer_rate * h, after.steer_rate * h];
    if roll.iter().chain(&steer).chain([&after.rear_wheel_rate]).any(|x| !x.is_finite()) {
        return (0.0, FallCause::NoMotion);
    }
    let rolled = |s: f64| hermite(&roll, s).abs() >= fall.roll_rad;
    let beyond = |s: f64| rolled(s) || hermite(&steer, s).abs() >= fall.steer_rad;
    let (mut low, mut high) = (0.0, 1.0);
    while (high - low) * h > 1e-9 {
        let middle = 0.5 * (low + high);
        if beyond(middle) { high = middle } else { low = middle }
    }
    (high * h, if rolled(high) { FallCause::Roll } else { FallCause::Steer })
}

/// State `tau` seconds into a step of `h`: angles on the cubic of [`time_of_fall`], rates interpolated
/// linearly. A step that ends in a state that is not finite gives its start.
pub(super) fn at_fall(before: &State<f64>, after: &State<f64>, tau: f64, h: f64) -> State<f64> {
    if tau == 0.0 {
        return *before;
    }
    let s = tau / h;
    let angle = |x0: f64, x1: f64, v0: f64, v1: f64| hermite(&[x0, x1, v0 * h, v1 * h], s);
    let rate = |a: f64, b: f64| a + (b - a) * s;
    State {
        roll: angle(before.roll, after.roll, before.roll_rate, after.roll_rate),
        steer: angle(before.steer, after.steer, before.steer_rate, after.steer_rate),
        roll_rate: rate(before.roll_rate, after.roll_rate),
        steer_rate: rate(before.steer_rate, after.steer_rate),
        rear_wheel_rate: rate(before.rear_wheel_rate, after.rear_wheel_rate),
        pitch: rate(before.pitch, after.pitch),
    }
}

/// Largest magnitudes of roll and steer in the part `from` to 1 of a step of `h` seconds, on the cubic of [`time_of_fall`].
pub(super) fn largest_angles((before, after): (&State<f64>, &State<f64>), h: f64, from: f64) -> [f64; 2] {
    let of = |x0: f64, x1: f64, v0: f64, v1: f64| largest(&[x0, x1, v0 * h, v1 * h], from);
    [
        of(before.roll, after.roll, before.roll_rate, after.roll_rate),
        of(before.steer, after.steer, before.steer_rate, after.steer_rate),
    ]
}

/// Largest magnitude of the Hermite cubic between `from` and 1, where it has at most one extremum.
fn largest(p: &[f64; 4], from: f64) -> f64 {
    let begin = if from > 0.0 { hermite(p, from) } else { p[0] };
    let ends = begin.abs().max(p[1].abs());
    let (m0, m1) = (p[2], p[3]);
    if m0 * m1 >= 0.0 {
        return ends;
    }
    // The slope a s^2 + b s + m0 changes its sign once between 0 and 1: the root by the formula that does not cancel.
    let rise = p[1] - p[0];
    let (a, b) = (3.0 * (m0 + m1) - 6.0 * rise, 6.0 * rise - 4.0 * m0 - 2.0 * m1);
    let q = -0.5 * (b + (b * b - 4.0 * a * m0).sqrt().copysign(b));
    let inside = [q / a, m0 / q].into_iter().find(|s| (from..=1.0).contains(s));
    inside.map_or(ends, |s| ends.max(hermite(p, s).abs()))
}

/// Hermite cubic with values `p[0]`, `p[1]` and slopes `p[2]`, `p[3]` at 0 and 1.
fn hermite(p: &[f64; 4], s: f64) -> f64 {
    let (s2, s3) = (s * s, s * s * s);
    p[0] * (2.0 * s3 - 3.0 * s2 + 1.0)
        + p[1] * (3.0 * s2 - 2.0 * s3)
        + p[2] * (s3 - 2.0 * s2 + s)
        + p[3] * (s3 - s2)
}
