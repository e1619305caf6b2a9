//! Where the motion is too quick for the control period, or near a place where the independent
//! speeds do not fix the others: shorter steps with all speeds kept ([`FullState`]).
//!
//! Rides that end in a fall go there: the front wheel comes to stand across the path or beside the
//! rear wheel, and close to 90 degrees of roll the yaw rate grows like one over the cosine of roll,
//! as a coin's does, and may throw the roll back.

use super::event::fallen;
use super::sensor::readings;
use super::{Assist, Conditions};
use crate::bicycle::{FullState, Geometry, Motion, State, Torques, Velocities};
use crate::num::Scalar;

/// Largest step in units of the motion's own time.
const LARGEST: f64 = 0.05;
/// Nearest to a singular place that the independent speeds are used, as a part of the upright
/// bicycle's distance from it.
const NEAREST: f64 = 0.15;
/// Most steps in a control period.
const MOST: f64 = 4096.0;

/// Part of a control period: from `was` to `is`.
pub(super) struct Segment {
    pub(super) was: State<f64>,
    pub(super) is: State<f64>,
    /// Its start, from the period's \[s\].
    pub(super) offset: f64,
    /// Its length \[s\].
    pub(super) h: f64,
}

/// What tells how quick the motion is: the sum of squares of its rates \[rad^2/s^2\], the cosine of
/// roll, and the distances from the two singular places.
#[inline(always)]
pub(super) fn quickness<S: Scalar>(b: &Geometry, motion: &Motion<S>) -> [S; 4] {
    let v = &motion.actual;
    let squares = v.roll * v.roll + v.steer * v.steer + v.pitch * v.pitch + v.yaw * v.yaw;
    let (_, cos_roll) = motion.pose.attitude.roll;
    [squares, cos_roll, motion.unfolded(b), motion.along_front(b)]
}

/// Whether a step of `h` seconds with the independent speeds will not do.
pub(super) fn too_quick([squares, cos_roll, unfolded, along]: [f64; 4], h: f64) -> bool {
    // Written so that a NaN is too quick.
    !(unfolded.abs() >= NEAREST
        && along.abs() >= NEAREST
        && squares * h * h <= LARGEST * LARGEST * cos_roll * cos_roll)
}

/// The last segment of a control period from `from`: the one that ends it, or the one in which the
/// bicycle falls. `full` holds all speeds from one such period to the next.
pub(super) fn refined(
    conditions: &Conditions,
    from: &State<f64>,
    full: &mut Option<FullState>,
    torque: f64,
    initial: f64,
) -> Segment {
    let b = &conditions.bicycle;
    let period = conditions.step_s;
    let mut at = full.unwrap_or_else(|| FullState::new(&Motion::new(b, from), from));
    let act = |v: &Velocities<f64>| {
        let steer = match &conditions.assist {
            Assist::None | Assist::Firmware(_) => torque,
            Assist::Ideal(law) => {
                let (rate, speed) = readings(conditions, v, initial);
                law.gain(speed) * rate
            }
        };
        Torques { roll: 0.0, steer }
    };
    let (mut was, mut offset) = (*from, 0.0);
    loop {
        let left = period - offset;
        let [p, q, r, s, ..] = at.speeds;
        let rate = (p * p + q * q + r * r + s * s).sqrt() / at.angles[0].cos().abs();
        let pieces = (left * rate / LARGEST).ceil().clamp(1.0, MOST);
        let h = if pieces.is_nan() { left } else { left / pieces };
        let next = step(b, &at, h, &act);
        let is = next.map_or(State { rear_wheel_rate: f64::NAN, ..was }, |next| next.state());
        let last = pieces <= 1.0 || pieces.is_nan();
        let Some(next) = next.filter(|_| !last && !fallen(&is)) else {
            *full = next;
            return Segment { was, is, offset, h };
        };
        (at, was, offset) = (next, is, offset + h);
    }
}

/// One Runge-Kutta step with all speeds.
fn step(
    b: &Geometry,
    from: &FullState,
    h: f64,
    act: &impl Fn(&Velocities<f64>) -> Torques<f64>,
) -> Option<FullState> {
    let k1 = from.rate(b, act)?;
    let k2 = from.moved(0.5 * h, &k1).rate(b, act)?;
    let k3 = from.moved(0.5 * h, &k2).rate(b, act)?;
    let k4 = from.moved(h, &k3).rate(b, act)?;
    let to = from.moved(h / 6.0, &k1).moved(h / 3.0, &k2).moved(h / 3.0, &k3).moved(h / 6.0, &k4);
    Some(to)
}
