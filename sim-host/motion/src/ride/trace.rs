//! Record of a ride, one point per control period.

use super::assist::{front_speed, rear_speed};
use super::backend::Backend;
use super::hardware::{self, RideHardware};
use super::recorder::{ControllerOutput, SteerTorques};
use super::sensor::Reading;
use super::warm_start::{engage_run, steady};
use super::{Assist, Conditions, Start};
use crate::bicycle::{Geometry, Motion};
use crate::num::Lanes;
use control::SensorFrame;

/// One instant of a traced ride, at the start of a control period.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct TracePoint {
    /// Time \[s\].
    pub t: f64,
    /// Roll \[rad\].
    pub roll: f64,
    /// Steer \[rad\].
    pub steer: f64,
    /// Pitch \[rad\].
    pub pitch: f64,
    /// Roll rate \[rad/s\].
    pub roll_rate: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate: f64,
    /// Yaw rate \[rad/s\].
    pub yaw_rate: f64,
    /// Rear wheel rate \[rad/s\].
    pub rear_wheel_rate: f64,
    /// Rear wheel's forward speed \[m/s\].
    pub rear_speed: f64,
    /// Front wheel's forward speed \[m/s\].
    pub front_speed: f64,
    /// Roll rate as measured by the controller's sensors \[rad/s\].
    pub measured_roll_rate: f64,
    /// Speed as measured by the controller's sensors \[m/s\].
    pub measured_speed: f64,
    /// Steer torque commanded by the assist \[N m\].
    pub torque: f64,
    /// Limits that changed the torque, as bits of [`control::ActiveLimits`].
    pub limits: u16,
    /// The rider's steer torque \[N m\].
    pub rider_torque: f64,
    /// Steer torque of the motor at the middle of the control period \[N m\].
    pub motor_torque: f64,
    /// Mode of the controller, as the number of [`control::Mode`].
    pub mode: u8,
    /// Causes that prevent or reduce torque, as bits of [`control::Causes`].
    pub causes: u64,
    /// Lower half of `causes`; a double does not hold all its bits exactly.
    pub causes_low: u32,
    /// Upper half of `causes`.
    pub causes_high: u32,
    /// The controller's input frame.
    #[serde(skip)]
    pub frame: SensorFrame,
}

impl TracePoint {
    /// The point of lane 0 at `t`.
    pub(super) fn new<const N: usize>(
        b: &Geometry,
        t: f64,
        motion: &Motion<Lanes<N>>,
        measured: &Reading,
        output: &ControllerOutput,
        steer_torques: SteerTorques,
    ) -> Self {
        let (pose, actual) = (&motion.pose, &motion.actual);
        let angle = |(s, c): (Lanes<N>, Lanes<N>)| libm::atan2(s.0[0], c.0[0]);
        Self {
            t,
            roll: angle(pose.attitude.roll),
            steer: angle(pose.attitude.steer),
            pitch: pose.attitude.pitch.0[0],
            roll_rate: actual.roll.0[0],
            steer_rate: actual.steer.0[0],
            yaw_rate: actual.yaw.0[0],
            rear_wheel_rate: actual.rear_spin.0[0],
            rear_speed: rear_speed(b, actual).0[0],
            front_speed: front_speed(b, actual).0[0],
            measured_roll_rate: measured.roll_rate_rad_s,
            measured_speed: measured.speed_m_s,
            torque: output.torque_nm,
            limits: output.limits,
            rider_torque: steer_torques.rider_nm,
            motor_torque: steer_torques.assist_nm,
            mode: output.mode as u8,
            causes: output.causes.0,
            causes_low: output.causes.0 as u32,
            causes_high: (output.causes.0 >> 32) as u32,
            frame: output.frame,
        }
    }
}

/// Sensor frames of a ride as the controller received them from its boot, for replay on the chip; none
/// without the control crate.
pub fn frames(conditions: &Conditions, start: Start, trace: &[TracePoint]) -> Vec<SensorFrame> {
    let Assist::Firmware(plan) = &conditions.assist else { return Vec::new() };
    let mut frames = Vec::with_capacity(trace.len());
    if hardware::needed(conditions) {
        let plant = conditions.plant.delayed(conditions.sensor_delay_ticks);
        RideHardware::new(conditions, plan, &plant, &start, &mut Backend::Local, |frame| frames.push(*frame));
    } else {
        engage_run(plan, &mut Backend::Local, steady(plan, start.speed_m_s), |frame, _| frames.push(*frame));
    }
    frames.extend(trace.iter().map(|p| p.frame));
    frames
}
