//! Limits the requested torque to the table of limits; a torque inside every limit is unchanged.
//!
//! Magnitude limits and scale factors come first, then limits of the change (window, rate). The window never excludes
//! zero or the last torque, so the rate limit comes last.

use crate::maths::{is_finite, max, min};
use crate::safety::limits::{
    ActiveLimits, EndStop, Limits, RiderMotion, RiderTorque, SpeedCap, Taper, Window,
};
use core::hint::cold_path;

/// Requested torque, and the quantities on which the limits depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueRequest {
    /// Requested steer torque \[N m\]; NaN and infinity count as 0.
    pub wanted_nm: f32,
    /// Permitted fraction of the requested torque, 0 to 1; 1 leaves it unchanged to the bit, NaN counts as 0.
    pub authority: f32,
    /// Whether the controller is in limp mode.
    pub limp: bool,
    /// Lower bound of the speed \[m/s\].
    pub speed_low_m_s: f32,
    /// Upper bound of the speed \[m/s\].
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

/// Constants derived from the limits and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimiterPlan {
    rise_step_nm: Option<f32>,
    fall_step_nm: Option<f32>,
    /// Ratio of rise to fall rate: converts the part of a period left after falling to zero into a rise.
    crossing: f32,
    period_us: u32,
    part_us: u32,
}

impl LimiterPlan {
    /// For validated limits and `rate_hz` calls per second.
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

/// State of the limiter. `LimiterState::default()` is that of a torque that has long been zero; it must be set to the
/// default whenever the motor receives zero instead of the limiter's torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct LimiterState {
    torque_nm: f32,
    /// Timer of the handlebar turning against the torque \[us\].
    against_us: u32,
    history: WindowHistory,
}

impl LimiterState {
    /// The last torque \[N m\].
    pub fn torque_nm(&self) -> f32 {
        self.torque_nm
    }
}

/// Limits the requested torque; returns it with the limits that were active. Finite for every input, and odd: mirrored
/// torques, steer angle and steer rate give the mirrored torque, to the bit.
pub fn step(
    limits: &Limits,
    plan: &LimiterPlan,
    state: &mut LimiterState,
    request: &TorqueRequest,
) -> (f32, ActiveLimits) {
    let last = state.torque_nm;
    let speeds = ordered(request.speed_low_m_s, request.speed_high_m_s);
    let mut limiting =
        Limiting { torque: finite(Some(request.wanted_nm)).unwrap_or(0.0), active: Default::default() };

    if let Some(max) = limits.max_torque_nm {
        limiting.clamp(ActiveLimits::MAGNITUDE, -max, max);
        if let Some(part) = limits.limp_fraction.filter(|_| request.limp) {
            limiting.clamp(ActiveLimits::LIMP, -max * part, max * part);
        }
        if let (Some(r), Some(rider)) = (limits.rider_torque, finite(request.rider_torque_nm)) {
            let (low, high) = rider_band(&r, max, rider);
            limiting.clamp(ActiveLimits::RIDER_TORQUE, low, high);
        }
    }
    if let Some(cap) = &limits.speed_cap {
        let cap_nm = smallest_cap(cap, speeds);
        limiting.clamp(ActiveLimits::SPEED, -cap_nm, cap_nm);
    }
    if let Some(taper) = &limits.taper {
        limiting.scale(ActiveLimits::TAPER, taper_factor(taper, speeds.0));
    }
    limiting.scale(ActiveLimits::AUTHORITY, unit_interval(request.authority));
    if let Some(rider) = &limits.rider_motion {
        state.against_us = against_timer_us(rider, state.against_us, last, request);
        limiting.scale(ActiveLimits::RIDER_MOTION, rider_motion_factor(rider, state.against_us));
    }
    if let (Some(stop), Some(steer)) = (&limits.end_stop, finite(request.steer_rad)) {
        let factor = if limiting.torque * steer > 0.0 { end_stop_factor(stop, steer) } else { 1.0 };
        limiting.scale(ActiveLimits::END_STOP, factor);
    }
    if let Some(Window { nm, .. }) = limits.window {
        state.history.add(last, request.elapsed_us, plan.part_us);
        let (left, right) = state.history.minimum();
        limiting.clamp(ActiveLimits::WINDOW, -left - nm, right + nm);
    }
    if plan.rise_step_nm.is_some() || plan.fall_step_nm.is_some() {
        let (low, high) = reachable(plan, last, request.elapsed_us);
        limiting.clamp(ActiveLimits::RATE, low, high);
    }
    state.torque_nm = limiting.torque;
    (limiting.torque, limiting.active)
}

/// A torque while the limits are applied, and the limits active so far.
struct Limiting {
    torque: f32,
    active: ActiveLimits,
}

impl Limiting {
    fn clamp(&mut self, limit: ActiveLimits, low: f32, high: f32) {
        let clamped = if self.torque > high {
            high
        } else if self.torque < low {
            low
        } else {
            return;
        };
        self.active.note(limit, true);
        self.torque = clamped;
    }
    fn scale(&mut self, limit: ActiveLimits, factor: f32) {
        if factor < 1.0 {
            cold_path();
            self.active.note(limit, self.torque != 0.0);
            self.torque *= factor;
        }
    }
}

/// Lowest (left) and highest (right) torque allowed by the rider's torque.
fn rider_band(limit: &RiderTorque, max_nm: f32, rider: f32) -> (f32, f32) {
    let high = max_nm + (limit.allowance_nm + rider) * limit.multiplier;
    let low = max_nm + (limit.allowance_nm - rider) * limit.multiplier;
    (-max(low, 0.0), max(high, 0.0))
}

/// Smallest torque of the cap in the interval of speeds: at its ends and at the points between.
fn smallest_cap(cap: &SpeedCap, (slow, fast): (f32, f32)) -> f32 {
    let mut minimum = f32::MAX;
    let mut previous: Option<(f32, f32)> = None;
    for (&v, &t) in cap.speed_m_s.iter().zip(&cap.torque_nm) {
        let at = |speed| previous.map_or(t, |(v0, t0)| t0 + (t - t0) * ((speed - v0) / (v - v0)));
        if slow <= v {
            // The interval begins in this segment.
            if previous.is_none_or(|(v0, _)| slow > v0) {
                minimum = at(slow);
            }
            if fast <= v {
                return min(minimum, at(fast));
            }
            if slow < v {
                minimum = min(t, minimum);
            }
        }
        previous = Some((v, t));
    }
    previous.map_or(minimum, |(_, t)| min(t, minimum))
}

fn taper_factor(taper: &Taper, speed: f32) -> f32 {
    if speed >= taper.full_m_s {
        1.0
    } else if speed > taper.zero_m_s {
        (speed - taper.zero_m_s) / (taper.full_m_s - taper.zero_m_s)
    } else {
        0.0
    }
}

fn end_stop_factor(stop: &EndStop, steer: f32) -> f32 {
    if steer.abs() <= stop.soft_rad {
        return 1.0;
    }
    unit_interval((stop.hard_rad - steer.abs()) / (stop.hard_rad - stop.soft_rad))
}

/// Value of the timer of the handlebar turning against the torque \[us\].
fn against_timer_us(rider: &RiderMotion, previous_us: u32, torque: f32, request: &TorqueRequest) -> u32 {
    let rate = request.steer_rate_rad_s.unwrap_or(0.0);
    let limit = rider.steer_rate_rad_s;
    let back = if torque > 0.0 { -rate } else { rate };
    if back > limit && torque != 0.0 {
        let max_us = (u32::from(rider.after_ms) + u32::from(rider.fade_ms)) * 1000;
        previous_us.saturating_add(request.elapsed_us).min(max_us)
    } else {
        previous_us.saturating_sub(request.elapsed_us)
    }
}

fn rider_motion_factor(rider: &RiderMotion, against_us: u32) -> f32 {
    let (after_us, fade_us) = (1000 * u32::from(rider.after_ms), 1000 * u32::from(rider.fade_ms));
    let excess_us = against_us.saturating_sub(after_us);
    if excess_us == 0 { 1.0 } else { fade_us.saturating_sub(excess_us) as f32 / fade_us as f32 }
}

/// Range of torques that one step can reach from `last`.
fn reachable(plan: &LimiterPlan, last: f32, elapsed_us: u32) -> (f32, f32) {
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
    // Subtraction from 0 instead of negation keeps zero positive.
    if last > 0.0 {
        (back(last), 0.0 - away(-last))
    } else if last < 0.0 {
        (away(last), 0.0 - back(-last))
    } else {
        (away(last), 0.0 - away(-last))
    }
}

/// Parts of the window: one that is being filled, and enough full ones to cover the window.
const PARTS: usize = 9;

impl Window {
    /// Longest time over which the change is limited, at control periods of `period_s` \[s\]: the window in whole parts.
    pub fn longest_s(&self, period_s: f32) -> f32 {
        1e-3 * f32::from(self.ms) * PARTS as f32 / (PARTS - 1) as f32 + period_s
    }
}

/// Torques within the window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
struct WindowHistory {
    /// Smallest magnitude of the torque in each part of the window \[N m\]; zero in parts on the other side of zero,
    /// because the torque has then been zero within the window.
    parts: [f32; PARTS],
    /// Smallest of all parts \[N m\].
    minimum: f32,
    right: bool,
    newest: usize,
    filled_us: u32,
}

impl WindowHistory {
    /// Adds `torque`, which was output for `elapsed_us`.
    fn add(&mut self, torque: f32, elapsed_us: u32, part_us: u32) {
        let (size, right) = (torque.abs(), torque > 0.0);
        if right != self.right {
            (self.parts, self.minimum, self.right) = ([0.0; PARTS], 0.0, right);
        }
        self.filled_us = self.filled_us.saturating_add(elapsed_us);
        if self.filled_us >= part_us {
            self.close_parts(size, part_us);
        } else if let Some(part) = self.parts.get_mut(self.newest) {
            *part = min(size, *part);
            self.minimum = min(size, self.minimum);
        }
    }

    /// Closes the full part, and further ones after a gap; the oldest parts are dropped.
    fn close_parts(&mut self, size: f32, part_us: u32) {
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
        self.minimum = self.parts.iter().fold(f32::MAX, |minimum, part| min(*part, minimum));
    }

    /// Smallest magnitude to the left, and to the right, within the window \[N m\].
    fn minimum(&self) -> (f32, f32) {
        if self.right { (0.0, self.minimum) } else { (self.minimum, 0.0) }
    }
}

/// Speeds in rising order; the widest interval if one is NaN.
fn ordered(a: f32, b: f32) -> (f32, f32) {
    if a <= b {
        return (a, b);
    }
    cold_path();
    if b < a { (b, a) } else { (f32::MIN, f32::MAX) }
}

fn finite(value: Option<f32>) -> Option<f32> {
    value.filter(|v| is_finite(*v))
}

/// `x` limited to 0..=1; NaN gives 0.
fn unit_interval(x: f32) -> f32 {
    if x >= 1.0 {
        1.0
    } else if x > 0.0 {
        x
    } else {
        0.0
    }
}
