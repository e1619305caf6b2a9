//! Shorter steps where the motion is too quick for the control period; and all six speeds
//! ([`FullState`]) near places where the three independent ones do not fix the others.
//!
//! Rides that end in a fall go there: the front wheel comes to stand across the path or beside the
//! rear wheel, and close to 90 degrees of roll the yaw rate grows like one over the cosine of roll,
//! as a coin's does, and may throw the roll back.

use super::event::fallen;
use super::sensor::readings;
use super::{Assist, Conditions};
use crate::bicycle::{FullState, Geometry, Motion, State, Torques, Velocities};
use crate::integrate::{Actuation, rk4};
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
pub(super) fn too_quick(quickness: [f64; 4], h: f64) -> bool {
    singular(quickness) || pieces(quickness, h) > 1.0
}

/// Whether the independent speeds do not safely fix the others. NaN counts as singular.
fn singular([_, _, unfolded, along]: [f64; 4]) -> bool {
    !(unfolded.abs() >= NEAREST && along.abs() >= NEAREST)
}

/// How many steps `h` seconds take.
fn pieces([squares, cos_roll, ..]: [f64; 4], h: f64) -> f64 {
    let steps = (h * squares.sqrt() / (LARGEST * cos_roll.abs())).ceil();
    if steps.is_nan() { MOST } else { steps.clamp(1.0, MOST) }
}

/// The last segment of a control period from `from`: the one that ends it, or the one in which the
/// bicycle falls. `full` holds all speeds from one such period to the next, while they are needed.
pub(super) fn refined(
    conditions: &Conditions,
    from: &State<f64>,
    full: &mut Option<FullState>,
    torque: f64,
    initial: f64,
) -> Segment {
    let b = &conditions.bicycle;
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
        let motion = Motion::new(b, &was);
        let quickness = quickness(b, &motion);
        let left = conditions.step_s - offset;
        let pieces = pieces(quickness, left);
        let h = left / pieces;
        let is = if singular(quickness) {
            let at = full.unwrap_or_else(|| FullState::new(&motion, &was));
            *full = step(b, &at, h, &act);
            full.map_or(State { rear_wheel_rate: f64::NAN, ..was }, |next| next.state())
        } else {
            *full = None;
            rk4(b, &was, h, &mut Continuous(&act))
        };
        if pieces <= 1.0 || fallen(&is) {
            return Segment { was, is, offset, h };
        }
        (was, offset) = (is, offset + h);
    }
}

/// Torques that follow from the velocities met inside a step.
struct Continuous<'a, F>(&'a F);

impl<F: Fn(&Velocities<f64>) -> Torques<f64>> Actuation<f64> for Continuous<'_, F> {
    fn torques(&mut self, _: &Geometry, _: usize, motion: &Motion<f64>) -> Torques<f64> {
        (self.0)(&motion.actual)
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
