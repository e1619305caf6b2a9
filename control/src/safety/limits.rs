//! Configuration and meaning of the torque limits. [`crate::safety::limiter`] keeps the torque inside them,
//! [`crate::safety::guard`] checks the result by independent code.
//!
//! Every limit is off (`None`) or set. Zero torque is inside every limit. Limits that depend on the motion of the
//! bicycle or the rider can shrink at once; a torque that is then outside is accepted as long as it returns to the
//! limits at `fall_nm_s`.

use crate::param::{Checker, ParamError, ParamSpec, ParamVisitor, optional};

/// Number of points of a [`SpeedCap`].
pub const CAP_POINTS: usize = 4;

/// Limits of the torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Largest torque, either way \[N m\].
    pub max_torque_nm: Option<f32>,
    /// Largest torque by speed.
    pub speed_cap: Option<SpeedCap>,
    /// Taper below walking speed.
    pub taper: Option<Taper>,
    /// Largest rate of change away from zero torque \[N m/s\].
    pub rise_nm_s: Option<f32>,
    /// Largest rate of change towards zero torque \[N m/s\]. A torque that changes sign first falls to zero, then
    /// rises. The allowed change of a step is that of the elapsed time, at most one control period.
    pub fall_nm_s: Option<f32>,
    /// Override by the rider, measured by a torque sensor.
    pub rider_torque: Option<RiderTorque>,
    /// Override by the rider, detected from the handlebar turning against the torque.
    pub rider_motion: Option<RiderMotion>,
    /// Limit over measured time, independent of the call rate.
    pub window: Option<Window>,
    /// The steer's soft end-stop.
    pub end_stop: Option<EndStop>,
    /// Fraction of `max_torque_nm` in limp mode.
    pub limp_fraction: Option<f32>,
}

/// Largest torque by speed: linear between the points, constant outside them. For a speed interval it is the smallest
/// torque in the interval; for a NaN speed the smallest of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedCap {
    /// Speeds \[m/s\], each at least 0.1 above the previous one.
    pub speed_m_s: [f32; CAP_POINTS],
    /// Largest torque at each speed \[N m\].
    pub torque_nm: [f32; CAP_POINTS],
}

impl Default for SpeedCap {
    /// 50 N m at every speed.
    fn default() -> Self {
        Self { speed_m_s: [0.0, 3.0, 6.0, 9.0], torque_nm: [50.0; CAP_POINTS] }
    }
}

/// Scales the requested and the largest torque: factor 1 at and above `full_m_s`, 0 at and below `zero_m_s`, linear
/// between. The lowest speed of the interval is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Speed at and below which there is no torque \[m/s\].
    pub zero_m_s: f32,
    /// Speed from which the torque is not reduced \[m/s\], at least 0.1 above `zero_m_s`.
    pub full_m_s: f32,
}

impl Default for Taper {
    /// Walking speed.
    fn default() -> Self {
        Self { zero_m_s: 0.5, full_m_s: 1.5 }
    }
}

/// Limits the torque to the right to `max_torque_nm + (allowance_nm + rider) multiplier`, with the rider's torque
/// positive to the right, and to the left symmetrically. A rider who pushes against the assist by more than the
/// allowance reduces it, down to zero. After comma.ai opendbc, `driver_limit_check`. Without a valid sample the limit
/// is off: a lost sensor is handled by the permission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiderTorque {
    /// Rider's torque that does not reduce the assist \[N m\].
    pub allowance_nm: f32,
    /// Reduction of the assist per N m beyond the allowance.
    pub multiplier: f32,
}

impl Default for RiderTorque {
    fn default() -> Self {
        Self { allowance_nm: 7.0, multiplier: 1.0 }
    }
}

/// A timer counts up while the handlebar turns against the last torque faster than `steer_rate_rad_s`, down otherwise,
/// between zero and `after_ms + fade_ms`. Beyond `after_ms` the requested and the largest torque are scaled down, to
/// zero at `after_ms + fade_ms`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiderMotion {
    /// Steer rate against the torque above which the timer counts up \[rad/s\].
    pub steer_rate_rad_s: f32,
    /// Time before the torque is reduced \[ms\].
    pub after_ms: u16,
    /// Time from full torque to none \[ms\].
    pub fade_ms: u16,
}

impl Default for RiderMotion {
    fn default() -> Self {
        Self { steer_rate_rad_s: 1.0, after_ms: 200, fade_ms: 100 }
    }
}

/// Limits the torque on either side of zero to `nm` beyond its smallest value on that side within the last `ms`. After
/// comma.ai opendbc, `rt_torque_rate_limit_check`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Length of the window \[ms\].
    pub ms: u16,
    /// Largest change of the torque away from zero within the window \[N m\].
    pub nm: f32,
}

impl Default for Window {
    fn default() -> Self {
        Self { ms: 250, nm: 50.0 }
    }
}

/// Scales the requested and the largest torque towards the stop: factor 1 up to `soft_rad` of steer angle, 0 from
/// `hard_rad`, linear between. Torque away from the stop is not limited. Without a valid sample the limit is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndStop {
    /// Steer angle, either way, up to which the torque is not reduced \[rad\].
    pub soft_rad: f32,
    /// Steer angle from which there is no torque, at least 0.01 above `soft_rad` \[rad\].
    pub hard_rad: f32,
}

impl Default for EndStop {
    /// 50 and 60 degrees.
    fn default() -> Self {
        Self { soft_rad: 0.873, hard_rad: 1.047 }
    }
}

impl Limits {
    /// Limits as flashed. Their source is rides on the border of the basin (`rigid_jason`, 2 to 7 m/s, either rate
    /// disturbed, `h` cut at 7.5 m/s; hands off, and with the riders `smart`, `young` and `hess`).
    ///
    /// * 7 N m: the largest torque of the published balance-assist prototype.
    /// * Rise 100 N m/s: hands off, these rides rise by up to 94 N m/s with the 7 N m limit (105 without it) and fall
    ///   by up to 100 (113). Falling is the safe direction: twice as fast, 35 ms from the largest torque to none.
    /// * Taper 0.5 to 1.5 m/s: walking.
    /// * End-stop 50 to 60 degrees: torque towards the steered side is requested up to 47 degrees. The steer angle
    ///   reaches 59 degrees at 2 m/s, where the torque already points back.
    /// * Rider's motion 1 rad/s for 200 ms, none 100 ms later: without an override the handlebar turns against the
    ///   torque at this rate for up to 132 ms hands off, 166 ms with a rider. 200 ms at 1 rad/s are 11 degrees.
    /// * Rider's torque: a rider who pushes with more than the assist's 7 N m prevails in any case; at twice that the
    ///   assist is zero. A smaller allowance would act in many border rides, where these riders push against the assist
    ///   with 2 to 27 N m.
    /// * Window 6 N m in 50 ms: above the 5.7 N m that 100 N m/s reach within the longest effective window, so it acts
    ///   only if the rate limit has failed.
    /// * Limp mode, half the torque: without the steer angle, where the end-stop cannot act, half the torque retains
    ///   two thirds of the basin height that full torque would add; without a front wheel's speed, nine tenths. The
    ///   rides alone would allow full torque; half is the most that a rider should have to counteract during a known
    ///   fault.
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

    /// Visits every limit.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let spec = |name, min, max| ParamSpec::new("limits", name, min, max);
        let switch = |name| ParamSpec::switch("limits", name);
        to.optional_number(&MAX_TORQUE, &mut self.max_torque_nm);
        optional(to, &switch("speed_cap"), &mut self.speed_cap, SpeedCap::visit_params);
        optional(to, &switch("taper"), &mut self.taper, |taper, to| {
            to.number(&ParamSpec::new("limits.taper", "zero_m_s", 0.0, 9.9), &mut taper.zero_m_s);
            to.number(&ParamSpec::new("limits.taper", "full_m_s", 0.1, 10.0), &mut taper.full_m_s);
        });
        to.optional_number(&spec("rise_nm_s", 1.0, 1e5), &mut self.rise_nm_s);
        to.optional_number(&spec("fall_nm_s", 1.0, 1e5), &mut self.fall_nm_s);
        optional(to, &switch("rider_torque"), &mut self.rider_torque, |rider, to| {
            let spec = |name, min, max| ParamSpec::new("limits.rider_torque", name, min, max);
            to.number(&spec("allowance_nm", 0.0, 50.0), &mut rider.allowance_nm);
            to.number(&spec("multiplier", 0.1, 100.0), &mut rider.multiplier);
        });
        optional(to, &switch("rider_motion"), &mut self.rider_motion, |rider, to| {
            let spec = |name, min, max| ParamSpec::new("limits.rider_motion", name, min, max);
            to.number(&spec("steer_rate_rad_s", 0.01, 50.0), &mut rider.steer_rate_rad_s);
            to.count(&spec("after_ms", 0.0, 5000.0), &mut rider.after_ms);
            to.count(&spec("fade_ms", 1.0, 5000.0), &mut rider.fade_ms);
        });
        optional(to, &switch("window"), &mut self.window, |window, to| {
            to.count(&ParamSpec::new("limits.window", "ms", 10.0, 5000.0), &mut window.ms);
            to.number(&ParamSpec::new("limits.window", "nm", 0.1, 100.0), &mut window.nm);
        });
        optional(to, &switch("end_stop"), &mut self.end_stop, |stop, to| {
            to.number(&ParamSpec::new("limits.end_stop", "soft_rad", 0.0, 3.1), &mut stop.soft_rad);
            to.number(&ParamSpec::new("limits.end_stop", "hard_rad", 0.01, 3.2), &mut stop.hard_rad);
        });
        to.optional_number(&spec("limp_fraction", 0.0, 1.0), &mut self.limp_fraction);
    }

    /// Checks relations between fields: points in order, and a largest torque where another limit needs it.
    ///
    /// # Errors
    /// The parameter, its value and the range allowed by the others.
    pub fn cross(&self) -> Result<(), ParamError> {
        if let Some(cap) = self.speed_cap {
            for (spec, pair) in CAP_SPEEDS.iter().skip(1).zip(cap.speed_m_s.windows(2)) {
                if let [before, after] = *pair {
                    ParamSpec { min: before + 0.1, ..*spec }.check(after)?;
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

/// Set of the limits that changed the torque in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct ActiveLimits(pub u16);

impl ActiveLimits {
    /// Scaled down below walking speed.
    pub const TAPER: Self = Self(1);
    /// Limited to the largest torque.
    pub const MAGNITUDE: Self = Self(1 << 1);
    /// Limited by the rate of change.
    pub const RATE: Self = Self(1 << 2);
    /// Limited to the largest torque at this speed.
    pub const SPEED: Self = Self(1 << 3);
    /// Limited because the rider pushes against the assist.
    pub const RIDER_TORQUE: Self = Self(1 << 4);
    /// Scaled down because the handlebar turns against the torque.
    pub const RIDER_MOTION: Self = Self(1 << 5);
    /// Limited by the change within the window.
    pub const WINDOW: Self = Self(1 << 6);
    /// Scaled down towards the end-stop.
    pub const END_STOP: Self = Self(1 << 7);
    /// Limited to the largest torque of limp mode.
    pub const LIMP: Self = Self(1 << 8);
    /// Scaled down by an authority below 1.
    pub const AUTHORITY: Self = Self(1 << 9);

    /// Whether `self` contains every limit of `other`.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether no limit was active.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Adds `other` when `active`.
    pub const fn note(&mut self, other: Self, active: bool) {
        if active {
            self.0 |= other.0;
        }
    }
}

/// A limit of [`ActiveLimits`] with its name and its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedLimit {
    /// The limit.
    pub limit: ActiveLimits,
    /// Name in messages, tables and documents.
    pub name: &'static str,
    /// Meaning, in one sentence.
    pub meaning: &'static str,
}

impl NamedLimit {
    const fn new(limit: ActiveLimits, name: &'static str, meaning: &'static str) -> Self {
        Self { limit, name, meaning }
    }
}

/// Every limit, in the order of the bits.
pub const LIMITS: [NamedLimit; 10] = [
    NamedLimit::new(ActiveLimits::TAPER, "taper", "Torque scaled down below walking speed."),
    NamedLimit::new(ActiveLimits::MAGNITUDE, "torque", "Torque limited to the largest one."),
    NamedLimit::new(ActiveLimits::RATE, "rate", "Torque limited by its rate of change."),
    NamedLimit::new(ActiveLimits::SPEED, "speed", "Torque limited to the largest one at this speed."),
    NamedLimit::new(
        ActiveLimits::RIDER_TORQUE,
        "rider torque",
        "Torque limited because the rider pushes against the assist.",
    ),
    NamedLimit::new(
        ActiveLimits::RIDER_MOTION,
        "rider motion",
        "Torque scaled down because the handlebar turns against it.",
    ),
    NamedLimit::new(ActiveLimits::WINDOW, "window", "Torque limited by its change within the window."),
    NamedLimit::new(ActiveLimits::END_STOP, "end-stop", "Torque scaled down towards the end-stop."),
    NamedLimit::new(ActiveLimits::LIMP, "limp", "Torque limited to the largest one of limp mode."),
    NamedLimit::new(ActiveLimits::AUTHORITY, "authority", "Torque scaled down by an authority below 1."),
];
