//! Judges the torque just before the motor, by the same table as the shaper but with code of its own.
//!
//! Where the shaper computes the nearest torque it may ask for, the guard asks what the torque
//! would have to have been: how long such a change takes, how far such a torque lies beyond a line.
//! It never corrects. What it finds wrong becomes zero, and it forgets all, so that whoever asked
//! must begin anew from zero.
//!
//! It is more lenient than the shaper by rounding alone ([`slack`]), by the microsecond to which time is
//! known, and by an eighth of the window's length.

use crate::fault::Cause;
use crate::maths::{is_finite, min};
use crate::safety::limiter::TorqueRequest;
use crate::safety::limits::{CAP_POINTS, Limits};
use core::hint::cold_path;

/// What is wrong with a torque. The numbers stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Violation {
    /// Not a number, or infinite.
    NotFinite = 1,
    /// Not zero without permission.
    NotPermitted = 2,
    /// Beyond the largest torque.
    Magnitude = 3,
    /// Beyond what the authority leaves.
    Authority = 4,
    /// Beyond what limp mode leaves.
    Limp = 5,
    /// Beyond the largest torque at this speed.
    Speed = 6,
    /// Beyond what the taper leaves.
    Taper = 7,
    /// Against the torque of the rider.
    RiderTorque = 8,
    /// Against the motion of the handlebar.
    RiderMotion = 9,
    /// Towards the end-stop.
    EndStop = 10,
    /// Away from zero too fast.
    Rise = 11,
    /// Towards zero too fast.
    Fall = 12,
    /// Too far within the window.
    Window = 13,
}

impl Violation {
    /// Its code.
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

/// What follows from the table and the rate of calls alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuardPlan {
    period_s: f32,
    /// Time one N m takes, up and down \[s/(N m)\]; 0 without a limit.
    rise_s_nm: f32,
    fall_s_nm: f32,
    /// Largest torque; `f32::MAX` without a limit.
    max_nm: f32,
    stagger_us: u32,
}

impl GuardPlan {
    /// Of a checked table, for `rate_hz` calls a second.
    pub fn new(limits: &Limits, rate_hz: f32) -> Self {
        Self {
            period_s: 1.0 / rate_hz,
            rise_s_nm: limits.rise_nm_s.map_or(0.0, |r| 1.0 / r),
            fall_s_nm: limits.fall_nm_s.map_or(0.0, |r| 1.0 / r),
            max_nm: limits.max_torque_nm.unwrap_or(f32::MAX),
            stagger_us: limits.window.map_or(u32::MAX, |w| u32::from(w.ms) * 1000 / STOPWATCHES as u32),
        }
    }
}

/// What the guard remembers of what was really output. `GuardState::default()`: zero for long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GuardState {
    torque_nm: f32,
    turned_us: u32,
    /// The least size of the torque since each watch was started, the newest first \[N m\]. The older ones learn what the
    /// newest has seen when the next one is started.
    watches: [f32; STOPWATCHES],
    /// [`side`] of the torque; when it changes, every watch has seen zero.
    side: f32,
    since_us: u32,
}

/// The torque, if it is inside every limit; else why not, and the motor must be asked for zero.
///
/// `permitted` is false where there must be no torque at this very instant; a permission that
/// runs out over time is `request.authority`. Without permission the memory is cleared, so the shaper's must be too.
///
/// # Errors
/// The first [`Violation`] in the order of their numbers.
pub fn check(
    limits: &Limits,
    plan: &GuardPlan,
    state: &mut GuardState,
    torque_nm: f32,
    permitted: bool,
    request: &TorqueRequest,
) -> Result<f32, Violation> {
    state.pass_time(limits, plan, request);
    let verdict = if !is_finite(torque_nm) {
        Err(Violation::NotFinite)
    } else if permitted {
        Torque::new(limits, plan, state, torque_nm, request.elapsed_us).check(state, request)
    } else if torque_nm == 0.0 {
        Ok(())
    } else {
        Err(Violation::NotPermitted)
    };
    if verdict.is_ok() && permitted {
        state.torque_nm = torque_nm;
    } else {
        *state = GuardState::default();
    }
    verdict.map(|()| torque_nm)
}

/// What rounding may add \[N m\] to a torque that was `last_nm` before: 50 uN m, and two parts in a million.
pub fn slack(torque_nm: f32, last_nm: f32) -> f32 {
    5e-5 + 2e-6 * (torque_nm.abs() + last_nm.abs())
}

/// A torque seen as a size and a side, less what rounding may have added.
struct Torque<'a> {
    limits: &'a Limits,
    plan: &'a GuardPlan,
    /// Size beyond the slack \[N m\]; negative when too small to matter.
    size: f32,
    /// [`side`] of it.
    side: f32,
    /// How far it shrank, on the side where it was, and how far it grew, each less the slack \[N m\].
    shrunk: f32,
    grown: f32,
    /// How far it may have gone back towards zero, slack included; `None` if it changed sides \[N m\].
    back: Option<f32>,
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
        let (size, before) = (torque.abs(), last.abs());
        let cross_checked = if last < 0.0 { torque > 0.0 } else { torque < 0.0 && last > 0.0 };
        let (shrunk, grown, back) = if cross_checked {
            // The time to zero is a matter of the torque that was: a huge one the other way gives it nothing.
            (before - self::slack(0.0, last), size, None)
        } else {
            (before - size - slack, size - before, Some(before - size + slack))
        };
        Self {
            limits,
            plan,
            size: size - slack,
            side: side(torque),
            shrunk,
            grown: grown - slack,
            back,
            elapsed_us: elapsed_us as f32,
        }
    }

    /// So long, or a control period if that is shorter \[s\].
    fn within(&self, us: f32) -> f32 {
        min(self.plan.period_s, us * 1e-6)
    }

    /// Whether it goes back to zero as fast as it may in the least time there was.
    fn retreats(&self) -> bool {
        let takes = |way: f32| way * self.plan.fall_s_nm >= self.within(self.elapsed_us);
        self.limits.fall_nm_s.is_some() && self.back.is_some_and(takes)
    }

    fn check(&self, state: &GuardState, request: &TorqueRequest) -> Result<(), Violation> {
        refuse(Violation::Magnitude, self.size > self.plan.max_nm)?;
        if self.size > 0.0
            && let Err(violation) = self.in_bounds(state, request)
            && !self.retreats()
        {
            return Err(violation);
        }
        self.in_time()?;
        match self.limits.window {
            Some(w) => refuse(Violation::Window, self.size > state.start(self.side) + w.nm),
            None => Ok(()),
        }
    }

    /// Whether it is inside all that depends on bicycle, rider and permission. One that goes back to zero need not be.
    fn in_bounds(&self, state: &GuardState, request: &TorqueRequest) -> Result<(), Violation> {
        let Limits { limp_fraction, speed_cap, taper, rider_torque, rider_motion, end_stop, .. } =
            self.limits;
        let max = self.plan.max_nm;
        refuse(Violation::Authority, self.beyond(max, request.authority, 1.0))?;
        if let (Some(part), true) = (*limp_fraction, request.limp) {
            refuse(Violation::Limp, max < f32::MAX && self.beyond(max, part, 1.0))?;
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
            refuse(Violation::Speed, self.above_line(&cap.speed_m_s, &cap.torque_nm, slow, fast))?;
        }
        if let Some(t) = taper {
            refuse(Violation::Taper, self.beyond(max, slow - t.zero_m_s, t.full_m_s - t.zero_m_s))?;
        }
        if let (Some(r), Some(rider)) = (rider_torque, known_value(request.rider_torque_nm)) {
            let along = rider * self.side;
            refuse(Violation::RiderTorque, self.size - max > (r.allowance_nm + along) * r.multiplier)?;
        }
        if let Some(r) = rider_motion {
            let over = state.turned_us.saturating_sub(u32::from(r.after_ms) * 1000);
            if over > 0 {
                let fade = f32::from(r.fade_ms);
                refuse(Violation::RiderMotion, self.beyond(max, fade - over as f32 * 1e-3, fade))?;
            }
        }
        if let (Some(e), Some(steer)) = (end_stop, known_value(request.steer_rad)) {
            let way_left = e.hard_rad - steer * self.side;
            refuse(Violation::EndStop, self.beyond(max, way_left, e.hard_rad - e.soft_rad))?;
        }
        Ok(())
    }

    /// Whether more than `part` of `whole` of the largest torque. NaN, as nothing and less, is no part; more than the whole
    /// does no harm: the largest torque has been judged.
    fn beyond(&self, max: f32, part: f32, whole: f32) -> bool {
        let inside = self.size * whole <= max * part;
        !inside
    }

    /// Whether anywhere between `slow` and `fast` it lies above the line through the points.
    fn above_line(
        &self,
        speeds: &[f32; CAP_POINTS],
        torques: &[f32; CAP_POINTS],
        slow: f32,
        fast: f32,
    ) -> bool {
        let ([first, .., last], [start, .., end]) = (speeds, torques);
        let outside = (slow <= *first && self.size > *start) || (fast >= *last && self.size > *end);
        let mut pieces = speeds.windows(2).zip(torques.windows(2));
        outside
            || pieces.any(|piece| match piece {
                (&[v0, v1], &[t0, t1]) if slow <= v1 && v0 <= fast => {
                    // By the lever rule. Where a piece begins, the one before it ends.
                    let above = |v: f32| self.size * (v1 - v0) > t0 * (v1 - v) + t1 * (v - v0);
                    (slow >= v0 && above(slow)) || above(min(fast, v1))
                }
                _ => false,
            })
    }

    /// Whether there was time for the change.
    fn in_time(&self) -> Result<(), Violation> {
        let takes = |way: f32, s_nm: f32| if way > 0.0 { way * s_nm } else { 0.0 };
        let (down, up) = (takes(self.shrunk, self.plan.fall_s_nm), takes(self.grown, self.plan.rise_s_nm));
        if down + up <= self.within(self.elapsed_us + 1.0) * (1.0 + 1e-5) {
            Ok(())
        } else if up > 0.0 {
            Err(Violation::Rise)
        } else {
            Err(Violation::Fall)
        }
    }
}

/// How many watches cover a window, each started an eighth of it after the one before.
const STOPWATCHES: usize = 8;

impl GuardState {
    /// The last output was in force for the time that passed.
    fn pass_time(&mut self, limits: &Limits, plan: &GuardPlan, request: &TorqueRequest) {
        let last = self.torque_nm;
        if let Some(r) = &limits.rider_motion {
            let whole = (u32::from(r.after_ms) + u32::from(r.fade_ms)) * 1000;
            let turned_back = match request.steer_rate_rad_s {
                Some(rate) if last > 0.0 => -rate > r.steer_rate_rad_s,
                Some(rate) if last < 0.0 => rate > r.steer_rate_rad_s,
                _ => false,
            };
            let time = self.turned_us;
            self.turned_us = if turned_back {
                whole.min(time.saturating_add(request.elapsed_us))
            } else {
                time - time.min(request.elapsed_us)
            };
        }
        if limits.window.is_some() {
            let (size, side) = (last.abs(), side(last));
            if side != self.side {
                // At the start. The shaper closes a part of the window every eighth of it too; the two are half of that apart,
                // so that hardly any control period has to do both.
                if self.side == 0.0 {
                    self.since_us = plan.stagger_us / 2;
                }
                (self.watches, self.side) = ([0.0; STOPWATCHES], side);
            }
            let [newest, ..] = &mut self.watches;
            *newest = min(size, *newest);
            self.since_us = self.since_us.saturating_add(request.elapsed_us);
            if self.since_us >= plan.stagger_us {
                self.restart(plan.stagger_us, size);
            }
        }
    }

    /// Starts the watches that are due, the oldest ones anew.
    fn restart(&mut self, stagger_us: u32, size: f32) {
        let [newest, older @ ..] = &mut self.watches;
        // An older watch has seen all that a newer one has.
        for stopwatch in older.iter_mut().take_while(|stopwatch| **stopwatch > *newest) {
            *stopwatch = *newest;
        }
        let mut restarts = 0;
        while self.since_us >= stagger_us && restarts < STOPWATCHES {
            self.since_us -= stagger_us;
            restarts += 1;
            let [a, b, c, d, e, f, g, _] = self.watches;
            self.watches = [size, a, b, c, d, e, f, g];
        }
        self.since_us = self.since_us.min(stagger_us);
    }

    /// The least torque on this side of zero since the oldest watch was started.
    fn start(&self, side: f32) -> f32 {
        let [newest, .., oldest] = self.watches;
        if side == self.side { min(newest, oldest) } else { 0.0 }
    }
}

fn refuse(violation: Violation, found: bool) -> Result<(), Violation> {
    if found { Err(violation) } else { Ok(()) }
}

/// +1 to the right, -1 to the left; zero is neither, and counts as right.
fn side(torque: f32) -> f32 {
    if torque < 0.0 { -1.0 } else { 1.0 }
}

fn known_value(value: Option<f32>) -> Option<f32> {
    value.filter(|v| is_finite(*v))
}
