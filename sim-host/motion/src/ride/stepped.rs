//! A bicycle that a caller advances, one time step after the other: the plant of another simulator.
//!
//! Torques and force are held over a step, as [`super::traced`] holds the torque of the control crate, so that a caller with
//! the same schedule gets the same bits.

use super::event::{at_fall, fallen, time_of_fall};
use super::substeps::{Period, Segment, refined, stiffness, too_stiff};
use super::{Conditions, FallCause, Start, steer_torque};
use crate::bicycle::{
    Accelerations, ForcePoint, Forces, FullState, Geometry, Motion, State, Torques, Velocities,
};
use crate::integrate::{Actuation, STAGES, rk4};
use crate::num::sin_cos;
use crate::plant::{ActuatorConfig, Frame, Odometry, Reading};
use serde::{Deserialize, Serialize};

/// What acts on the bicycle during a step. Right positive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Applied {
    /// Torque of the motor on the steer axis \[N m\].
    pub assist_nm: f64,
    /// The rider's torque on the handlebar at the start of the step \[N m\].
    pub rider_nm: f64,
    /// Its rate, constant over the step \[N m/s\].
    pub rider_rate_nm_s: f64,
    /// Torque on the rear frame about the heading line through the rear contact \[N m\].
    pub roll_nm: f64,
    /// Lateral force, across the rear wheel's heading \[N\].
    pub lateral_force_n: f64,
}

/// The motion at the end of a step, and the exact sensors' values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BicycleSample {
    /// Roll, steer and pitch \[rad\].
    pub angles_rad: [f64; 3],
    /// Rates of roll and steer \[rad/s\].
    pub rates_rad_s: [f64; 2],
    /// Yaw rate \[rad/s\].
    pub yaw_rate_rad_s: f64,
    /// Rear wheel's rate \[rad/s\], negative forward.
    pub rear_wheel_rate_rad_s: f64,
    /// Lateral deviation of the front contact from the line of the start \[m\].
    pub front_lateral_m: f64,
    /// The exact sensors' values; `rider_torque_nm` and `motor_torque_nm` are those of the step that ended.
    pub reading: Reading,
}

/// The bicycle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteppedBicycle {
    state: State<f64>,
    /// Six-speed state, while the motion is near a singular configuration of the independent speeds.
    full: Option<FullState>,
    odometry: Odometry,
    steps: u64,
    /// Steps since roll first passed the angle of [`super::LaidFlat`], from 1; 0 before.
    flat_steps: u32,
    substeps_left: u32,
    fall: Option<(f64, FallCause)>,
    now: BicycleSample,
}

impl SteppedBicycle {
    /// The bicycle at t = 0. Of the conditions it has, here and in [`SteppedBicycle::step`], the bicycle, friction and
    /// end-stop, the place and signal of the IMU, the fall criterion and the time step.
    pub fn new(conditions: &Conditions, start: &Start) -> Self {
        let state = start.state(&conditions.bicycle);
        let mut odometry = Odometry::default();
        let now = observed(conditions, (&state, None), &mut odometry, &Applied::default());
        Self {
            state,
            full: None,
            odometry,
            steps: 0,
            flat_steps: 0,
            substeps_left: conditions.most_substeps(),
            fall: None,
            now,
        }
    }

    /// The motion after the last step.
    pub fn now(&self) -> &BicycleSample {
        &self.now
    }

    /// Time \[s\] and cause of the fall. From then on the bicycle stays as it was.
    pub fn fall(&self) -> Option<(f64, FallCause)> {
        self.fall
    }

    /// Accelerations of roll and steer at this instant under what is `applied` \[rad/s^2\]; zero after a fall.
    pub fn accelerations_rad_s2(
        &self,
        conditions: &Conditions,
        point: ForcePoint,
        applied: &Applied,
    ) -> [f64; 2] {
        let (b, actuator) = (&conditions.bicycle, &conditions.plant.actuator);
        let motion = Motion::new(b, &self.state);
        let torques = applied.torques(actuator, 0.0, &motion);
        let found = match self.full.and_then(|full| full.rate(b, &torques)) {
            _ if self.fall.is_some() => return [0.0; 2],
            Some(rate) => [rate.speeds[0], rate.speeds[3]],
            None => {
                let Accelerations { roll, steer, .. } = accelerations(b, applied, point, &torques, &motion);
                [roll, steer]
            }
        };
        found.map(|x| if x.is_finite() { x } else { 0.0 })
    }

    /// One time step under what is `applied`, the lateral force at `point`. A lateral force while the motion is too quick for
    /// the time step counts as a fall, as in [`super::perturbed()`].
    pub fn step(&mut self, conditions: &Conditions, point: ForcePoint, applied: &Applied) {
        if self.fall.is_some() {
            return;
        }
        let (b, h) = (&conditions.bicycle, conditions.step_s);
        let before = self.state;
        let mut held = Held { actuator: &conditions.plant.actuator, applied, h, point, stiffness: [0.0; 4] };
        let after = rk4(b, &before, h, &mut held);
        let last = if !too_stiff(held.stiffness, h) {
            self.full = None;
            Segment { start: before, end: after, offset: 0.0, h, substeps: 0 }
        } else if applied.lateral_force_n == 0.0 {
            let mut period = Period {
                conditions,
                most_substeps: self.substeps_left,
                full: &mut self.full,
                assist_nm: applied.mean_steer_nm(h),
                roll_nm: applied.roll_nm,
                motor: None,
                initial_m_s: 0.0,
                rider: None,
            };
            refined(&mut period, &before)
        } else {
            self.fall = Some((self.steps as f64 * h, FallCause::TooQuick));
            return;
        };
        self.end_step(conditions, &last);
        let full = self.full.filter(|_| self.fall.is_none());
        self.now = observed(conditions, (&self.state, full.as_ref()), &mut self.odometry, applied);
    }

    /// Takes the end of a step, or the instant of the fall in it.
    fn end_step(&mut self, conditions: &Conditions, last: &Segment) {
        let (h, begun_s) = (conditions.step_s, self.steps as f64 * conditions.step_s);
        self.steps += 1;
        self.state = last.end;
        if fallen(&conditions.fall, &last.end) {
            let (tau, by) = time_of_fall(&conditions.fall, (&last.start, &last.end), last.h);
            self.state = at_fall(&last.start, &last.end, tau, last.h);
            self.fall = Some((begun_s + last.offset + tau, by));
            return;
        }
        self.substeps_left = self.substeps_left.saturating_sub(last.substeps);
        let mut by = (self.substeps_left == 0).then_some(FallCause::TooQuick);
        if let Some(flat) = conditions.fall.flat {
            let beyond = last.end.roll.abs() > flat.roll_rad;
            self.flat_steps += u32::from(beyond || self.flat_steps > 0);
            let over = f64::from(self.flat_steps) * h > flat.lasting_s;
            by = by.or(over.then_some(FallCause::LaidFlat));
        }
        self.fall = by.map(|by| (begun_s + last.offset + last.h, by));
    }
}

impl Applied {
    /// Mean torque of motor and rider over a step of `h` seconds \[N m\].
    fn mean_steer_nm(&self, h: f64) -> f64 {
        self.rider_nm_at(0.5 * h).map_or(self.assist_nm, |rider_nm| self.assist_nm + rider_nm)
    }

    /// The rider's torque `elapsed_s` into the step, if there is one: adding zero would turn -0 into 0.
    fn rider_nm_at(&self, elapsed_s: f64) -> Option<f64> {
        let rider_nm = self.rider_nm + self.rider_rate_nm_s * elapsed_s;
        (rider_nm != 0.0).then_some(rider_nm)
    }

    /// The torques on the bicycle `elapsed_s` into a step, friction and end-stop included.
    fn torques(&self, actuator: &ActuatorConfig, elapsed_s: f64, motion: &Motion<f64>) -> Torques<f64> {
        let (sin, cos) = motion.pose.attitude.steer;
        let (rider_nm, steer_rad) = (self.rider_nm_at(elapsed_s), || libm::atan2(sin, cos));
        let torques =
            steer_torque::torques(actuator, self.assist_nm, rider_nm, steer_rad, motion.actual.steer);
        Torques { roll: self.roll_nm, ..torques }
    }
}

/// Torques and force during a step of `h` seconds.
struct Held<'a> {
    actuator: &'a ActuatorConfig,
    h: f64,
    applied: &'a Applied,
    point: ForcePoint,
    /// The quantities of [`stiffness`] at the start of the step.
    stiffness: [f64; 4],
}

impl Actuation<f64> for Held<'_> {
    fn begin_step(&mut self, b: &Geometry, motion: &Motion<f64>) {
        self.stiffness = stiffness(b, motion);
    }

    fn torques(&self, stage: usize, motion: &Motion<f64>) -> Torques<f64> {
        self.applied.torques(self.actuator, STAGES[stage] * self.h, motion)
    }

    fn accelerations(&self, b: &Geometry, stage: usize, motion: &Motion<f64>) -> Accelerations<f64> {
        accelerations(b, self.applied, self.point, &self.torques(stage, motion), motion)
    }
}

/// Accelerations under these torques and the lateral force.
fn accelerations(
    b: &Geometry,
    applied: &Applied,
    point: ForcePoint,
    torques: &Torques<f64>,
    motion: &Motion<f64>,
) -> Accelerations<f64> {
    if applied.lateral_force_n == 0.0 {
        return motion.accelerations(b, torques);
    }
    let force = motion.lateral_force(b, point, applied.lateral_force_n);
    motion.accelerations_under(b, &force.and(Forces::from(*torques)))
}

/// The motion of a state, after a step under what was `applied`.
fn observed(
    conditions: &Conditions,
    (state, full): (&State<f64>, Option<&FullState>),
    odometry: &mut Odometry,
    applied: &Applied,
) -> BicycleSample {
    let b = &conditions.bicycle;
    let motion = Motion::new(b, state);
    let angle = |(sin, cos)| libm::atan2(sin, cos);
    let attitude = &motion.pose.attitude;
    let angles_rad = [angle(attitude.roll), angle(attitude.steer), attitude.pitch];
    let frame = match full {
        Some(full) => Frame::new(&full.pose(b), &full.velocities(b), full.angles[2]),
        None => Frame::new(&motion.pose, &motion.actual, angles_rad[1]),
    };
    let point_m = conditions.plant.sensors.imu.point_m;
    let exact = odometry.read(b, conditions.imu, point_m, conditions.step_s, &frame);
    // As in `RiderState::signals`.
    let (ahead, right) =
        (motion.pose.base.dot(motion.pose.e1), motion.pose.base.dot(motion.pose.k.cross(motion.pose.e1)));
    let (sin, cos) = sin_cos(exact.heading_rad);
    let Velocities { roll, steer, yaw, rear_spin, .. } = motion.actual;
    BicycleSample {
        angles_rad,
        rates_rad_s: [roll, steer],
        yaw_rate_rad_s: yaw,
        rear_wheel_rate_rad_s: rear_spin,
        front_lateral_m: exact.lateral_m + sin * ahead + cos * right,
        reading: Reading { rider_torque_nm: applied.rider_nm, motor_torque_nm: applied.assist_nm, ..exact },
    }
}
