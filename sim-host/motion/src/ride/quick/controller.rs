//! The control crate in quick rides: its step in every control period, with sensors and motor that are exact.
//!
//! A step of the bicycle spans several control periods. In those after its start the readings are extrapolated from the
//! starts of the last three steps.

use super::limited::LateLaw;
use crate::num::{Lanes, Scalar};
use crate::plant::{Frame, Odometry, Plant, Reading};
use crate::ride::assist::IdealLaw;
use crate::ride::backend::{Backend, Stepped};
use crate::ride::hardware::{self, exact_frame};
use crate::ride::warm_start::{Ready, WarmStart};
use crate::ride::{Conditions, ScheduleSpeed, Start};
use control::estimate::Source;
use control::{Command, Mode, Plan};

/// Longest step with a controller in every control period \[s\].
pub(super) const LONGEST_S: f64 = 5e-3;
/// Largest step over more than one control period of a controller that compares its sensors with each other, relative to the
/// time scale of the motion: with readings extrapolated further, its checks trip at other times.
pub(super) const EXTRAPOLATED: f64 = 0.02;
/// Relative error of a time in control periods.
const ROUNDING: f64 = 1e-6;

/// A law near upright riding.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    pub(super) law: IdealLaw,
    /// Delay of the torque to first order \[s\].
    pub(super) delay_s: f64,
    /// Largest torque \[N m\].
    pub(super) largest_nm: f64,
    /// Largest rate of change of the torque \[N m/s\].
    pub(super) largest_nm_s: f64,
    /// Speed from which the torque is that of the law \[m/s\].
    pub(super) slowest_m_s: f64,
}

impl Linear {
    /// Without limits.
    pub(super) fn unlimited(law: IdealLaw, delay_s: f64) -> Self {
        Self {
            law,
            delay_s,
            largest_nm: f64::INFINITY,
            largest_nm_s: f64::INFINITY,
            slowest_m_s: f64::NEG_INFINITY,
        }
    }

    /// Of a law in continuous time; `None` if it is late or the motor inexact.
    pub(super) fn of_law(law: &LateLaw) -> Option<Self> {
        let mut linear = Self::unlimited(law.law.clone(), law.first_order_s);
        if let Some(limits) = &law.limits {
            (linear.largest_nm, linear.largest_nm_s) = (limits.largest_nm, limits.slower_nm_s());
        }
        let exact_motor = law.limits.is_none_or(|limits| limits.exact_motor());
        (law.late.is_none() && exact_motor).then_some(linear)
    }

    /// Of an engaged controller; `None` if more than the roll-rate law and limits acts, or its roll rate is filtered.
    pub(super) fn of(conditions: &Conditions, plan: &Plan) -> Option<Self> {
        let config = plan.config();
        let bare = !config.capsize.is_on()
            && config.track.is_none()
            && config.latency == Default::default()
            && config.limits.speed_cap.is_none()
            && !config.input.rider_torque.fitted
            && config.estimate.roll_rate == Source::GyroX
            && config.smooth.lag_s == 0.0
            && config.predict.lead_s == 0.0;
        bare.then(|| Self {
            law: IdealLaw { law: config.law.clone(), dead_band: config.dead_band },
            delay_s: 0.5 * conditions.step_s,
            largest_nm: config.limits.max_torque_nm.map_or(f64::INFINITY, f64::from),
            largest_nm_s: [config.limits.rise_nm_s, config.limits.fall_nm_s]
                .into_iter()
                .flatten()
                .fold(f64::INFINITY, |least, rate| least.min(f64::from(rate))),
            slowest_m_s: config.limits.taper.map_or(f64::NEG_INFINITY, |taper| taper.full_m_s.into()),
        })
    }
}

/// Torque over a step: the straight line with the impulse and the first moment of the torques that are held.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<S> {
    /// Torque in the middle of the step \[N m\].
    middle_nm: S,
    /// Its change over the step \[N m\].
    change_nm: S,
}

impl<S: Scalar> Line<S> {
    /// The torque at the fraction `part` of the step \[N m\].
    #[inline(always)]
    pub(super) fn at(&self, part: f64) -> S {
        self.middle_nm + self.change_nm * (part - 0.5)
    }
}

impl<const N: usize> Line<Lanes<N>> {
    /// The line of a lane.
    pub(super) fn of(&self, lane: usize) -> Line<f64> {
        Line { middle_nm: self.middle_nm.0[lane], change_nm: self.change_nm.0[lane] }
    }
}

/// The controllers in the lanes.
pub(super) struct Controllers<'a, const N: usize> {
    conditions: &'a Conditions,
    plan: &'a Plan,
    plant: Plant,
    /// Whether more than roll rate and one speed is read.
    simulated: bool,
    warm_start: WarmStart,
    lanes: [Option<LaneController>; N],
    /// The torques over the step.
    pub(super) line: Line<Lanes<N>>,
    /// Torques of the control periods in which the step begins \[N m\].
    pub(super) held_nm: Lanes<N>,
}

/// The controller in a lane.
struct LaneController {
    ready: Ready,
    /// Control periods begun since t = 0.
    periods: u32,
    command: Command,
    odometry: Odometry,
    /// Readings at the starts of the last steps that began with a control period, latest first, with their times \[s\].
    past: [(f64, Reading); 3],
    known: usize,
}

/// The motion at the start of a lane's step.
pub(super) struct StepStart {
    /// Time since the disturbance \[s\].
    pub(super) t_s: f64,
    pub(super) frame: Frame,
    /// Roll rate \[rad/s\] and speed \[m/s\] of exact sensors.
    pub(super) measured: (f64, f64),
    pub(super) rider_torque_nm: f64,
}

impl<'a, const N: usize> Controllers<'a, N> {
    pub(super) fn new(conditions: &'a Conditions, plan: &'a Plan) -> Self {
        let zero = Lanes([0.0; N]);
        Self {
            conditions,
            plan,
            plant: conditions.plant.clone(),
            simulated: hardware::needed(conditions),
            warm_start: WarmStart::default(),
            lanes: std::array::from_fn(|_| None),
            line: Line { middle_nm: zero, change_nm: zero },
            held_nm: zero,
        }
    }

    /// Begins a ride in a lane.
    pub(super) fn restart(&mut self, lane: usize, start: &Start) {
        let plant = (&self.plant, self.simulated);
        let warm = self.warm_start.at(self.conditions, plant, &mut Backend::Local, start);
        let steady = Reading::steady(start.speed_m_s, self.conditions.bicycle.g);
        self.lanes[lane] = warm.map(|warm| LaneController {
            ready: warm.ready,
            periods: 0,
            command: Stepped::OFF.command,
            odometry: Odometry::default(),
            past: [(0.0, steady); 3],
            known: 0,
        });
    }

    /// Whether the assist in a lane has full authority.
    pub(super) fn engaged(&self, lane: usize) -> bool {
        let full = |one: &LaneController| {
            one.command.mode == Mode::Engaged && one.ready.controller.authority() == 1.0
        };
        self.lanes[lane].as_ref().is_some_and(full)
    }

    /// The control instants of a lane's step of at most `h` seconds; returns its length: a whole number of control periods, or
    /// a part of one.
    pub(super) fn begin(&mut self, lane: usize, h: f64, start: &StepStart) -> f64 {
        let Some(one) = &mut self.lanes[lane] else { return h };
        let period_s = self.conditions.step_s;
        let next_s = f64::from(one.periods) * period_s;
        if start.t_s < next_s - ROUNDING * period_s {
            (self.line.middle_nm.0[lane], self.line.change_nm.0[lane]) = (self.held_nm.0[lane], 0.0);
            return h.min(next_s - start.t_s);
        }
        let now = one.read(self.conditions, self.simulated, start);
        let whole = (h / period_s + ROUNDING) as u32;
        let periods = if one.known < 3 { 1 } else { whole.max(1) };
        let first = if one.known < 3 { now } else { one.extrapolated(0.0, period_s) };
        let mut held_nm = one.step(self.plan, &first);
        self.held_nm.0[lane] = held_nm;
        let (mut sum, mut moment) = (0.0, 0.0);
        for period in 0..periods {
            if period > 0 {
                let ahead = one.extrapolated(f64::from(period) * period_s, period_s);
                held_nm = one.step(self.plan, &ahead);
            }
            sum += held_nm;
            moment += held_nm * (f64::from(period) + 0.5 - 0.5 * f64::from(periods));
        }
        let per_step = 1.0 / f64::from(periods);
        self.line.middle_nm.0[lane] = sum * per_step;
        self.line.change_nm.0[lane] = 12.0 * moment * per_step * per_step;
        if whole == 0 { h } else { f64::from(periods) * period_s }
    }
}

impl LaneController {
    /// One control period: the torque \[N m\].
    fn step(&mut self, plan: &Plan, reading: &Reading) -> f64 {
        let reported = Reading { motor_torque_nm: self.command.torque_nm.into(), ..*reading };
        let frame = exact_frame(plan, &reported, self.ready.ticks, true);
        self.command = control::step(plan, &mut self.ready.controller, &frame);
        self.ready.ticks = self.ready.ticks.wrapping_add(1);
        self.periods += 1;
        self.command.torque_nm.into()
    }

    /// The readings at the start of a step, which are stored.
    fn read(&mut self, conditions: &Conditions, simulated: bool, start: &StepStart) -> Reading {
        let (roll_rate, speed) = start.measured;
        let mut now = if simulated {
            let point_m = conditions.plant.sensors.imu.point_m;
            let period_s = if self.known > 0 { start.t_s - self.past[0].0 } else { conditions.step_s };
            self.odometry.read(&conditions.bicycle, conditions.imu, point_m, period_s, &start.frame)
        } else {
            Reading { gyro_rad_s: [roll_rate, 0.0, 0.0], ..Reading::steady(speed, conditions.bicycle.g) }
        };
        if conditions.schedule_speed == ScheduleSpeed::Initial {
            (now.front_wheel_m_s, now.rear_wheel_m_s) = (speed, speed);
        }
        now.rider_torque_nm = start.rider_torque_nm;
        self.past = [(start.t_s, now), self.past[0], self.past[1]];
        self.known = (self.known + 1).min(3);
        now
    }

    /// The readings `ahead_s` after the latest stored ones: the parabolas through the last three. The specific force is the mean
    /// over the control period before: from the means over the last two steps.
    fn extrapolated(&self, ahead_s: f64, period_s: f64) -> Reading {
        let [(t0, y0), (t1, y1), (t2, y2)] = &self.past;
        let (first_s, second_s) = (t0 - t1, t1 - t2);
        let curved = ahead_s * (ahead_s + first_s) / (first_s + second_s);
        // The weights of the three readings.
        let (by_first, by_second) = ((ahead_s + curved) / first_s, curved / second_s);
        let mut ahead = y0.combined([1.0 + by_first, -by_first - by_second, by_second], y1, y2);
        let steps = (2.0 * ahead_s - period_s + first_s) / (first_s + second_s);
        ahead.accel_m_s2 =
            std::array::from_fn(|i| y0.accel_m_s2[i] + steps * (y0.accel_m_s2[i] - y1.accel_m_s2[i]));
        ahead
    }
}
