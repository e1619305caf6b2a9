//! Shapes the wanted torque into one that may be asked of the motor: inside every limit of the
//! table, and otherwise as wanted.
//!
//! First what the torque may be (caps, then shares), then how it may get there (window, rate). The
//! window never keeps it from zero and never excludes where it is, so the rate has the last word.

use crate::maths::{is_finite, max, min};
use crate::safety::limits::{
    ActiveLimits, EndStop, Limits, RiderMotion, RiderTorque, SpeedCap, Taper, Window,
};
use core::hint::cold_path;

/// What the shaper is asked for, and what the limits depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueRequest {
    /// Wanted steer torque \[N m\]; NaN and infinity ask for none.
    pub wanted_nm: f32,
    /// How much of it is permitted, 0 to 1; 1 changes no bit of it. NaN is 0.
    pub authority: f32,
    /// Whether the controller limps.
    pub limp: bool,
    /// Lowest speed of the recent past \[m/s\].
    pub speed_low_m_s: f32,
    /// Highest speed of the recent past \[m/s\].
    pub speed_high_m_s: f32,
    /// Steer angle, positive to the right \[rad\], if known.
    pub steer_rad: Option<f32>,
    /// Steer rate \[rad/s\], if known.
    pub steer_rate_rad_s: Option<f32>,
    /// The rider's steer torque, positive to the right \[N m\], if known.
    pub rider_torque_nm: Option<f32>,
    /// Time since the last call \[us\].
    pub elapsed_us: u32,
}

/// What follows from the table and the rate of calls alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimiterPlan {
    rise_step_nm: Option<f32>,
    fall_step_nm: Option<f32>,
    /// Rise over fall: what is left of a period after falling to zero is spent on rising.
    crossing: f32,
    period_us: u32,
    part_us: u32,
}

impl LimiterPlan {
    /// Of a checked table, for `rate_hz` calls a second.
    pub fn new(limits: &Limits, rate_hz: f32) -> Self {
        let step = |rate: Option<f32>| rate.map(|r| r / rate_hz);
        Self {
            rise_step_nm: step(limits.rise_nm_s),
            fall_step_nm: step(limits.fall_nm_s),
            crossing: match (limits.rise_nm_s, limits.fall_nm_s) {
                (Some(rise), Some(fall)) => rise / fall,
                _ => f32::MAX,
            },
            period_us: (1e6 / rate_hz) as u32,
            part_us: limits.window.map_or(u32::MAX, |w| u32::from(w.ms) * 1000 / (PARTS as u32 - 1) + 1),
        }
    }
}

/// What the shaper remembers. `LimiterState::default()` is one whose torque has been zero for long:
/// what it must be set to whenever the motor was asked for zero instead of its torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimiterState {
    torque_nm: f32,
    against_us: u32,
    past: Past,
}

impl LimiterState {
    /// The last torque \[N m\].
    pub fn torque_nm(&self) -> f32 {
        self.torque_nm
    }
}

/// The wanted torque shaped, and the limits that acted. Finite for every input, and odd: torques,
/// steer angle and steer rate mirrored give the torque mirrored, to the bit.
pub fn step(
    limits: &Limits,
    plan: &LimiterPlan,
    state: &mut LimiterState,
    request: &TorqueRequest,
) -> (f32, ActiveLimits) {
    let last = state.torque_nm;
    let speeds = interval(request.speed_low_m_s, request.speed_high_m_s);
    let mut limiting =
        Limiting { torque: finite(Some(request.wanted_nm)).unwrap_or(0.0), acted: Default::default() };

    if let Some(max) = limits.max_torque_nm {
        limiting.cut(ActiveLimits::MAGNITUDE, -max, max);
        if let Some(part) = limits.limp_fraction.filter(|_| request.limp) {
            limiting.cut(ActiveLimits::LIMP, -max * part, max * part);
        }
        if let (Some(r), Some(rider)) = (limits.rider_torque, finite(request.rider_torque_nm)) {
            let (low, high) = rider_band(&r, max, rider);
            limiting.cut(ActiveLimits::RIDER_TORQUE, low, high);
        }
    }
    if let Some(cap) = &limits.speed_cap {
        let most = lowest_in(cap, speeds);
        limiting.cut(ActiveLimits::SPEED, -most, most);
    }
    if let Some(taper) = &limits.taper {
        limiting.scale(ActiveLimits::TAPER, taper_share(taper, speeds.0));
    }
    limiting.scale(ActiveLimits::AUTHORITY, share(request.authority));
    if let Some(rider) = &limits.rider_motion {
        state.against_us = against(rider, state.against_us, last, request);
        limiting.scale(ActiveLimits::RIDER_MOTION, motion_share(rider, state.against_us));
    }
    if let (Some(stop), Some(steer)) = (&limits.end_stop, finite(request.steer_rad)) {
        let share = if limiting.torque * steer > 0.0 { stop_share(stop, steer) } else { 1.0 };
        limiting.scale(ActiveLimits::END_STOP, share);
    }
    if let Some(Window { nm, .. }) = limits.window {
        state.past.hold(last, request.elapsed_us, plan.part_us);
        let (left, right) = state.past.least();
        limiting.cut(ActiveLimits::WINDOW, -left - nm, right + nm);
    }
    if plan.rise_step_nm.is_some() || plan.fall_step_nm.is_some() {
        let (low, high) = reach(plan, last, request.elapsed_us);
        limiting.cut(ActiveLimits::RATE, low, high);
    }
    state.torque_nm = limiting.torque;
    (limiting.torque, limiting.acted)
}

/// A torque on its way through the limits.
struct Limiting {
    torque: f32,
    acted: ActiveLimits,
}

impl Limiting {
    fn cut(&mut self, limit: ActiveLimits, low: f32, high: f32) {
        let cut = if self.torque > high {
            high
        } else if self.torque < low {
            low
        } else {
            return;
        };
        self.acted.note(limit, true);
        self.torque = cut;
    }
    fn scale(&mut self, limit: ActiveLimits, share: f32) {
        if share < 1.0 {
            cold_path();
            self.acted.note(limit, self.torque != 0.0);
            self.torque *= share;
        }
    }
}

/// Lowest and highest torque to the left and right that the rider's torque leaves.
fn rider_band(limit: &RiderTorque, max_nm: f32, rider: f32) -> (f32, f32) {
    let high = max_nm + (limit.allowance_nm + rider) * limit.multiplier;
    let low = max_nm + (limit.allowance_nm - rider) * limit.multiplier;
    (-max(low, 0.0), max(high, 0.0))
}

/// The smallest torque of the cap anywhere in the interval of speeds: at its ends and at the points between.
fn lowest_in(cap: &SpeedCap, (slow, fast): (f32, f32)) -> f32 {
    let mut least = f32::MAX;
    let mut before: Option<(f32, f32)> = None;
    for (&v, &t) in cap.speed_m_s.iter().zip(&cap.torque_nm) {
        let at = |speed| before.map_or(t, |(v0, t0)| t0 + (t - t0) * ((speed - v0) / (v - v0)));
        if slow <= v {
            // Here it begins.
            if before.is_none_or(|(v0, _)| slow > v0) {
                least = at(slow);
            }
            if fast <= v {
                return min(least, at(fast));
            }
            if slow < v {
                least = min(t, least);
            }
        }
        before = Some((v, t));
    }
    before.map_or(least, |(_, t)| min(t, least))
}

fn taper_share(taper: &Taper, speed: f32) -> f32 {
    if speed >= taper.full_m_s {
        1.0
    } else if speed > taper.zero_m_s {
        (speed - taper.zero_m_s) / (taper.full_m_s - taper.zero_m_s)
    } else {
        0.0
    }
}

fn stop_share(stop: &EndStop, steer: f32) -> f32 {
    if steer.abs() <= stop.soft_rad {
        return 1.0;
    }
    share((stop.hard_rad - steer.abs()) / (stop.hard_rad - stop.soft_rad))
}

/// For how long the handlebar has been turned against the torque \[us\].
fn against(rider: &RiderMotion, before_us: u32, torque: f32, request: &TorqueRequest) -> u32 {
    let rate = request.steer_rate_rad_s.unwrap_or(0.0);
    let limit = rider.steer_rate_rad_s;
    let back = if torque > 0.0 { -rate } else { rate };
    if back > limit && torque != 0.0 {
        let most = (u32::from(rider.after_ms) + u32::from(rider.fade_ms)) * 1000;
        before_us.saturating_add(request.elapsed_us).min(most)
    } else {
        before_us.saturating_sub(request.elapsed_us)
    }
}

fn motion_share(rider: &RiderMotion, against_us: u32) -> f32 {
    let (after_us, fade_us) = (1000 * u32::from(rider.after_ms), 1000 * u32::from(rider.fade_ms));
    let over_us = against_us.saturating_sub(after_us);
    if over_us == 0 { 1.0 } else { fade_us.saturating_sub(over_us) as f32 / fade_us as f32 }
}

/// The torques one step reaches from `last`.
fn reach(plan: &LimiterPlan, last: f32, elapsed_us: u32) -> (f32, f32) {
    let (mut rise, mut fall) = (plan.rise_step_nm, plan.fall_step_nm);
    if elapsed_us < plan.period_us {
        let part = elapsed_us as f32 / plan.period_us as f32;
        (rise, fall) = (rise.map(|step| step * part), fall.map(|step| step * part));
    }
    let rise = rise.unwrap_or(f32::MAX);
    let back = |from: f32| match fall {
        None => -rise,
        Some(fall) if from >= fall => from - fall,
        Some(fall) => (from - fall) * plan.crossing,
    };
    let away = |from: f32| from - rise;
    // Not a mere minus: zero stays a positive zero.
    if last > 0.0 {
        (back(last), 0.0 - away(-last))
    } else if last < 0.0 {
        (away(last), 0.0 - back(-last))
    } else {
        (away(last), 0.0 - away(-last))
    }
}

/// Parts of the window: one that is being filled, and as many full ones as cover it.
const PARTS: usize = 9;

/// The torques of the recent past.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Past {
    /// The least size of the torque in each part of the window \[N m\]; zero where it was not on the side where it is
    /// now, for then it has been zero within the window.
    parts: [f32; PARTS],
    /// The least of them \[N m\].
    least: f32,
    right: bool,
    newest: usize,
    filled_us: u32,
}

impl Past {
    /// `torque` was in force for the time that passed.
    fn hold(&mut self, torque: f32, elapsed_us: u32, part_us: u32) {
        let (size, right) = (torque.abs(), torque > 0.0);
        if right != self.right {
            (self.parts, self.least, self.right) = ([0.0; PARTS], 0.0, right);
        }
        self.filled_us = self.filled_us.saturating_add(elapsed_us);
        if self.filled_us >= part_us {
            self.close(size, part_us);
        } else if let Some(part) = self.parts.get_mut(self.newest) {
            *part = min(size, *part);
            self.least = min(size, self.least);
        }
    }

    /// Closes the part that is full, and more of them after a gap; the oldest ones are forgotten.
    fn close(&mut self, size: f32, part_us: u32) {
        for _ in 0..PARTS {
            if self.filled_us < part_us {
                break;
            }
            self.filled_us -= part_us;
            self.newest = if self.newest + 1 < PARTS { self.newest + 1 } else { 0 };
            if let Some(part) = self.parts.get_mut(self.newest) {
                *part = size;
            }
        }
        if self.filled_us >= part_us {
            self.filled_us = 0;
        }
        self.least = self.parts.iter().fold(f32::MAX, |least, part| min(*part, least));
    }

    /// How far to the left, and to the right, the torque was at the least within the window \[N m\].
    fn least(&self) -> (f32, f32) {
        if self.right { (0.0, self.least) } else { (self.least, 0.0) }
    }
}

/// Speeds in order; if any is NaN, all speeds there are.
fn interval(a: f32, b: f32) -> (f32, f32) {
    if a <= b {
        return (a, b);
    }
    cold_path();
    if b < a { (b, a) } else { (f32::MIN, f32::MAX) }
}

fn finite(value: Option<f32>) -> Option<f32> {
    value.filter(|v| is_finite(*v))
}

/// `x` within 0..=1; NaN is 0.
fn share(x: f32) -> f32 {
    if x >= 1.0 {
        1.0
    } else if x > 0.0 {
        x
    } else {
        0.0
    }
}
