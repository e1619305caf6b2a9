//! Plant of one ride: exact readings, sensors and motor. Not used if sensors and motor are exact and the
//! controller needs only roll rate and one speed.

use super::backend::Backend;
use super::sensor::{Reading as Signals, clock_us};
use super::warm_start::{Ready, engage_run};
use super::{Assist, Conditions, ScheduleSpeed, Start};
use crate::bicycle::{Motion, Velocities};
use crate::num::{Lanes, Vec3};
use crate::plant::{Actuator, Frame, Held, Measured, Odometry, Plant, Reading, Sensor, SensorSuite};
use control::{Plan, Sample, SensorFrame, Triple, ValidationConfig, Wheel};

/// Sensors and motor of one ride.
#[derive(Debug)]
pub(super) struct RideHardware {
    /// `None` if they are exact.
    sensors: Option<SensorSuite>,
    odometry: Odometry,
    pub(super) motor: Actuator,
}

/// Whether rides under these conditions need it.
pub(super) fn needed(conditions: &Conditions) -> bool {
    let Assist::Firmware(plan) = &conditions.assist else { return false };
    let ValidationConfig {
        accel, steer, steer_rate, front_wheel, rear_wheel, rider_torque, motor, path, ..
    } = &plan.config().input;
    let beyond = [accel, steer, steer_rate, rider_torque, motor, path].iter().any(|sensor| sensor.fitted);
    beyond || (front_wheel.fitted && rear_wheel.fitted) || !conditions.plant.exact()
}

impl RideHardware {
    /// State at t = 0 and the controller after its warm start with these sensors. `frames` receives the
    /// controller's inputs.
    pub(super) fn new(
        conditions: &Conditions,
        plan: &Plan,
        plant: &Plant,
        start: &Start,
        backend: &mut Backend,
        mut frames: impl FnMut(&SensorFrame),
    ) -> (Self, Ready) {
        let steady = Reading::steady(start.speed_m_s, conditions.bicycle.g);
        let mut sensors =
            (!plant.reads_exactly()).then(|| SensorSuite::new(plant, conditions.step_s, start, &steady));
        let mut motor = Actuator::new(&plant.actuator);
        let measured = |ticks, pressed, torque_nm| {
            let reached = sensors.as_mut().map_or(torque_nm, |sensors| sensors.command(plant, torque_nm));
            motor.command(&plant.actuator, conditions.step_s, reached);
            let motor_torque_nm = motor.torque(&plant.actuator, conditions.step_s, 0.0);
            let now = Reading { motor_torque_nm, ..steady };
            match &mut sensors {
                Some(sensors) => frame(plan, &sensors.measure(plant, &now, pressed)),
                None => exact_frame(plan, &now, ticks, pressed),
            }
        };
        let ready = engage_run(plan, backend, measured, |frame, _| frames(frame));
        sensors.iter_mut().for_each(SensorSuite::begin);
        (Self { sensors, odometry: Odometry::default(), motor }, ready)
    }

    /// A copy for another ride; `None` if anything is random or there are faults.
    pub(super) fn copied(&self) -> Option<Self> {
        let sensors = match &self.sensors {
            Some(sensors) => Some(sensors.copied()?),
            None => None,
        };
        Some(Self { sensors, odometry: self.odometry, motor: self.motor.clone() })
    }

    /// Input frame of the controller at a control instant, `ticks` control periods after boot, and roll rate and speed as
    /// measured.
    pub(super) fn measured(
        &mut self,
        conditions: &Conditions,
        (plan, plant): (&Plan, &Plant),
        at: &Frame,
        (rider_torque_nm, initial_m_s): (f64, f64),
        ticks: u32,
    ) -> (SensorFrame, Signals) {
        let (b, h) = (&conditions.bicycle, conditions.step_s);
        let exact = self.odometry.read(b, conditions.imu, plant.sensors.imu.point_m, h, at);
        let mut now = Reading {
            rider_torque_nm,
            motor_torque_nm: self.motor.torque(&plant.actuator, h, at.velocities.steer),
            ..exact
        };
        if conditions.schedule_speed == ScheduleSpeed::Initial {
            (now.front_wheel_m_s, now.rear_wheel_m_s) = (initial_m_s, initial_m_s);
        }
        match &mut self.sensors {
            Some(sensors) => {
                let measured = sensors.measure(plant, &now, true);
                let of = |sensor| measured.of(sensor).value[0];
                (frame(plan, &measured), signals(plan, of))
            }
            None => (exact_frame(plan, &now, ticks, true), signals(plan, |sensor| now.of(sensor)[0])),
        }
    }

    /// Passes the controller's command of this control instant to the motor \[N m\].
    pub(super) fn commanded(&mut self, conditions: &Conditions, plant: &Plant, torque_nm: f64) {
        let reached = self.sensors.as_mut().map_or(torque_nm, |sensors| sensors.command(plant, torque_nm));
        self.motor.command(&plant.actuator, conditions.step_s, reached);
    }
}

/// Input frame of the controller, with the fitted sensors.
pub fn frame(plan: &Plan, measured: &Measured) -> SensorFrame {
    let of = |sensor| {
        let Held { value, age_ticks } = *measured.of(sensor);
        (value, age_ticks)
    };
    fitted(plan, (measured.now_us, measured.engage), of)
}

/// Input frame of the controller from exact sensors, with the fitted ones, `ticks` control periods after boot.
pub(super) fn exact_frame(plan: &Plan, reading: &Reading, ticks: u32, engage: bool) -> SensorFrame {
    fitted(plan, (clock_us(plan, ticks), engage), |sensor| (reading.of(sensor), 0))
}

/// Input frame of the controller at its clock \[us\]; `of` gives value and age of a fitted sensor \[control periods\].
#[inline(always)]
fn fitted(plan: &Plan, (now_us, engage): (u32, bool), of: impl Fn(Sensor) -> ([f64; 3], u16)) -> SensorFrame {
    let input = &plan.config().input;
    let one = |sensor: Sensor, axis: usize| {
        if !sensor.declared(input).fitted {
            return Sample::missing();
        }
        let (value, age_ticks) = of(sensor);
        Sample { value: value[axis] as f32, age_ticks }
    };
    let three = |sensor: Sensor| {
        if !sensor.declared(input).fitted {
            return Triple::missing();
        }
        let (value, age_ticks) = of(sensor);
        Triple { value: value.map(|x| x as f32), age_ticks }
    };
    SensorFrame {
        now_us,
        gyro_rad_s: three(Sensor::Gyro),
        accel_m_s2: three(Sensor::Accel),
        steer_rad: one(Sensor::Steer, 0),
        steer_rate_rad_s: one(Sensor::SteerRate, 0),
        front_wheel_m_s: one(Sensor::FrontWheel, 0),
        rear_wheel_m_s: one(Sensor::RearWheel, 0),
        rider_torque_nm: one(Sensor::RiderTorque, 0),
        motor_torque_nm: one(Sensor::MotorReport, 0),
        heading_error_rad: one(Sensor::Path, 0),
        lateral_error_m: one(Sensor::Path, 1),
        engage,
    }
}

/// Roll rate and speed, `of` the sensors.
fn signals(plan: &Plan, of: impl Fn(Sensor) -> f64) -> Signals {
    let wheel = match plan.config().input.wheel {
        Wheel::Front => Sensor::FrontWheel,
        Wheel::Rear => Sensor::RearWheel,
    };
    Signals { roll_rate_rad_s: of(Sensor::Gyro), speed_m_s: of(wheel) }
}

/// Motion of the rear frame in a lane with this steer angle \[rad\].
pub(super) fn lane_frame<const N: usize>(motion: &Motion<Lanes<N>>, lane: usize, steer_rad: f64) -> Frame {
    let vector = |v: Vec3<Lanes<N>>| Vec3::new(v.x.0[lane], v.y.0[lane], v.z.0[lane]);
    let (v, pose) = (&motion.actual, &motion.pose);
    Frame {
        e1: vector(pose.e1),
        k: vector(pose.k),
        velocities: Velocities {
            roll: v.roll.0[lane],
            pitch: v.pitch.0[lane],
            yaw: v.yaw.0[lane],
            steer: v.steer.0[lane],
            rear_spin: v.rear_spin.0[lane],
            front_spin: v.front_spin.0[lane],
            omega: vector(v.omega),
            rolling: v.rolling.0[lane],
        },
        steer_rad,
    }
}
