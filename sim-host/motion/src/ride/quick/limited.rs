//! A law in continuous time whose torque arrives late, is limited, and is delivered by a motor with a lag.
//!
//! A delay of whole control periods acts on the law's torque, which is stored at the starts of the steps; the limits act on what
//! arrives, and the motor's lag on the command. A motor's delay lies behind the limits, but constant limits give the same torque in
//! either order.

use super::lag::{Lag, Parabola, between};
use super::limits::TorqueLimits;
use crate::integrate::STAGES;
use crate::num::Lanes;
use crate::ride::Conditions;
use crate::ride::assist::IdealLaw;
use crate::rider::SignalHistory;
use control::Limits;

/// Parts of a step at whose ends the limits are compared, and halvings of the part in which another begins to act.
const PARTS: u32 = 4;
const HALVINGS: u32 = 6;
/// The parts of a step at which a [`Parabola`] is given.
const SAMPLES: [f64; 3] = [0.0, 0.5, 1.0];
/// Shortest step up to such a time, in control periods.
const SHORTEST_PERIODS: f64 = 0.2;

/// A law in continuous time, and what is between the law and the steer axis.
#[derive(Clone, Debug)]
pub(super) struct LateLaw {
    pub(super) law: IdealLaw,
    /// Half a control period of a law that is sampled and held \[s\].
    half_period_s: f64,
    /// Half a control period of a law that is sampled and held, if its torques are not stored \[s\].
    pub(super) half_held_s: f64,
    /// Delay of the law's torques, if they are stored: those that are late by whole control periods, or that a motor with a lag
    /// receives.
    pub(super) late: Option<Late>,
    /// Limits, if there are any.
    pub(super) limits: Option<TorqueLimits>,
    /// The motor's lag, if it has one.
    pub(super) lag: Option<Lag>,
}

/// A delay of whole control periods, none at least, of a law that is sampled and held.
#[derive(Clone, Copy, Debug)]
pub(super) struct Late {
    /// Time at which the torque of the first control period begins \[s\].
    pub(super) arrives_s: f64,
    /// Delay of the law in continuous time \[s\]: half a period more.
    pub(super) delay_s: f64,
}

impl LateLaw {
    /// A law with exact sensors and motor.
    pub(super) fn ideal(law: IdealLaw) -> Self {
        Self { law, half_period_s: 0.0, half_held_s: 0.0, late: None, limits: None, lag: None }
    }

    /// A law that the control crate executes, under these limits.
    pub(super) fn sampled(conditions: &Conditions, law: IdealLaw, limits: &Limits) -> Self {
        let actuator = &conditions.plant.actuator;
        let half_s = 0.5 * conditions.step_s;
        let ticks = u32::from(conditions.sensor_delay_ticks) + u32::from(actuator.delay_ticks);
        let arrives_s = f64::from(ticks) * conditions.step_s;
        let time_constant_s = actuator.time_constant_s;
        let lag = (time_constant_s > 0.0).then_some(Lag { time_constant_s });
        let late = (ticks > 0 || lag.is_some()).then_some(Late { arrives_s, delay_s: arrives_s + half_s });
        let limits = TorqueLimits::new(limits, actuator);
        Self {
            law,
            half_period_s: half_s,
            half_held_s: if late.is_some() { 0.0 } else { half_s },
            late,
            limits: (limits != TorqueLimits::NONE).then_some(limits),
            lag,
        }
    }

    /// Whether more than the law acts, after it.
    pub(super) fn limited(&self) -> bool {
        self.late.is_some() || self.limits.is_some()
    }

    /// Time at which the torque on the steer axis jumps or, with a lag, has a kink \[s\]; infinite if that is not after t = 0.
    pub(super) fn jump_s(&self) -> f64 {
        // The exact ride interpolates between the samples before and after a jump.
        let half_s = if self.lag.is_some() { 0.0 } else { self.half_period_s };
        let late = self.late.filter(|late| late.arrives_s > 0.0);
        late.map_or(f64::INFINITY, |late| late.arrives_s - half_s)
    }
}

impl Late {
    fn history(&self) -> SignalHistory {
        SignalHistory::arriving_from(self.arrives_s, self.delay_s)
    }
}

/// A step of a lane.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    /// Its start and length \[s\].
    t: f64,
    h: f64,
    /// Command at the start of the step \[N m\], and the time for which it is held \[s\].
    began: (f64, f64),
    /// The lag's response at the start \[N m\].
    lagged_nm: f64,
}

impl Step {
    /// The command after a fraction `part` of the step at which `wanted_nm` arrives \[N m\].
    #[inline(always)]
    fn command(&self, limits: &TorqueLimits, part: f64, wanted_nm: f64) -> f64 {
        let (began_nm, held_s) = self.began;
        limits.command(began_nm, wanted_nm, (part * self.h - held_s).max(0.0))
    }
}

/// The state of a lane.
#[derive(Clone, Debug)]
struct LimitedLane {
    /// The law's torques, if they are late, and their delay \[s\].
    history: Option<SignalHistory>,
    delay_s: f64,
    /// The same at the starts of the last three steps, latest first, and their times \[s\].
    past: [(f64, f64); 3],
    known: usize,
    /// The last step, and this one.
    last: Step,
    now: Step,
    /// What is expected to arrive over this step.
    wanted: Parabola,
    /// Whether no limit acted at the last stage.
    free: bool,
}

/// The torques in the lanes.
pub(super) struct Limited<'a, const N: usize> {
    limits: TorqueLimits,
    law: &'a LateLaw,
    lanes: [LimitedLane; N],
}

impl<'a, const N: usize> Limited<'a, N> {
    /// At rest; `None` for a law without delay, limits and lag.
    pub(super) fn new(law: &'a LateLaw) -> Option<Self> {
        let limits = law.limits.unwrap_or(TorqueLimits::NONE);
        let lane = || LimitedLane {
            history: law.late.as_ref().map(Late::history),
            delay_s: law.late.map_or(0.0, |late| late.delay_s),
            past: [(0.0, 0.0); 3],
            known: 0,
            last: Step::default(),
            now: Step::default(),
            wanted: [0.0; 3],
            free: false,
        };
        let acts = law.late.is_some() || law.limits.is_some();
        acts.then(|| Self { limits, law, lanes: std::array::from_fn(|_| lane()) })
    }

    /// Resets a lane for a new ride.
    pub(super) fn restart(&mut self, lane: usize) {
        let lane = &mut self.lanes[lane];
        lane.history.iter_mut().for_each(SignalHistory::clear);
        (lane.known, lane.now) = Default::default();
    }

    /// Longest step of a lane from `t` \[s\].
    pub(super) fn longest_step_s(&self, lane: usize, t: f64) -> f64 {
        let LateLaw { half_period_s, late, lag, .. } = self.law;
        let respond_s = match (late, lag) {
            (Some(late), Some(lag)) => {
                lag.longest_step_s(t - late.arrives_s).max(SHORTEST_PERIODS * 2.0 * half_period_s)
            }
            _ => f64::INFINITY,
        };
        match &self.lanes[lane].history {
            Some(history) => history.kink_s(t).min(respond_s),
            // The step's own start is the third.
            None if self.lanes[lane].known < 2 => 2.0 * half_period_s,
            None => f64::INFINITY,
        }
    }

    /// Begins a lane's step of at most `h` seconds from `t`, at whose start the law's torque is `wanted_nm`. Returns its length:
    /// it ends where another limit begins to act, a kink of the torque.
    pub(super) fn begin(&mut self, lane: usize, (t, h): (f64, f64), wanted_nm: f64) -> f64 {
        let lane = &mut self.lanes[lane];
        if let Some(history) = &mut lane.history {
            history.push(t, wanted_nm);
        }
        lane.past = [(t, wanted_nm), lane.past[0], lane.past[1]];
        lane.known = (lane.known + 1).min(3);
        lane.last = lane.now;
        lane.begin((self.law, &self.limits), t, h);
        let shorter = h.min(lane.kink_s(&self.limits).max(SHORTEST_PERIODS * 2.0 * self.law.half_period_s));
        if shorter < h {
            lane.begin((self.law, &self.limits), t, shorter);
        }
        shorter
    }

    /// Whether no limit acts in a lane.
    pub(super) fn free(&self, lane: usize) -> bool {
        self.lanes[lane].free
    }

    /// The motor's torques at a stage of the steps, where the law's torques are `wanted_nm`.
    #[inline(always)]
    pub(super) fn torques(&mut self, stage: usize, wanted_nm: Lanes<N>) -> Lanes<N> {
        Lanes(std::array::from_fn(|i| self.lanes[i].torque((self.law, &self.limits), stage, wanted_nm.0[i])))
    }

    /// The torques that control instants at the starts of the steps give, if those of a law without delay are `sampled_nm`. At half
    /// a period before the first torque, where it begins on average, there is none yet.
    pub(super) fn held(&self, t: &[Option<f64>; N], sampled_nm: Lanes<N>) -> Lanes<N> {
        Lanes(std::array::from_fn(|i| {
            let lane = &self.lanes[i];
            if self.law.lag.is_some() {
                return self.limits.delivered(lane.now.lagged_nm);
            }
            let wanted_nm = match (&lane.history, t[i]) {
                (Some(history), Some(t)) => {
                    let t = t + self.law.half_period_s - 2.0 * SignalHistory::SAME_S;
                    history.arriving_after(t, 0.0)
                }
                _ => sampled_nm.0[i],
            };
            self.limits.delivered(self.limits.command(lane.now.began.0, wanted_nm, self.law.half_period_s))
        }))
    }

    /// The torque in a lane, in a step with six speeds.
    pub(super) fn one(&mut self, lane: usize) -> LimitedRide<'_> {
        LimitedRide { law: self.law, limits: self.limits, lane: &mut self.lanes[lane] }
    }
}

impl LimitedLane {
    /// Begins a step of `h` seconds from `t`, of which the law's torque at its start is stored.
    fn begin(&mut self, (law, limits): (&LateLaw, &TorqueLimits), t: f64, h: f64) {
        self.wanted = SAMPLES.map(|part| match &self.history {
            Some(history) if part * h <= self.delay_s => history.arriving_after(t, part * h),
            _ => self.extrapolated(part * h - self.delay_s),
        });
        let last = &self.last;
        let first_s = law.late.map_or(0.0, |late| late.arrives_s);
        let began = if (t - first_s).abs() < SignalHistory::SAME_S {
            // The first control period's command is held; it is the mean of the period.
            (limits.command(0.0, self.wanted[0], 2.0 * law.half_period_s), law.half_period_s)
        } else {
            (last.command(limits, 1.0, self.wanted[0]), 0.0)
        };
        let lagged_nm = match (&law.lag, &self.history) {
            (Some(lag), Some(history)) => {
                let arrived = history.arriving(last.t, last.h);
                let command = |i: usize| last.command(limits, SAMPLES[i], arrived[i]);
                lag.after(last.lagged_nm, &std::array::from_fn(command), last.h)
            }
            _ => 0.0,
        };
        self.now = Step { t, h, began, lagged_nm };
    }

    /// The time from the step's start at which another limit begins to act \[s\]; infinite if that is not within the step.
    fn kink_s(&self, limits: &TorqueLimits) -> f64 {
        let Step { h, began: (began_nm, _), .. } = self.now;
        let by = |part: f64| limits.by(began_nm, between(&self.wanted, part), part * h);
        let first = by(0.5 / f64::from(PARTS));
        let Some(other) =
            (1..=PARTS).map(|i| f64::from(i) / f64::from(PARTS)).find(|&part| by(part) != first)
        else {
            return f64::INFINITY;
        };
        let (mut same, mut other) = (other - 1.0 / f64::from(PARTS), other);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (same + other);
            if by(middle) == first { same = middle } else { other = middle }
        }
        other * h
    }

    /// The law's torque `ahead_s` after the latest stored one: the parabola through the last three, as far as there are.
    fn extrapolated(&self, ahead_s: f64) -> f64 {
        let [(t0, y0), (t1, y1), (t2, y2)] = self.past;
        if self.known < 3 {
            return y0;
        }
        let (first, second) = ((y0 - y1) / (t0 - t1), (y1 - y2) / (t1 - t2));
        y0 + ahead_s * (first + (ahead_s + t0 - t1) * (first - second) / (t0 - t2))
    }

    /// What arrives after a fraction `part` of the step, if the law's torque is `wanted_nm` at the fraction `at`, no earlier.
    #[inline(always)]
    fn arriving(&mut self, part: f64, (at, wanted_nm): (f64, f64)) -> f64 {
        let Step { t, h, .. } = self.now;
        match &mut self.history {
            None => wanted_nm,
            Some(history) if part * h > self.delay_s => {
                history.arriving_before((t + at * h, wanted_nm), t, part * h)
            }
            Some(history) => history.arriving_after(t, part * h),
        }
    }

    /// The motor's torque at a stage, where the law's torque is `wanted_nm`.
    #[inline(always)]
    fn torque(&mut self, (law, limits): (&LateLaw, &TorqueLimits), stage: usize, wanted_nm: f64) -> f64 {
        let part = STAGES[stage];
        let latest = (part, wanted_nm);
        let known = self.history.is_some() && part * self.now.h <= self.delay_s;
        let arriving_nm =
            if known { self.wanted[(2.0 * part) as usize] } else { self.arriving(part, latest) };
        let command_nm = self.now.command(limits, part, arriving_nm);
        self.free = command_nm == arriving_nm;
        let Some(lag) = &law.lag else { return limits.delivered(command_nm) };
        let middle_nm = self.arriving(0.5 * part, latest);
        let Step { h, began: (began_nm, _), lagged_nm, .. } = self.now;
        let commands = [began_nm, self.now.command(limits, 0.5 * part, middle_nm), command_nm];
        limits.delivered(lag.after(lagged_nm, &commands, part * h))
    }
}

/// The torque of one ride in a step with six speeds.
pub(super) struct LimitedRide<'a> {
    law: &'a LateLaw,
    limits: TorqueLimits,
    lane: &'a mut LimitedLane,
}

impl LimitedRide<'_> {
    /// The motor's torque at a stage. The lane stored the law's torque at the start from the independent speeds, which is
    /// replaced.
    pub(super) fn torque_nm(&mut self, stage: usize, wanted_nm: f64) -> f64 {
        if stage == 0 {
            if let Some(history) = &mut self.lane.history {
                history.correct(wanted_nm);
            }
            self.lane.past[0].1 = wanted_nm;
            let Step { t, h, .. } = self.lane.now;
            self.lane.begin((self.law, &self.limits), t, h);
        }
        self.lane.torque((self.law, &self.limits), stage, wanted_nm)
    }
}
