//! Shapes the wanted torque into one that may be asked of the motor: a taper to zero below walking
//! speed, a magnitude and a rate. Each is off (`None`) or set; the output says which were active.

use crate::param::{Leaf, ParamError, Visit, optional};

/// Which limits changed the torque in this step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits(pub u8);

impl Limits {
    /// The torque was scaled down because the bicycle is slower than walking speed.
    pub const TAPER: Limits = Limits(1);
    /// The torque was cut to the largest allowed.
    pub const MAGNITUDE: Limits = Limits(2);
    /// The torque was held back because it may not change faster.
    pub const RATE: Limits = Limits(4);

    /// Whether every limit of `other` is in `self`.
    pub const fn contains(self, other: Limits) -> bool {
        self.0 & other.0 == other.0
    }
    /// Adds `other` when `active`.
    fn set(&mut self, other: Limits, active: bool) {
        if active {
            self.0 |= other.0;
        }
    }
}

/// Full assist at and above `full_m_s`, none at and below `zero_m_s`, linear between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Speed at and below which the torque is zero \[m/s\], 0..=10.
    pub zero_m_s: f32,
    /// Speed from which the torque is whole \[m/s\], above `zero_m_s`, up to 10.
    pub full_m_s: f32,
}

impl Default for Taper {
    /// From 0.5 to 1.5 m/s.
    fn default() -> Self {
        Self { zero_m_s: 0.5, full_m_s: 1.5 }
    }
}

impl Taper {
    fn scale(&self, speed_m_s: f32) -> f32 {
        if speed_m_s >= self.full_m_s {
            1.0
        } else if speed_m_s <= self.zero_m_s {
            0.0
        } else {
            (speed_m_s - self.zero_m_s) / (self.full_m_s - self.zero_m_s)
        }
    }
}

/// The limits on the torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeConfig {
    /// Largest torque, either way \[N m\], 0.1..=50; `None` is no limit.
    pub max_torque_nm: Option<f32>,
    /// Largest change of torque, either way \[N m/s\], 1..=1e5; `None` is no limit.
    pub max_rate_nm_s: Option<f32>,
    /// Taper below walking speed; `None` is none.
    pub taper: Option<Taper>,
}

impl ShapeConfig {
    /// Shows every parameter.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        to.limit(&Leaf::new("shape", "max_torque_nm", 0.1, 50.0), &mut self.max_torque_nm);
        to.limit(&Leaf::new("shape", "max_rate_nm_s", 1.0, 1e5), &mut self.max_rate_nm_s);
        optional(to, &Leaf::switch("shape", "taper"), &mut self.taper, |taper, to| {
            to.number(&Leaf::new("shape.taper", "zero_m_s", 0.0, 9.9), &mut taper.zero_m_s);
            to.number(&Leaf::new("shape.taper", "full_m_s", 0.1, 10.0), &mut taper.full_m_s);
        });
    }

    /// Checks what spans several parameters.
    ///
    /// # Errors
    /// The parameter, its value and the allowed range.
    pub fn validate(&self) -> Result<(), ParamError> {
        self.taper.map_or(Ok(()), |t| {
            Leaf::new("shape.taper", "full_m_s", t.zero_m_s + 0.1, 10.0).check(t.full_m_s)
        })
    }
}

/// The wanted torque shaped, and the limits that acted.
///
/// `wanted_nm` must be finite; `previous_nm` is the last output; `max_change_nm` is the largest
/// change in one period (`f32::MAX` for none). The output never exceeds the magnitude if `previous_nm` did not, is finite,
/// and mirrors: both torques' signs flipped flip the output's.
pub fn shape(
    config: &ShapeConfig,
    max_change_nm: f32,
    previous_nm: f32,
    speed_m_s: f32,
    wanted_nm: f32,
) -> (f32, Limits) {
    let mut limits = Limits::default();
    let mut torque = wanted_nm;
    if let Some(taper) = &config.taper {
        let scale = taper.scale(speed_m_s);
        limits.set(Limits::TAPER, scale < 1.0 && torque != 0.0);
        torque *= scale;
    }
    if let Some(max) = config.max_torque_nm {
        limits.set(Limits::MAGNITUDE, torque > max || torque < -max);
        torque = between(torque, -max, max);
    }
    if config.max_rate_nm_s.is_some() {
        let (low, high) = (previous_nm - max_change_nm, previous_nm + max_change_nm);
        limits.set(Limits::RATE, torque < low || torque > high);
        torque = between(torque, low, high);
    }
    (torque, limits)
}

/// `f32::clamp` without its panic on disordered bounds.
fn between(x: f32, low: f32, high: f32) -> f32 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}
