//! The control crate in quick rides: its step in every control period, with sensors and motor that are exact.
//!
//! A step of the bicycle spans several control periods. In those after its start the readings are extrapolated from the
//! starts of the last three steps. In calm motion less is executed ([`super::calm`]), and nothing once a controller remains off.

use super::calm::{CalmLanes, CalmPlan, LONGER, SETTLED_S};
use super::limited::LateLaw;
use crate::num::{Lanes, Scalar};
use crate::plant::{Frame, Odometry, Plant, Reading};
use crate::ride::assist::IdealLaw;
use crate::ride::backend::{Backend, Stepped};
use crate::ride::hardware::{self, exact_frame};
use crate::ride::warm_start::{Ready, WarmStart};
use crate::ride::{Conditions, ScheduleSpeed, Start};
use control::estimate::Source;
use control::{Cause, Command, Mode, Plan};
use std::sync::Mutex;

/// Longest step with a controller in every control period \[s\].
const LONGEST_S: f64 = 5e-3;
/// Longest step in calm motion \[s\].
const CALM_S: f64 = 12e-3;
/// Largest step over more than one control period of a controller that compares its sensors with each other, relative to the
/// time scale of the motion: with readings extrapolated further, its checks trip at other times.
const EXTRAPOLATED: f64 = 0.02;
/// Fine steps over several control periods, relative to the usual ones.
const FINE: f64 = 0.5;
/// Relative error of a time in control periods.
const ROUNDING: f64 = 1e-6;

/// Longest steps \[s\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// With a controller in every control period, or without a controller.
    pub(super) longest_s: f64,
    /// The same relative to the time scale of the motion, if it is longer than a control period.
    extrapolated: f64,
    /// With the controller of calm motion.
    calm_s: f64,
    /// With a controller that remains off.
    off_s: f64,
}

impl Pace {
    /// At most `longest_s`.
    pub(super) fn unlimited(longest_s: f64) -> Self {
        Self { longest_s, extrapolated: f64::INFINITY, calm_s: longest_s, off_s: longest_s }
    }

    /// With a controller; `monitored`: whether it compares its sensors with each other. `most_s` is the longest step for other reasons.
    pub(super) fn of_controller(monitored: bool, most_s: f64) -> Self {
        Self {
            longest_s: LONGEST_S.min(most_s),
            extrapolated: if monitored { EXTRAPOLATED } else { f64::INFINITY },
            calm_s: CALM_S.min(most_s),
            off_s: super::LONGEST_S.min(most_s),
        }
    }

    /// Of fine steps with a controller.
    pub(super) fn fine(self) -> Self {
        let Self { longest_s, extrapolated, calm_s, off_s } = self;
        Self { longest_s: FINE * longest_s, extrapolated: FINE * extrapolated, calm_s: FINE * calm_s, off_s }
    }
}

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
        let mut linear = Self::unlimited(law.law.clone(), law.half_held_s);
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
    /// The torque in the middle of the step, and its change over the step \[N m\].
    pub(super) fn straight(middle_nm: Lanes<N>, change_nm: Lanes<N>) -> Self {
        Self { middle_nm, change_nm }
    }

    /// Sets the line of a lane from the torques of its control periods: their sum, and the sum of their products with the time in
    /// control periods since the middle of the step.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, sum: f64, moment: f64, periods: f64) {
        let per_step = 1.0 / periods;
        self.middle_nm.0[lane] = sum * per_step;
        self.change_nm.0[lane] = 12.0 * moment * per_step * per_step;
    }

    /// The line of a lane.
    pub(super) fn of(&self, lane: usize) -> Line<f64> {
        Line { middle_nm: self.middle_nm.0[lane], change_nm: self.change_nm.0[lane] }
    }
}

/// The controllers in the lanes.
pub(super) struct Controllers<'a, const N: usize> {
    conditions: &'a Conditions,
    plan: &'a Plan,
    /// `None` if the controller has functions that a calm one does not have.
    calm: Option<CalmLanes<'a, N>>,
    plant: Plant,
    /// Whether more than roll rate and one speed is read.
    simulated: bool,
    /// The warm starts that are known, and where they are kept for later rides.
    warm_start: WarmStart,
    warm_starts: &'a Mutex<WarmStart>,
    lanes: [Option<LaneController>; N],
    /// The controllers of lanes whose motion has just settled, as they were before.
    executed: [Option<LaneController>; N],
    /// The torques over the step.
    pub(super) line: Line<Lanes<N>>,
    /// Torques of the control periods in which the step begins \[N m\].
    pub(super) held_nm: Lanes<N>,
}

/// The controller in a lane.
#[derive(Clone)]
pub(super) struct LaneController {
    ready: Ready,
    /// Control periods begun since t = 0.
    periods: u32,
    command: Command,
    odometry: Odometry,
    /// Readings at the starts of the last steps that began with a control period, latest first, with their times \[s\].
    past: [(f64, Reading); 3],
    known: usize,
    /// Time since which the motion has been calm, and for which it must be \[s\].
    calm_since_s: Option<f64>,
    settled_s: f64,
    /// Whether the controller is that of calm motion.
    settled: bool,
    /// Whether the motion was no longer calm after it had settled.
    stirred: bool,
    /// Whether there is no torque to the end of the ride: the switch has been closed since the assist went off.
    off: bool,
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
    pub(super) fn new(
        conditions: &'a Conditions,
        plan: &'a Plan,
        calm: Option<&'a CalmPlan<'a>>,
        warm_starts: &'a Mutex<WarmStart>,
    ) -> Self {
        let zero = Lanes([0.0; N]);
        Self {
            conditions,
            plan,
            calm: calm.map(CalmLanes::new),
            plant: conditions.plant.clone(),
            simulated: hardware::needed(conditions),
            warm_start: warm_starts
                .lock()
                .map_or_else(|_| WarmStart::default(), |mut kept| std::mem::take(&mut kept)),
            warm_starts,
            lanes: std::array::from_fn(|_| None),
            executed: std::array::from_fn(|_| None),
            line: Line::straight(zero, zero),
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
            calm_since_s: None,
            settled_s: SETTLED_S,
            settled: false,
            stirred: false,
            off: false,
        });
    }

    /// Whether the assist in a lane has full authority.
    pub(super) fn engaged(&self, lane: usize) -> bool {
        let full = |one: &LaneController| {
            one.command.mode == Mode::Engaged && one.ready.controller.authority() == 1.0
        };
        self.lanes[lane].as_ref().is_some_and(full)
    }

    /// Longest step of a lane \[s\] at these angular rates \[rad/s\].
    pub(super) fn longest_step_s(&self, lane: usize, pace: &Pace, rate_rad_s: f64) -> f64 {
        match &self.lanes[lane] {
            Some(one) if one.off => pace.off_s,
            Some(one) if one.settled => pace.calm_s,
            _ => pace.longest_s.min((pace.extrapolated / rate_rad_s).max(self.conditions.step_s)),
        }
    }

    /// The controller of a lane whose motion has just settled, as it was before.
    pub(super) fn executed(&mut self, lane: usize) -> Option<LaneController> {
        self.executed[lane].take()
    }

    /// Continues a ride from before its motion settled; it must be calm for longer to settle again.
    pub(super) fn resume(&mut self, lane: usize, executed: LaneController) {
        let settled_s = LONGER * executed.settled_s;
        self.lanes[lane] = Some(LaneController { settled_s, ..executed });
    }

    /// Whether the motion in a lane was no longer calm after it had settled: the checks have then missed a part of it.
    pub(super) fn stirred(&self, lane: usize) -> bool {
        self.lanes[lane].as_ref().is_some_and(|one| one.stirred)
    }

    /// The control periods of the calm lanes' steps that have begun.
    #[inline(always)]
    pub(super) fn run_calm(&mut self) {
        if let Some(calm) = &mut self.calm {
            calm.run(&mut self.line, &mut self.held_nm);
        }
    }

    /// The control instants of a lane's step of at most `h` seconds; returns its length: a whole number of control periods, or
    /// a part of one.
    pub(super) fn begin(&mut self, lane: usize, h: f64, start: &StepStart) -> f64 {
        let one = match &mut self.lanes[lane] {
            Some(one) if !one.off => one,
            _ => {
                (self.line.middle_nm.0[lane], self.line.change_nm.0[lane]) = (0.0, 0.0);
                self.held_nm.0[lane] = 0.0;
                return h;
            }
        };
        let period_s = self.conditions.step_s;
        let next_s = f64::from(one.periods) * period_s;
        if start.t_s < next_s - ROUNDING * period_s {
            (self.line.middle_nm.0[lane], self.line.change_nm.0[lane]) = (self.held_nm.0[lane], 0.0);
            return h.min(next_s - start.t_s);
        }
        let now = one.read(self.conditions, self.simulated, start);
        let whole = (h / period_s + ROUNDING) as u32;
        let periods = if one.known < 3 { 1 } else { whole.max(1) };
        if let Some(calm) = &mut self.calm {
            if one.settles(calm.plan, &now, start.t_s) {
                self.executed[lane] = Some(one.clone());
                one.settled = true;
                calm.enter(lane, &one.ready.controller);
            }
            if one.settled {
                one.stirred |= !calm.begin(lane, &one.past, periods);
                one.periods += periods;
                return f64::from(periods) * period_s;
            }
        }
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
        self.line.set(lane, sum, moment, periods.into());
        if whole == 0 { h } else { f64::from(periods) * period_s }
    }
}

impl<const N: usize> Drop for Controllers<'_, N> {
    fn drop(&mut self) {
        if let Ok(mut kept) = self.warm_starts.lock() {
            *kept = std::mem::take(&mut self.warm_start);
        }
    }
}

impl LaneController {
    /// Whether the motion settles, by these readings; notes since when it is calm, and whether it is no longer.
    fn settles(&mut self, plan: &CalmPlan, now: &Reading, t_s: f64) -> bool {
        if !plan.covers(now) {
            self.stirred |= self.settled;
            self.calm_since_s = None;
            return false;
        }
        let calm_s = t_s - *self.calm_since_s.get_or_insert(t_s);
        !self.settled
            && self.known == 3
            && calm_s >= self.settled_s
            && plan.free(&self.ready.controller, &self.command)
    }

    /// One control period: the torque \[N m\].
    fn step(&mut self, plan: &Plan, reading: &Reading) -> f64 {
        let reported = Reading { motor_torque_nm: self.command.torque_nm.into(), ..*reading };
        let frame = exact_frame(plan, &reported, self.ready.ticks, true);
        self.command = control::step(plan, &mut self.ready.controller, &frame);
        self.ready.ticks = self.ready.ticks.wrapping_add(1);
        self.periods += 1;
        self.off = !self.command.mode.drives()
            && self.command.causes.has(Cause::SwitchHeld)
            && self.ready.controller.authority() == 0.0
            && self.command.torque_nm == 0.0;
        self.command.torque_nm.into()
    }

    /// The readings at the start of a step, which are stored.
    fn read(&mut self, conditions: &Conditions, simulated: bool, start: &StepStart) -> Reading {
        // Of a ride that is continued from here.
        if self.known > 0 && self.past[0].0 == start.t_s {
            return self.past[0].1;
        }
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
        let mut ahead = if ahead_s > 0.0 { y0.combined(weights(&self.past, ahead_s), y1, y2) } else { *y0 };
        let steps = (2.0 * ahead_s - period_s + first_s) / (first_s + second_s);
        ahead.accel_m_s2 =
            std::array::from_fn(|i| y0.accel_m_s2[i] + steps * (y0.accel_m_s2[i] - y1.accel_m_s2[i]));
        ahead
    }
}

/// The weights of the last three readings in the parabola through them, `ahead_s` after the latest.
fn weights([(t0, _), (t1, _), (t2, _)]: &[(f64, Reading); 3], ahead_s: f64) -> [f64; 3] {
    let (first_s, second_s) = (t0 - t1, t1 - t2);
    let curved = ahead_s * (ahead_s + first_s) / (first_s + second_s);
    let (by_first, by_second) = ((ahead_s + curved) / first_s, curved / second_s);
    [1.0 + by_first, -by_first - by_second, by_second]
}
