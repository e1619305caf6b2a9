//! Substeps of a control period where the motion is fast, and the six-speed formulation ([`FullState`]) near
//! singular configurations of the three independent speeds.
//!
//! Rides that end in a fall reach them: the front wheel turns across the path or beside the rear wheel. Close
//! to 90 degrees of roll the yaw rate grows like one over the cosine of roll, as a coin's does, and can
//! reverse the roll.

use super::event::fallen;
use super::rider_lanes::RiderLane;
use super::sensor::readings;
use super::steer_torque;
use super::{Assist, Conditions};
use crate::bicycle::{Accelerations, FullState, Geometry, Motion, State, Torques, Velocities};
use crate::integrate::{Actuation, STAGES, Stages, rk4};
use crate::num::Scalar;
use crate::plant::Actuator;
use crate::rider::Instant;

/// Largest substep relative to the time scale of the motion.
const LARGEST: f64 = 0.05;
/// Smallest distance from a singular configuration at which the independent speeds are used, as a fraction of
/// the upright bicycle's distance.
const NEAREST: f64 = 0.15;
/// Largest number of substeps in a control period.
const MOST: f64 = 4096.0;

/// Part of a control period, from the state `start` to the state `end`.
pub(super) struct Segment {
    pub(super) start: State<f64>,
    pub(super) end: State<f64>,
    /// Time of its start in the period \[s\].
    pub(super) offset: f64,
    /// Its duration \[s\].
    pub(super) h: f64,
    /// Substeps taken in the period up to its end.
    pub(super) substeps: u32,
}

/// Quantities that determine the substep: sum of squared rates \[rad^2/s^2\], cosine of roll, and distances
/// from the two singular configurations.
#[inline(always)]
pub(super) fn stiffness<S: Scalar>(b: &Geometry, motion: &Motion<S>) -> [S; 4] {
    let v = &motion.actual;
    let squares = v.roll * v.roll + v.steer * v.steer + v.pitch * v.pitch + v.yaw * v.yaw;
    let (_, cos_roll) = motion.pose.attitude.roll;
    [squares, cos_roll, motion.unfolded(b), motion.along_front(b)]
}

/// Whether a step of `h` seconds with the independent speeds is too inaccurate.
pub(super) fn too_stiff(stiffness: [f64; 4], h: f64) -> bool {
    singular(stiffness) || substeps(stiffness, h) > 1.0
}

/// Whether the independent speeds do not determine the others accurately. NaN counts as singular.
fn singular(stiffness: [f64; 4]) -> bool {
    nearer(stiffness, NEAREST)
}

/// Whether a configuration is nearer to a singular one than `nearest`, a fraction of the upright bicycle's distance.
pub(super) fn nearer([_, _, unfolded, along]: [f64; 4], nearest: f64) -> bool {
    !(unfolded.abs() >= nearest && along.abs() >= nearest)
}

/// Number of substeps for `h` seconds.
fn substeps([squares, cos_roll, ..]: [f64; 4], h: f64) -> f64 {
    let steps = (h * squares.sqrt() / (LARGEST * cos_roll.abs())).ceil();
    if steps.is_nan() { MOST } else { steps.clamp(1.0, MOST) }
}

/// A control period of one ride.
pub(super) struct Period<'a> {
    pub(super) conditions: &'a Conditions,
    /// Largest number of substeps, at least 1.
    pub(super) most_substeps: u32,
    /// Six-speed state from one control period to the next, while needed.
    pub(super) full: &'a mut Option<FullState>,
    /// Assist torque at the start \[N m\].
    pub(super) assist_nm: f64,
    /// The motor, if it is not exact.
    pub(super) motor: Option<&'a Actuator>,
    /// The ride's speed at t = 0 \[m/s\].
    pub(super) initial_m_s: f64,
    /// The rider.
    pub(super) rider: Option<RiderLane<'a>>,
    /// Roll torque over the period \[N m\].
    pub(super) roll_nm: f64,
}

impl Period<'_> {
    /// The torques `elapsed_s` into the period.
    fn torques(&self, elapsed_s: f64, steer_rad: f64, v: &Velocities<f64>) -> Torques<f64> {
        let actuator = &self.conditions.plant.actuator;
        let assist = match (&self.conditions.assist, self.motor) {
            (Assist::None | Assist::Firmware(_), None) => self.assist_nm,
            (Assist::None | Assist::Firmware(_), Some(motor)) => motor.torque(actuator, elapsed_s, v.steer),
            (Assist::Ideal(law), _) => {
                let (rate, speed) = readings(self.conditions, v, self.initial_m_s);
                law.torque_nm(rate, speed)
            }
            (Assist::Own(law), _) => {
                let (rate, speed) = readings(self.conditions, v, self.initial_m_s);
                law.torque_nm(rate, speed)
            }
        };
        let rider_nm = self.rider.as_ref().map(|rider| rider.rider_state.at.torque);
        let torques = steer_torque::torques(actuator, assist, rider_nm, || steer_rad, v.steer);
        Torques { roll: self.roll_nm, ..torques }
    }

    /// Passes a stage of the substep of `h` seconds that begins at `offset` to the rider.
    fn end_stage(&mut self, stage: usize, (offset, h): (f64, f64), now: &Instant<f64>) {
        if let Some(rider) = &mut self.rider {
            let (_, speed) = readings(self.conditions, now.velocities, self.initial_m_s);
            let s = (offset + STAGES[stage] * h) / self.conditions.step_s;
            rider.end_stage(&self.conditions.bicycle, (stage, h, s), now, speed);
        }
    }
}

/// Integrates a control period from `from` in substeps. Returns the last segment: the one that ends the
/// period, the one with the fall, or the last one allowed.
pub(super) fn refined(period: &mut Period, from: &State<f64>) -> Segment {
    let (b, step_s) = (&period.conditions.bicycle, period.conditions.step_s);
    let (mut start, mut offset, mut taken) = (*from, 0.0, 0);
    loop {
        let motion = Motion::new(b, &start);
        let stiffness = stiffness(b, &motion);
        let left = step_s - offset;
        let substeps = substeps(stiffness, left);
        let h = left / substeps;
        let end = if singular(stiffness) {
            let at = period.full.unwrap_or_else(|| FullState::new(&motion, &start));
            *period.full = step(b, &at, (offset, h), period);
            period.full.map_or(State { rear_wheel_rate: f64::NAN, ..start }, |next| next.state())
        } else {
            *period.full = None;
            rk4(b, &start, h, &mut Substep { period, offset, h })
        };
        if let Some(rider) = &mut period.rider {
            rider.rider_state = Stages::new(rider.rider_state.end);
        }
        taken += 1;
        if substeps <= 1.0 || taken >= period.most_substeps || fallen(&period.conditions.fall, &end) {
            return Segment { start, end, offset, h, substeps: taken };
        }
        (start, offset) = (end, offset + h);
    }
}

/// A substep with the independent speeds.
struct Substep<'a, 'b> {
    period: &'a mut Period<'b>,
    offset: f64,
    h: f64,
}

impl Actuation<f64> for Substep<'_, '_> {
    fn torques(&self, stage: usize, motion: &Motion<f64>) -> Torques<f64> {
        let (sin, cos) = motion.pose.attitude.steer;
        self.period.torques(self.offset + STAGES[stage] * self.h, libm::atan2(sin, cos), &motion.actual)
    }

    fn end_stage(
        &mut self,
        _: &Geometry,
        stage: usize,
        state: &State<f64>,
        motion: &Motion<f64>,
        acc: &Accelerations<f64>,
    ) {
        self.period.end_stage(stage, (self.offset, self.h), &Instant::new(state, motion, acc));
    }
}

/// One Runge-Kutta step with six speeds, `h` seconds from `offset`.
fn step(b: &Geometry, from: &FullState, (offset, h): (f64, f64), period: &mut Period) -> Option<FullState> {
    let mut stages = Stages::new(*from);
    for (stage, part) in STAGES.into_iter().enumerate() {
        let at = stages.at;
        let (pose, velocities) = (at.pose(b), at.velocities(b));
        let k = at.rate(b, &period.torques(offset + part * h, at.angles[2], &velocities))?;
        let now = Instant::full(&at, (&pose, &velocities), &k);
        period.end_stage(stage, (offset, h), &now);
        stages.next(stage, h, &k);
    }
    Some(stages.end)
}
