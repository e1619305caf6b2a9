//! The instant of a fall inside a step.

use crate::bicycle::State;
use std::f64::consts::FRAC_PI_2;

/// Roll or steer beyond this is a fall \[rad\].
pub(super) const FALL_RAD: f64 = FRAC_PI_2;

/// Whether a state counts as fallen; one that is not finite does (the model has no motion there).
pub(super) fn fallen(state: &State<f64>) -> bool {
    !(state.roll.abs() < FALL_RAD && state.steer.abs() < FALL_RAD && state.rear_wheel_rate.is_finite())
}

/// When in a step of `h` seconds, 0 to `h`, the first of roll and steer passes 90 degrees.
///
/// On the cubic through both ends' values and rates, whose error at a step of 1 ms is below a
/// nanosecond; to 1e-9 s by bisection. A step that ends in no finite state counts as a fall at its
/// start.
pub(super) fn time_of_fall(before: &State<f64>, after: &State<f64>, h: f64) -> f64 {
    let roll = [before.roll, after.roll, before.roll_rate * h, after.roll_rate * h];
    let steer = [before.steer, after.steer, before.steer_rate * h, after.steer_rate * h];
    if roll.iter().chain(&steer).chain([&after.rear_wheel_rate]).any(|x| !x.is_finite()) {
        return 0.0;
    }
    let beyond = |s: f64| hermite(&roll, s).abs().max(hermite(&steer, s).abs()) >= FALL_RAD;
    let (mut low, mut high) = (0.0, 1.0);
    while (high - low) * h > 1e-9 {
        let middle = 0.5 * (low + high);
        if beyond(middle) { high = middle } else { low = middle }
    }
    high * h
}

/// The state `tau` seconds into a step of `h`: angles on the cubic of [`time_of_fall`], rates on a
/// straight line; a step that ends in no finite state gives its start.
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

/// The cubic with values `p[0]`, `p[1]` and slopes `p[2]`, `p[3]` at 0 and 1.
fn hermite(p: &[f64; 4], s: f64) -> f64 {
    let (s2, s3) = (s * s, s * s * s);
    p[0] * (2.0 * s3 - 3.0 * s2 + 1.0)
        + p[1] * (3.0 * s2 - 2.0 * s3)
        + p[2] * (s3 - 2.0 * s2 + s)
        + p[3] * (s3 - s2)
}
