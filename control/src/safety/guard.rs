//! Checks the limiter's torque immediately before the motor, against the same limits but with independent code.
//!
//! The limiter computes the nearest allowed torque. The guard checks the torque it is given: was there time for the
//! change, is the value inside each limit? It never corrects. On a violation the torque becomes zero and the guard
//! clears its state; the limiter restarts from zero.
//!
//! The guard is more tolerant than the limiter only by rounding ([`slack`]), by one microsecond, the resolution of
//! time, and by an eighth of the window's length.

use crate::fault::Cause;
use crate::maths::{is_finite, min};
use crate::safety::limiter::TorqueRequest;
use crate::safety::limits::{CAP_POINTS, Limits};
use core::hint::cold_path;

/// Limit that a torque violates. The numbers are permanent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Violation {
    /// NaN or infinite.
    NotFinite = 1,
    /// Not zero while torque is not permitted.
    NotPermitted = 2,
    /// Above the largest torque.
    Magnitude = 3,
    /// Above the fraction given by the authority.
    Authority = 4,
    /// Above the largest torque of limp mode.
    Limp = 5,
    /// Above the largest torque at this speed.
    Speed = 6,
    /// Above the taper's limit.
    Taper = 7,
    /// Against the rider's torque.
    RiderTorque = 8,
    /// Against the motion of the handlebar.
    RiderMotion = 9,
    /// Towards the end-stop.
    EndStop = 10,
    /// Away from zero too fast.
    Rise = 11,
    /// Towards zero too fast.
    Fall = 12,
    /// Changed too far within the window.
    Window = 13,
}

impl Violation {
    /// The cause that reports this violation.
    pub const fn cause(self) -> Cause {
        match self {
            Violation::NotFinite => Cause::GuardNotFinite,
            Violation::NotPermitted | Violation::Authority => Cause::GuardPermission,
            Violation::Magnitude | Violation::Limp | Violation::Speed | Violation::Taper => {
                Cause::GuardTorque
            }
            Violation::RiderTorque | Violation::RiderMotion => Cause::GuardOverride,
            Violation::EndStop => Cause::GuardEndStop,
            Violation::Rise | Violation::Fall => Cause::GuardRate,
            Violation::Window => Cause::GuardWindow,
        }
    }
}

/// Constants derived from the limits and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuardPlan {
    period_s: f32,
    /// Time per N m of change, rising and falling \[s/(N m)\]; 0 without a limit.
    rise_s_nm: f32,
    fall_s_nm: f32,
    /// Largest torque \[N m\]; `f32::MAX` without a limit.
    max_nm: f32,
    /// Time between the starts of two intervals \[us\].
    spacing_us: u32,
}

impl GuardPlan {
    /// For validated limits and `rate_hz` calls per second.
    pub fn new(limits: &Limits, rate_hz: f32) -> Self {
        Self {
            period_s: 1.0 / rate_hz,
            rise_s_nm: limits.rise_nm_s.map_or(0.0, |r| 1.0 / r),
            fall_s_nm: limits.fall_nm_s.map_or(0.0, |r| 1.0 / r),
            max_nm: limits.max_torque_nm.unwrap_or(f32::MAX),
            spacing_us: limits.window.map_or(u32::MAX, |w| u32::from(w.ms) * 1000 / INTERVALS as u32),
        }
    }
}

/// State of the guard: the torque that was output. `GuardState::default()` is that of a torque that has long been zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct GuardState {
    torque_nm: f32,
    /// Timer of the handlebar turning against the torque \[us\].
    against_us: u32,
    /// Smallest magnitude of the torque since the start of each interval, newest first \[N m\]. Only the newest is
    /// updated in each period; the older ones take its value, where smaller, when the next interval starts.
    minima: [f32; INTERVALS],
    /// [`side`] of the torque; when it changes, every minimum becomes zero.
    side: f32,
    /// Time since the newest interval started \[us\].
    interval_us: u32,
}

/// Checks a torque; returns it if it is inside every limit, else the violation, and the motor must receive zero.
///
/// `permitted` is false where torque is forbidden at this instant; a permission that fades over time is
/// `request.authority`. Without permission the state is cleared, so the limiter's must be too.
///
/// # Errors
/// The first [`Violation`] in numerical order.
pub fn check(
    limits: &Limits,
    plan: &GuardPlan,
    state: &mut GuardState,
    torque_nm: f32,
    permitted: bool,
    request: &TorqueRequest,
) -> Result<f32, Violation> {
    state.advance(limits, plan, request);
    let result = if !is_finite(torque_nm) {
        Err(Violation::NotFinite)
    } else if permitted {
        Torque::new(limits, plan, state, torque_nm, request.elapsed_us).check(state, request)
    } else if torque_nm == 0.0 {
        Ok(())
    } else {
        Err(Violation::NotPermitted)
    };
    if result.is_ok() && permitted {
        state.torque_nm = torque_nm;
    } else {
        *state = GuardState::default();
    }
    result.map(|()| torque_nm)
}

/// Tolerance for rounding of a torque that was `last_nm` before \[N m\]: 50 uN m plus two parts in a million.
pub fn slack(torque_nm: f32, last_nm: f32) -> f32 {
    5e-5 + 2e-6 * (torque_nm.abs() + last_nm.abs())
}

/// A torque as magnitude and side, with the rounding tolerance subtracted.
struct Torque<'a> {
    limits: &'a Limits,
    plan: &'a GuardPlan,
    /// Magnitude less the slack \[N m\]; negative if negligible.
    size: f32,
    /// [`side`] of the torque.
    side: f32,
    /// Decrease of the magnitude on the previous side, and increase of the magnitude, each less the slack \[N m\].
    decrease: f32,
    increase: f32,
    /// Decrease towards zero plus the slack \[N m\]; `None` if the torque changed sides.
    returned: Option<f32>,
    /// Time since the last call \[us\].
    elapsed_us: f32,
}

impl<'a> Torque<'a> {
    fn new(
        limits: &'a Limits,
        plan: &'a GuardPlan,
        state: &GuardState,
        torque: f32,
        elapsed_us: u32,
    ) -> Self {
        let last = state.torque_nm;
        let slack = slack(torque, last);
        let (size, previous) = (torque.abs(), last.abs());
        let crossed_zero = if last < 0.0 { torque > 0.0 } else { torque < 0.0 && last > 0.0 };
        let (decrease, increase, returned) = if crossed_zero {
            // The slack of the fall depends on the previous torque only: a large torque on the other side must not
            // enlarge it.
            (previous - self::slack(0.0, last), size, None)
        } else {
            (previous - size - slack, size - previous, Some(previous - size + slack))
        };
        Self {
            limits,
            plan,
            size: size - slack,
            side: side(torque),
            decrease,
            increase: increase - slack,
            returned,
            elapsed_us: elapsed_us as f32,
        }
    }

    /// Time `us`, limited to one control period \[s\].
    fn limited_time_s(&self, us: f32) -> f32 {
        min(self.plan.period_s, us * 1e-6)
    }

    /// Whether the torque returns to zero at the full fall rate over the elapsed time, at most one control period.
    fn returns_to_zero(&self) -> bool {
        let is_fastest =
            |change_nm: f32| change_nm * self.plan.fall_s_nm >= self.limited_time_s(self.elapsed_us);
        self.limits.fall_nm_s.is_some() && self.returned.is_some_and(is_fastest)
    }

    fn check(&self, state: &GuardState, request: &TorqueRequest) -> Result<(), Violation> {
        reject(Violation::Magnitude, self.size > self.plan.max_nm)?;
        if self.size > 0.0
            && let Err(violation) = self.check_bounds(state, request)
            && !self.returns_to_zero()
        {
            return Err(violation);
        }
        self.check_rate()?;
        match self.limits.window {
            Some(w) => reject(Violation::Window, self.size > state.minimum(self.side) + w.nm),
            None => Ok(()),
        }
    }

    /// Checks the limits that depend on bicycle, rider and permission. A torque that returns to zero is exempt.
    fn check_bounds(&self, state: &GuardState, request: &TorqueRequest) -> Result<(), Violation> {
        let Limits { limp_fraction, speed_cap, taper, rider_torque, rider_motion, end_stop, .. } =
            self.limits;
        let max = self.plan.max_nm;
        reject(Violation::Authority, self.exceeds_fraction(max, request.authority, 1.0))?;
        if let (Some(part), true) = (*limp_fraction, request.limp) {
            reject(Violation::Limp, max < f32::MAX && self.exceeds_fraction(max, part, 1.0))?;
        }
        let (slow, fast) = (request.speed_low_m_s, request.speed_high_m_s);
        let (slow, fast) = if slow <= fast {
            (slow, fast)
        } else if fast < slow {
            cold_path();
            (fast, slow)
        } else {
            cold_path();
            (-1e9, 1e9)
        };
        if let Some(cap) = speed_cap {
            reject(Violation::Speed, self.above_line(&cap.speed_m_s, &cap.torque_nm, slow, fast))?;
        }
        if let Some(t) = taper {
            reject(Violation::Taper, self.exceeds_fraction(max, slow - t.zero_m_s, t.full_m_s - t.zero_m_s))?;
        }
        if let (Some(r), Some(rider)) = (rider_torque, known_value(request.rider_torque_nm)) {
            let along = rider * self.side;
            reject(Violation::RiderTorque, self.size - max > (r.allowance_nm + along) * r.multiplier)?;
        }
        if let Some(r) = rider_motion {
            let excess_us = state.against_us.saturating_sub(u32::from(r.after_ms) * 1000);
            if excess_us > 0 {
                let fade = f32::from(r.fade_ms);
                reject(
                    Violation::RiderMotion,
                    self.exceeds_fraction(max, fade - excess_us as f32 * 1e-3, fade),
                )?;
            }
        }
        if let (Some(e), Some(steer)) = (end_stop, known_value(request.steer_rad)) {
            let margin_rad = e.hard_rad - steer * self.side;
            reject(Violation::EndStop, self.exceeds_fraction(max, margin_rad, e.hard_rad - e.soft_rad))?;
        }
        Ok(())
    }

    /// Whether the magnitude exceeds `part / whole` of the largest torque. NaN, zero and negative parts allow none. A
    /// part above `whole` is harmless: the largest torque is checked separately.
    fn exceeds_fraction(&self, max: f32, part: f32, whole: f32) -> bool {
        let inside = self.size * whole <= max * part;
        !inside
    }

    /// Whether the torque is above the line through the points at any speed between `slow` and `fast`.
    fn above_line(
        &self,
        speeds: &[f32; CAP_POINTS],
        torques: &[f32; CAP_POINTS],
        slow: f32,
        fast: f32,
    ) -> bool {
        let ([first, .., last], [start, .., end]) = (speeds, torques);
        let outside = (slow <= *first && self.size > *start) || (fast >= *last && self.size > *end);
        let mut segments = speeds.windows(2).zip(torques.windows(2));
        outside
            || segments.any(|segment| match segment {
                (&[v0, v1], &[t0, t1]) if slow <= v1 && v0 <= fast => {
                    // Lever rule. Each segment begins where the previous one ends.
                    let above = |v: f32| self.size * (v1 - v0) > t0 * (v1 - v) + t1 * (v - v0);
                    (slow >= v0 && above(slow)) || above(min(fast, v1))
                }
                _ => false,
            })
    }

    /// Checks that the elapsed time suffices for the change.
    fn check_rate(&self) -> Result<(), Violation> {
        let required_s = |change_nm: f32, s_nm: f32| if change_nm > 0.0 { change_nm * s_nm } else { 0.0 };
        let (down, up) =
            (required_s(self.decrease, self.plan.fall_s_nm), required_s(self.increase, self.plan.rise_s_nm));
        if down + up <= self.limited_time_s(self.elapsed_us + 1.0) * (1.0 + 1e-5) {
            Ok(())
        } else if up > 0.0 {
            Err(Violation::Rise)
        } else {
            Err(Violation::Fall)
        }
    }
}

/// Number of intervals that cover the window, each from its start until now; the starts are an eighth of the window
/// apart.
const INTERVALS: usize = 8;

impl GuardState {
    /// Advances the state by the elapsed time, in which the last torque was output.
    fn advance(&mut self, limits: &Limits, plan: &GuardPlan, request: &TorqueRequest) {
        let last = self.torque_nm;
        if let Some(r) = &limits.rider_motion {
            let limit_us = (u32::from(r.after_ms) + u32::from(r.fade_ms)) * 1000;
            let turns_against = match request.steer_rate_rad_s {
                Some(rate) if last > 0.0 => -rate > r.steer_rate_rad_s,
                Some(rate) if last < 0.0 => rate > r.steer_rate_rad_s,
                _ => false,
            };
            let time = self.against_us;
            self.against_us = if turns_against {
                limit_us.min(time.saturating_add(request.elapsed_us))
            } else {
                time - time.min(request.elapsed_us)
            };
        }
        if limits.window.is_some() {
            let (size, side) = (last.abs(), side(last));
            if side != self.side {
                // At start-up. The limiter also closes a part of its window every eighth of it; an offset of half a
                // part keeps both out of the same control period.
                if self.side == 0.0 {
                    self.interval_us = plan.spacing_us / 2;
                }
                (self.minima, self.side) = ([0.0; INTERVALS], side);
            }
            let [newest, ..] = &mut self.minima;
            *newest = min(size, *newest);
            self.interval_us = self.interval_us.saturating_add(request.elapsed_us);
            if self.interval_us >= plan.spacing_us {
                self.start_intervals(plan.spacing_us, size);
            }
        }
    }

    /// Starts the intervals that are due; the oldest ones are dropped.
    fn start_intervals(&mut self, spacing_us: u32, size: f32) {
        let [newest, older @ ..] = &mut self.minima;
        // Every older interval contains the newer ones.
        for minimum in older.iter_mut().take_while(|minimum| **minimum > *newest) {
            *minimum = *newest;
        }
        let mut started = 0;
        while self.interval_us >= spacing_us && started < INTERVALS {
            self.interval_us -= spacing_us;
            started += 1;
            let [a, b, c, d, e, f, g, _] = self.minima;
            self.minima = [size, a, b, c, d, e, f, g];
        }
        self.interval_us = self.interval_us.min(spacing_us);
    }

    /// Smallest magnitude on this side of zero since the start of the oldest interval \[N m\].
    fn minimum(&self, side: f32) -> f32 {
        let [newest, .., oldest] = self.minima;
        if side == self.side { min(newest, oldest) } else { 0.0 }
    }
}

fn reject(violation: Violation, condition: bool) -> Result<(), Violation> {
    if condition { Err(violation) } else { Ok(()) }
}

/// +1 to the right and for zero, -1 to the left.
fn side(torque: f32) -> f32 {
    if torque < 0.0 { -1.0 } else { 1.0 }
}

fn known_value(value: Option<f32>) -> Option<f32> {
    value.filter(|v| is_finite(*v))
}
