//! The units allowed in a map, each with its factor to SI.

use super::map_error::UnitError;

/// Physical quantity of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// \[s\]
    Time,
    /// \[rad\]
    Angle,
    /// \[rad/s\]
    Rate,
    /// \[m/s^2\]
    SpecificForce,
    /// \[N\]
    Force,
    /// \[m/s\]
    Speed,
    /// \[N m\]
    Torque,
    /// \[m\]
    Length,
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Standard gravity, by definition \[m/s^2\].
const GRAVITY: f64 = 9.806_65;

impl Quantity {
    /// The units allowed for the quantity; the first is the default.
    const fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Time => &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)],
            Self::Angle => &[("rad", 1.0), ("deg", DEGREE)],
            Self::Rate => &[("rad/s", 1.0), ("deg/s", DEGREE)],
            Self::SpecificForce => &[("m/s^2", 1.0), ("g", GRAVITY)],
            Self::Force => &[("N", 1.0), ("kN", 1e3), ("kgf", GRAVITY), ("lbf", 4.448_221_615_260_5)],
            Self::Speed => &[("m/s", 1.0), ("km/h", 1.0 / 3.6)],
            Self::Torque => &[("N m", 1.0)],
            Self::Length => &[("m", 1.0), ("km", 1e3)],
        }
    }

    /// The factor from a unit to SI; 1 without a unit.
    ///
    /// # Errors
    /// An unknown unit, with the allowed ones.
    pub(super) fn factor(self, unit: Option<&str>) -> Result<f64, UnitError> {
        let Some(unit) = unit else { return Ok(1.0) };
        let found = self.units().iter().find(|(name, _)| *name == unit);
        found.map(|(_, factor)| *factor).ok_or_else(|| {
            let names: Vec<_> = self.units().iter().map(|(name, _)| *name).collect();
            UnitError { unit: unit.into(), known: names.join(", ") }
        })
    }

    /// A magnitude that fewer than one sample in twenty of a ride in SI units exceeds, and the unit suspected
    /// otherwise: a fork turns by hardly more than a quarter of a turn; 5 rad/s and 43 km/h are reached only in a fall
    /// or on a long descent.
    pub(super) const fn implausible(self) -> Option<(f64, &'static str)> {
        match self {
            Self::Angle => Some((2.0, "degrees")),
            Self::Rate => Some((5.0, "degrees a second")),
            Self::Speed => Some((12.0, "km/h")),
            _ => None,
        }
    }
}
