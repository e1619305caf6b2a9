//! Exact sensors of one ride with a common delay.

use super::assist::{body_roll_rate, front_speed, rear_speed};
use super::{Conditions, Imu, ScheduleSpeed, Start};
use crate::bicycle::Velocities;
use crate::num::Scalar;
use control::{Plan, Sample, SensorFrame, Triple, Wheel};
use std::collections::VecDeque;

/// Sensor values without delay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Reading {
    /// Roll rate as selected by [`Imu`] \[rad/s\].
    pub(super) roll_rate_rad_s: f64,
    /// Speed as selected by [`ScheduleSpeed`] \[m/s\].
    pub(super) speed_m_s: f64,
}

/// Delayed readings; before t = 0 those of steady riding.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    pipeline: VecDeque<Reading>,
}

impl Sensors {
    pub(super) fn new(conditions: &Conditions, start: &Start) -> Self {
        let steady = Reading { roll_rate_rad_s: 0.0, speed_m_s: start.speed_m_s };
        Self { pipeline: vec![steady; usize::from(conditions.sensor_delay_ticks)].into() }
    }

    /// Stores this instant's reading and returns the one that arrives now.
    pub(super) fn delayed(&mut self, now: Reading) -> Reading {
        // Without delay the queue stays empty and the reading passes through.
        let Some(arrived) = self.pipeline.pop_front() else { return now };
        self.pipeline.push_back(now);
        arrived
    }
}

/// Input frame of the controller from a reading, `ticks` control periods after boot.
pub(super) fn frame(plan: &Plan, reading: &Reading, ticks: u32, engage: bool) -> SensorFrame {
    let speed = Sample::fresh(reading.speed_m_s as f32);
    let missing = SensorFrame::missing();
    let input = &plan.config().input;
    let (front_wheel_m_s, rear_wheel_m_s) =
        match (input.front_wheel.fitted, input.rear_wheel.fitted, input.wheel) {
            (true, false, _) | (true, true, Wheel::Front) => (speed, missing.rear_wheel_m_s),
            _ => (missing.front_wheel_m_s, speed),
        };
    SensorFrame {
        now_us: clock_us(plan, ticks),
        gyro_rad_s: Triple::fresh([reading.roll_rate_rad_s as f32, 0.0, 0.0]),
        front_wheel_m_s,
        rear_wheel_m_s,
        engage,
        ..missing
    }
}

/// The controller's clock `ticks` control periods after boot \[us\], wrapping.
pub fn clock_us(plan: &Plan, ticks: u32) -> u32 {
    let period_s = 1.0 / f64::from(plan.config().rate_hz);
    (f64::from(ticks) * period_s * 1e6).round() as i64 as u32
}

/// Exact sensor values at these velocities: roll rate \[rad/s\] and speed \[m/s\].
#[inline(always)]
pub(super) fn readings<S: Scalar>(conditions: &Conditions, v: &Velocities<S>, initial: S) -> (S, S) {
    let b = &conditions.bicycle;
    let rate = match conditions.imu {
        Imu::Euler => v.roll,
        Imu::Body => body_roll_rate(b, v),
    };
    let speed = match conditions.schedule_speed {
        ScheduleSpeed::Front => front_speed(b, v),
        ScheduleSpeed::Rear => rear_speed(b, v),
        ScheduleSpeed::Initial => initial,
    };
    (rate, speed)
}
