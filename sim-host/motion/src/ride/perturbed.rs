//! A ride under an external lateral force and steer torque at a held speed: the motion of an identification experiment,
//! without an assist.

use super::event::{fallen, time_of_fall};
use super::rider_lanes::RiderLanes;
use super::sensor::readings;
use super::substeps::{stiffness, too_stiff};
use super::{Conditions, FallCause};
use crate::bicycle::{Accelerations, ForcePoint, Forces, Geometry, Motion, State, Torques};
use crate::integrate::{Actuation, rk4};
use crate::num::Lanes;
use crate::rider::Instant;

/// How a ride is perturbed and sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbed {
    /// Where the lateral force acts.
    pub point: ForcePoint,
    /// Integration steps per sample, at least 1.
    pub steps_per_sample: u32,
    /// Time constant with which the torque of the pedals brings the speed to the demanded one \[s\]; `None`: no torque.
    pub speed_hold_s: Option<f64>,
}

/// What acts on the bicycle from one sample to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// Lateral force, across the rear wheel's heading, to the right positive \[N\].
    pub lateral_force_n: f64,
    /// Steer torque in addition to the rider's, to the right positive \[N m\].
    pub steer_torque_nm: f64,
    /// Demanded forward speed \[m/s\]; without effect if no speed is held.
    pub speed_m_s: f64,
}

/// The motion at one sample's instant, before its [`Push`] has had an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSample {
    /// Roll \[rad\].
    pub roll_rad: f64,
    /// Steer \[rad\].
    pub steer_rad: f64,
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate_rad_s: f64,
    /// Yaw rate \[rad/s\].
    pub yaw_rate_rad_s: f64,
    /// Rear wheel's forward speed \[m/s\].
    pub speed_m_s: f64,
    /// The rider's steer torque \[N m\].
    pub rider_torque_nm: f64,
}

/// A perturbed ride.
#[derive(Clone, Debug, PartialEq)]
pub struct PerturbedRide {
    /// The samples, one for each push up to the end or a fall.
    pub samples: Vec<MotionSample>,
    /// Time \[s\] and cause of the fall.
    pub fall: Option<(f64, FallCause)>,
}

/// The pushed bicycle during a sample.
struct Pushed<'a> {
    conditions: &'a Conditions,
    perturbed: &'a Perturbed,
    push: Push,
    initial: Lanes<1>,
    riders: Option<RiderLanes<'a, 1>>,
    /// Yaw rate at the start of the step \[rad/s\].
    yaw_rate_rad_s: f64,
    /// The quantities of [`stiffness`] at the start of the step.
    stiffness: [f64; 4],
}

impl Pushed<'_> {
    fn rider_torque(&self) -> Lanes<1> {
        self.riders.as_ref().map_or(Lanes([0.0]), |riders| riders.rider_state.at.torque)
    }

    /// Torque of the pedals on the rear wheel, against the rear frame: the bicycle's mass times the difference of the
    /// speeds over the time constant, at the wheel's radius.
    fn pedalling(&self, b: &Geometry, motion: &Motion<Lanes<1>>) -> Lanes<1> {
        self.perturbed.speed_hold_s.map_or(Lanes([0.0]), |time_s| {
            let missing = motion.actual.rear_spin * -b.rR + -self.push.speed_m_s;
            missing * (b.rR * (b.rear.mass + b.front.mass) / time_s)
        })
    }
}

impl Actuation<Lanes<1>> for Pushed<'_> {
    fn begin_step(&mut self, b: &Geometry, motion: &Motion<Lanes<1>>) {
        self.stiffness = stiffness(b, motion).map(|q| q.0[0]);
        self.yaw_rate_rad_s = motion.actual.yaw.0[0];
    }

    fn torques(&self, _: usize, _: &Motion<Lanes<1>>) -> Torques<Lanes<1>> {
        Torques { roll: Lanes([0.0]), steer: self.rider_torque() + self.push.steer_torque_nm }
    }

    fn accelerations(
        &self,
        b: &Geometry,
        stage: usize,
        motion: &Motion<Lanes<1>>,
    ) -> Accelerations<Lanes<1>> {
        let zero = Lanes([0.0]);
        let force = Lanes([self.push.lateral_force_n]);
        let forces = motion
            .lateral_force(b, self.perturbed.point, force)
            .and(Forces::from(self.torques(stage, motion)))
            .and(Forces([zero, zero, self.pedalling(b, motion)]));
        motion.accelerations_under(b, &forces)
    }

    fn end_stage(
        &mut self,
        b: &Geometry,
        stage: usize,
        state: &State<Lanes<1>>,
        motion: &Motion<Lanes<1>>,
        acc: &Accelerations<Lanes<1>>,
    ) {
        if let Some(riders) = &mut self.riders {
            let (_, speed) = readings(self.conditions, &motion.actual, self.initial);
            let now = Instant::new(state, motion, acc);
            riders.end_stage(b, stage, self.conditions.step_s, &now, &speed, [true]);
        }
    }
}

/// A ride from upright and straight at `speed_m_s` through the `pushes`, until their end or a fall.
///
/// Of the conditions it has the bicycle, the rider, the schedule speed, the fall criterion and the time step; there is
/// neither assist nor friction. As it has no substeps, it counts as fallen as soon as it passes the roll of
/// [`super::LaidFlat`], or moves too quickly for the time step.
pub fn perturbed(
    conditions: &Conditions,
    perturbed: &Perturbed,
    speed_m_s: f64,
    pushes: &[Push],
) -> PerturbedRide {
    let (b, h) = (&conditions.bicycle, conditions.step_s);
    let initial = Lanes([speed_m_s]);
    let rider = conditions.rider.as_ref();
    let mut pushed = Pushed {
        conditions,
        perturbed,
        push: Push::default(),
        initial,
        riders: rider.map(|rider| RiderLanes::new(rider, rider.delay_steps(h))),
        yaw_rate_rad_s: 0.0,
        stiffness: [0.0; 4],
    };
    let mut state = State::upright(b, initial);
    let mut samples = Vec::with_capacity(pushes.len());
    for (i, push) in pushes.iter().enumerate() {
        pushed.push = *push;
        for step in 0..perturbed.steps_per_sample {
            if let Some(riders) = &mut pushed.riders {
                riders.turn();
            }
            let (before, rider_torque_nm) = (state.lane(0), pushed.rider_torque().0[0]);
            state = rk4(b, &state, h, &mut pushed);
            if step == 0 {
                samples.push(MotionSample {
                    roll_rad: before.roll,
                    steer_rad: before.steer,
                    roll_rate_rad_s: before.roll_rate,
                    steer_rate_rad_s: before.steer_rate,
                    yaw_rate_rad_s: pushed.yaw_rate_rad_s,
                    speed_m_s: before.rear_wheel_rate * -b.rR,
                    rider_torque_nm,
                });
            }
            if let Some((tau, cause)) = ended(conditions, pushed.stiffness, &before, &state.lane(0)) {
                let steps = i as f64 * f64::from(perturbed.steps_per_sample) + f64::from(step);
                return PerturbedRide { samples, fall: Some((steps * h + tau, cause)) };
            }
        }
    }
    PerturbedRide { samples, fall: None }
}

/// Time in a step \[s\], and the cause, if the ride ends in it.
fn ended(
    conditions: &Conditions,
    stiffness: [f64; 4],
    before: &State<f64>,
    after: &State<f64>,
) -> Option<(f64, FallCause)> {
    let (fall, h) = (&conditions.fall, conditions.step_s);
    if fallen(fall, after) {
        return Some(time_of_fall(fall, (before, after), h));
    }
    if fall.flat.is_some_and(|flat| after.roll.abs() > flat.roll_rad) {
        return Some((h, FallCause::LaidFlat));
    }
    too_stiff(stiffness, h).then_some((0.0, FallCause::TooQuick))
}
