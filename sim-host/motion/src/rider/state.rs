//! State of a rider model, and its feedback signals from the bicycle's motion.

use super::{Neuromuscular, Signals};
use crate::bicycle::{Accelerations, FullState, Geometry, Motion, Pose, State, Velocities};
use crate::num::{Lanes, Moves, Scalar};

/// State of a rider model without the delay line. All zero at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiderState<S> {
    /// Integral of roll from t = 0 \[rad s\].
    pub roll_integral: S,
    /// Integral of steer \[rad s\].
    pub steer_integral: S,
    /// Heading of the rear frame: integral of the yaw rate \[rad\].
    pub heading: S,
    /// Lateral path of the rear contact, right positive \[m\].
    pub rear_lateral: S,
    /// Neuromuscular torque on the handlebar, right positive \[N m\].
    pub torque: S,
    /// Time derivative of the torque \[N m/s\].
    pub torque_rate: S,
}

/// The bicycle's motion at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a, S> {
    /// Roll and steer angles \[rad\].
    pub angles: [S; 2],
    /// Accelerations of roll and steer \[rad/s^2\].
    pub accelerations: [S; 2],
    /// The pose.
    pub pose: &'a Pose<S>,
    /// The velocities.
    pub velocities: &'a Velocities<S>,
}

impl<'a, S: Scalar> Instant<'a, S> {
    /// From a state, its motion and its accelerations.
    #[inline(always)]
    pub fn new(state: &State<S>, motion: &'a Motion<S>, acc: &Accelerations<S>) -> Self {
        Self {
            angles: [state.roll, state.steer],
            accelerations: [acc.roll, acc.steer],
            pose: &motion.pose,
            velocities: &motion.actual,
        }
    }
}

impl<'a> Instant<'a, f64> {
    /// From a state with six speeds, its pose and velocities, and its time derivative.
    pub(crate) fn full(
        state: &FullState,
        (pose, velocities): (&'a Pose<f64>, &'a Velocities<f64>),
        rate: &FullState,
    ) -> Self {
        let [roll, _, steer] = state.angles;
        let [roll_acc, _, _, steer_acc, _, _] = rate.speeds;
        Self { angles: [roll, steer], accelerations: [roll_acc, steer_acc], pose, velocities }
    }
}

impl<S: Scalar> RiderState<S> {
    /// State at the start of a ride.
    #[inline(always)]
    pub fn fresh() -> Self {
        let zero = S::constant(0.0);
        Self {
            roll_integral: zero,
            steer_integral: zero,
            heading: zero,
            rear_lateral: zero,
            torque: zero,
            torque_rate: zero,
        }
    }

    /// Feedback signals of the rider.
    #[inline(always)]
    pub fn signals(&self, now: &Instant<S>) -> Signals<S> {
        let ([roll, steer], [roll_acc, steer_acc], v) = (now.angles, now.accelerations, now.velocities);
        // Position of the front contact relative to the rear: ahead and to the right of the rear wheel's
        // heading.
        let (e1, k, base) = (now.pose.e1, now.pose.k, now.pose.base);
        let (ahead, right) = (base.dot(e1), base.dot(k.cross(e1)));
        let (sin, cos) = self.heading.sin_cos();
        let lateral = self.rear_lateral + sin * ahead + cos * right;
        Signals([
            roll,
            self.roll_integral,
            v.roll,
            roll_acc,
            steer,
            self.steer_integral,
            v.steer,
            steer_acc,
            self.heading,
            lateral,
        ])
    }

    /// Time derivative of every entry, in the same fields, for the arriving neural signal `alpha` \[N m\].
    #[inline(always)]
    pub fn rate(
        &self,
        b: &Geometry,
        now: &Instant<S>,
        neuromuscular: &Neuromuscular,
        alpha: S,
    ) -> RiderState<S> {
        let v = now.velocities;
        let (sin, _) = self.heading.sin_cos();
        RiderState {
            roll_integral: now.angles[0],
            steer_integral: now.angles[1],
            heading: v.yaw,
            rear_lateral: (v.pitch + v.rear_spin) * -b.rR * sin,
            torque: self.torque_rate,
            torque_rate: neuromuscular.acceleration(alpha, self.torque, self.torque_rate),
        }
    }
}

impl<S: Scalar> RiderState<S> {
    /// The state after `h` seconds, in each lane its own time, at the given rates.
    #[inline(always)]
    pub(crate) fn after(&self, h: S, rate: &Self) -> Self {
        Self {
            roll_integral: self.roll_integral + rate.roll_integral * h,
            steer_integral: self.steer_integral + rate.steer_integral * h,
            heading: self.heading + rate.heading * h,
            rear_lateral: self.rear_lateral + rate.rear_lateral * h,
            torque: self.torque + rate.torque * h,
            torque_rate: self.torque_rate + rate.torque_rate * h,
        }
    }
}

impl<S: Scalar> Moves for RiderState<S> {
    #[inline(always)]
    fn moved(&self, h: f64, rate: &Self) -> Self {
        self.after(S::constant(h), rate)
    }
}

impl<const N: usize> RiderState<Lanes<N>> {
    /// The state of one lane.
    pub(crate) fn lane(&self, lane: usize) -> RiderState<f64> {
        RiderState {
            roll_integral: self.roll_integral.0[lane],
            steer_integral: self.steer_integral.0[lane],
            heading: self.heading.0[lane],
            rear_lateral: self.rear_lateral.0[lane],
            torque: self.torque.0[lane],
            torque_rate: self.torque_rate.0[lane],
        }
    }

    /// Sets the state of one lane.
    pub(crate) fn set_lane(&mut self, lane: usize, to: &RiderState<f64>) {
        self.roll_integral.0[lane] = to.roll_integral;
        self.steer_integral.0[lane] = to.steer_integral;
        self.heading.0[lane] = to.heading;
        self.rear_lateral.0[lane] = to.rear_lateral;
        self.torque.0[lane] = to.torque;
        self.torque_rate.0[lane] = to.torque_rate;
    }
}
