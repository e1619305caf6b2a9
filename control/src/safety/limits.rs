//! The one table of limits. [`crate::safety::limiter`] keeps the torque inside it, [`crate::safety::guard`] judges by it,
//! each with code of its own; what a limit means is written here.
//!
//! Every limit is off (`None`) or set. Zero torque is inside every limit. Those that depend on what
//! the bicycle or the rider does may shrink in an instant: a torque that is then outside is inside
//! the limits as long as it goes back to them as fast as `fall_nm_s` lets it.

use crate::param::{Checker, ParamError, ParamSpec, ParamVisitor, optional};

/// Points of a [`SpeedCap`].
pub const CAP_POINTS: usize = 4;

/// The limits on the torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Largest torque, either way \[N m\].
    pub max_torque_nm: Option<f32>,
    /// Largest torque by speed.
    pub speed_cap: Option<SpeedCap>,
    /// Taper below walking speed.
    pub taper: Option<Taper>,
    /// Fastest change away from zero torque \[N m/s\].
    pub rise_nm_s: Option<f32>,
    /// Fastest change towards zero torque \[N m/s\]. A torque that changes sign first falls to zero, then rises.
    /// Neither is given more than one control period's time in a step, nor more time than has passed.
    pub fall_nm_s: Option<f32>,
    /// The rider overrides, felt by a torque sensor.
    pub rider_torque: Option<RiderTorque>,
    /// The rider overrides, seen by the handlebar turning against the torque.
    pub rider_motion: Option<RiderMotion>,
    /// Limit in real time, however often the controller is called.
    pub window: Option<Window>,
    /// The steer's soft end-stop.
    pub end_stop: Option<EndStop>,
    /// Part of `max_torque_nm` that is left in limp mode.
    pub limp_fraction: Option<f32>,
}

/// Largest torque by speed: linear between the points, constant outside them. Where the speed is
/// known as an interval the smallest torque anywhere in it counts; where it is NaN, the smallest of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedCap {
    /// Speeds \[m/s\], each at least 0.1 above the one before.
    pub speed_m_s: [f32; CAP_POINTS],
    /// Largest torque there \[N m\].
    pub torque_nm: [f32; CAP_POINTS],
}

impl Default for SpeedCap {
    /// 50 N m at every speed.
    fn default() -> Self {
        Self { speed_m_s: [0.0, 3.0, 6.0, 9.0], torque_nm: [50.0; CAP_POINTS] }
    }
}

/// All torque at and above `full_m_s`, none at and below `zero_m_s`, linear between: it scales the
/// wanted torque and the largest one. The lowest speed of the interval counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Speed at and below which there is no torque \[m/s\].
    pub zero_m_s: f32,
    /// Speed from which the torque is whole \[m/s\], at least 0.1 above `zero_m_s`.
    pub full_m_s: f32,
}

impl Default for Taper {
    /// Walking speed.
    fn default() -> Self {
        Self { zero_m_s: 0.5, full_m_s: 1.5 }
    }
}

/// To the right no more than `max_torque_nm + (allowance_nm + rider) multiplier`, the rider's torque
/// positive to the right; to the left the mirror's. So a rider who pushes against the assist by more
/// than the allowance shrinks it, down to zero. After comma.ai opendbc, `driver_limit_check`.
/// Without a sample it does not act: a lost sensor is a matter of the permission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiderTorque {
    /// Torque of the rider that takes nothing from the assist \[N m\].
    pub allowance_nm: f32,
    /// Torque taken from the assist by each N m beyond it.
    pub multiplier: f32,
}

impl Default for RiderTorque {
    fn default() -> Self {
        Self { allowance_nm: 7.0, multiplier: 1.0 }
    }
}

/// While the handlebar turns against the last torque faster than `steer_rate_rad_s`, time counts up, else
/// down, between zero and `after_ms + fade_ms`. Beyond `after_ms` wanted and largest torque are
/// scaled down, to zero at `after_ms + fade_ms`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiderMotion {
    /// Steer rate against the torque above which time counts \[rad/s\].
    pub steer_rate_rad_s: f32,
    /// Time that takes nothing from the assist \[ms\].
    pub after_ms: u16,
    /// Time from the whole torque to none \[ms\].
    pub fade_ms: u16,
}

impl Default for RiderMotion {
    fn default() -> Self {
        Self { steer_rate_rad_s: 1.0, after_ms: 200, fade_ms: 100 }
    }
}

/// At no time may the torque be further on either side than `nm` beyond where it was, on that side of
/// zero, at any instant of the last `ms`. After comma.ai opendbc, `rt_torque_rate_limit_check`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// How long it reaches back \[ms\].
    pub ms: u16,
    /// How far the torque may move away from zero in it \[N m\].
    pub nm: f32,
}

impl Default for Window {
    fn default() -> Self {
        Self { ms: 250, nm: 50.0 }
    }
}

/// Torque towards the stop is whole up to `soft_rad` of steer and none from `hard_rad`, linear between: it scales
/// the wanted torque and the largest one. Torque back is free. Without a sample it does not act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndStop {
    /// Steer angle, either way, up to which there is all torque \[rad\].
    pub soft_rad: f32,
    /// Steer angle from which there is none, at least 0.01 above `soft_rad` \[rad\].
    pub hard_rad: f32,
}

impl Default for EndStop {
    /// 50 and 60 degrees.
    fn default() -> Self {
        Self { soft_rad: 0.873, hard_rad: 1.047 }
    }
}

impl Limits {
    /// What is flashed. The evidence is rides on the border of the basin (`rigid_jason`, 2 to 7 m/s, either
    /// rate disturbed, `h` cut at 7.5 m/s; hands off, and with the riders `smart`, `young` and `hess`).
    ///
    /// * 7 N m: the largest torque of the published balance-assist prototype.
    /// * Rise 100 N m/s: hands off such rides rise by up to 94 N m/s under 7 N m (105 without it), fall by up to 100 (113).
    ///   Falling is the safe side: twice as fast, 35 ms from the largest torque to none.
    /// * Taper 0.5 to 1.5 m/s: walking.
    /// * End-stop 50 to 60 degrees: torque towards the side steered to is wanted up to 47 degrees; steer itself
    ///   goes to 59 degrees at 2 m/s, but there the torque already leads back.
    /// * Rider's motion 1 rad/s for 200 ms, gone 100 ms later: without anyone overriding, the steer turns against the
    ///   torque as fast for up to 132 ms hands off, 166 ms with a rider. 200 ms at 1 rad/s are 11 degrees.
    /// * Rider's torque: who pushes with more than the assist's 7 N m has won anyhow, at twice that the assist is gone.
    ///   Less would act in many border rides, where these riders push against it with 2 to 27 N m.
    /// * Window 6 N m in 50 ms: above the 5.7 N m to which 100 N m/s lead in the longest it can be, so it acts
    ///   only where the rate was not kept.
    /// * Half of it in limp mode: without the steer angle, where the end-stop can't act, half keeps two thirds of the
    ///   height that the whole would add, without a front wheel's speed nine tenths. Rides alone would allow all of
    ///   it; half is what a rider must at most hold while something is known to be wrong.
    pub fn product() -> Self {
        Self {
            max_torque_nm: Some(7.0),
            speed_cap: None,
            taper: Some(Taper { zero_m_s: 0.5, full_m_s: 1.5 }),
            rise_nm_s: Some(100.0),
            fall_nm_s: Some(200.0),
            rider_torque: Some(RiderTorque { allowance_nm: 7.0, multiplier: 1.0 }),
            rider_motion: Some(RiderMotion { steer_rate_rad_s: 1.0, after_ms: 200, fade_ms: 100 }),
            window: Some(Window { ms: 50, nm: 6.0 }),
            end_stop: Some(EndStop { soft_rad: 0.873, hard_rad: 1.047 }),
            limp_fraction: Some(0.5),
        }
    }

    /// Shows every limit.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let leaf = |name, min, max| ParamSpec::new("limits", name, min, max);
        let switch = |name| ParamSpec::switch("limits", name);
        to.optional_number(&MAX_TORQUE, &mut self.max_torque_nm);
        optional(to, &switch("speed_cap"), &mut self.speed_cap, SpeedCap::visit_params);
        optional(to, &switch("taper"), &mut self.taper, |taper, to| {
            to.number(&ParamSpec::new("limits.taper", "zero_m_s", 0.0, 9.9), &mut taper.zero_m_s);
            to.number(&ParamSpec::new("limits.taper", "full_m_s", 0.1, 10.0), &mut taper.full_m_s);
        });
        to.optional_number(&leaf("rise_nm_s", 1.0, 1e5), &mut self.rise_nm_s);
        to.optional_number(&leaf("fall_nm_s", 1.0, 1e5), &mut self.fall_nm_s);
        optional(to, &switch("rider_torque"), &mut self.rider_torque, |rider, to| {
            let leaf = |name, min, max| ParamSpec::new("limits.rider_torque", name, min, max);
            to.number(&leaf("allowance_nm", 0.0, 50.0), &mut rider.allowance_nm);
            to.number(&leaf("multiplier", 0.1, 100.0), &mut rider.multiplier);
        });
        optional(to, &switch("rider_motion"), &mut self.rider_motion, |rider, to| {
            let leaf = |name, min, max| ParamSpec::new("limits.rider_motion", name, min, max);
            to.number(&leaf("steer_rate_rad_s", 0.01, 50.0), &mut rider.steer_rate_rad_s);
            to.count(&leaf("after_ms", 0.0, 5000.0), &mut rider.after_ms);
            to.count(&leaf("fade_ms", 1.0, 5000.0), &mut rider.fade_ms);
        });
        optional(to, &switch("window"), &mut self.window, |window, to| {
            to.count(&ParamSpec::new("limits.window", "ms", 10.0, 5000.0), &mut window.ms);
            to.number(&ParamSpec::new("limits.window", "nm", 0.1, 100.0), &mut window.nm);
        });
        optional(to, &switch("end_stop"), &mut self.end_stop, |stop, to| {
            to.number(&ParamSpec::new("limits.end_stop", "soft_rad", 0.0, 3.1), &mut stop.soft_rad);
            to.number(&ParamSpec::new("limits.end_stop", "hard_rad", 0.01, 3.2), &mut stop.hard_rad);
        });
        to.optional_number(&leaf("limp_fraction", 0.0, 1.0), &mut self.limp_fraction);
    }

    /// Checks what spans several fields: points in order, and a largest torque for what is relative to it.
    ///
    /// # Errors
    /// The parameter, its value and the range that the others leave it.
    pub fn cross(&self) -> Result<(), ParamError> {
        if let Some(cap) = self.speed_cap {
            for (leaf, pair) in CAP_SPEEDS.iter().skip(1).zip(cap.speed_m_s.windows(2)) {
                if let [before, after] = *pair {
                    ParamSpec { min: before + 0.1, ..*leaf }.check(after)?;
                }
            }
        }
        if let Some(t) = self.taper {
            ParamSpec::new("limits.taper", "full_m_s", t.zero_m_s + 0.1, 10.0).check(t.full_m_s)?;
        }
        if let Some(e) = self.end_stop {
            ParamSpec::new("limits.end_stop", "hard_rad", e.soft_rad + 0.01, 3.2).check(e.hard_rad)?;
        }
        if self.rider_torque.is_some() && self.max_torque_nm.is_none() {
            return Err(MAX_TORQUE.error(f32::INFINITY));
        }
        Ok(())
    }

    /// Checks every limit that is set.
    ///
    /// # Errors
    /// The first parameter out of range, its value and the range.
    pub fn validate(&self) -> Result<(), ParamError> {
        let mut checker = Checker::default();
        let mut copy = *self;
        copy.visit_params(&mut checker);
        checker.verdict()?;
        self.cross()
    }
}

const MAX_TORQUE: ParamSpec = ParamSpec::new("limits", "max_torque_nm", 0.1, 50.0);

const CAP_SPEEDS: [ParamSpec; CAP_POINTS] = [
    ParamSpec::new("limits.speed_cap", "speed_1_m_s", 0.0, 30.0),
    ParamSpec::new("limits.speed_cap", "speed_2_m_s", 0.0, 30.0),
    ParamSpec::new("limits.speed_cap", "speed_3_m_s", 0.0, 30.0),
    ParamSpec::new("limits.speed_cap", "speed_4_m_s", 0.0, 30.0),
];

const CAP_TORQUES: [ParamSpec; CAP_POINTS] = [
    ParamSpec::new("limits.speed_cap", "torque_1_nm", 0.0, 50.0),
    ParamSpec::new("limits.speed_cap", "torque_2_nm", 0.0, 50.0),
    ParamSpec::new("limits.speed_cap", "torque_3_nm", 0.0, 50.0),
    ParamSpec::new("limits.speed_cap", "torque_4_nm", 0.0, 50.0),
];

impl SpeedCap {
    fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let speeds = CAP_SPEEDS.iter().zip(&mut self.speed_m_s);
        let torques = CAP_TORQUES.iter().zip(&mut self.torque_nm);
        for ((v, speed), (t, torque)) in speeds.zip(torques) {
            to.number(v, speed);
            to.number(t, torque);
        }
    }
}

/// Which limits changed the torque in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActiveLimits(pub u16);

impl ActiveLimits {
    /// Scaled down because the bicycle is slower than walking speed.
    pub const TAPER: Self = Self(1);
    /// Cut to the largest torque.
    pub const MAGNITUDE: Self = Self(1 << 1);
    /// Held back because it may not change faster.
    pub const RATE: Self = Self(1 << 2);
    /// Cut to the largest torque at this speed.
    pub const SPEED: Self = Self(1 << 3);
    /// Cut because the rider pushes against it.
    pub const RIDER_TORQUE: Self = Self(1 << 4);
    /// Scaled down because the handlebar is turned against it.
    pub const RIDER_MOTION: Self = Self(1 << 5);
    /// Held back because it has moved far enough in its window.
    pub const WINDOW: Self = Self(1 << 6);
    /// Scaled down towards the end-stop.
    pub const END_STOP: Self = Self(1 << 7);
    /// Cut to what is left in limp mode.
    pub const LIMP: Self = Self(1 << 8);
    /// Scaled down because the permission is not whole.
    pub const AUTHORITY: Self = Self(1 << 9);

    /// Whether every limit of `other` is in `self`.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether none acted.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Adds `other` when `acted`.
    pub const fn note(&mut self, other: Self, acted: bool) {
        if acted {
            self.0 |= other.0;
        }
    }
}
