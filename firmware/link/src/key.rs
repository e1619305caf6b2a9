//! Parameter keys: group and name, joined by a dot.

use crate::frame::CRC;
use control::param::ParamSpec;
use core::fmt;

/// A parameter's key in two parts, so that joining them needs no memory. Keys are equal if their joined text is equal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Key<'a> {
    /// The group, dotted; empty for none.
    pub group: &'a str,
    /// Name within the group; a key received over the link is stored here whole.
    pub name: &'a str,
}

impl<'a> Key<'a> {
    /// The key of a parameter.
    pub const fn of(leaf: &ParamSpec) -> Key<'static> {
        Key { group: leaf.group, name: leaf.name }
    }

    /// A key given as one text.
    pub const fn whole(name: &'a str) -> Self {
        Key { group: "", name }
    }

    /// The parts of the joined text.
    pub fn parts(self) -> impl Iterator<Item = &'a str> + Clone {
        let dot = if self.group.is_empty() { "" } else { "." };
        [self.group, dot, self.name].into_iter()
    }

    /// Identifier in the store: the CRC-32 of the joined text. It changes only with the name; a test checks that it
    /// is unique.
    pub fn hash(self) -> u32 {
        let mut digest = CRC.digest();
        self.parts().for_each(|part| digest.update(part.as_bytes()));
        digest.finalize()
    }

    /// Unit, from the suffix of the name. Empty for a dimensionless number, or if the unit is that of the sensor. A
    /// unit that begins with `/` follows the unit of the measured quantity.
    pub fn unit(self) -> &'static str {
        let ends = |suffix: &str| {
            let before = self.name.strip_suffix(suffix);
            before.is_some_and(|before| before.is_empty() || before.ends_with(['_', '.']))
        };
        UNITS.iter().find(|(suffix, _)| ends(suffix)).map_or("", |(_, unit)| unit)
    }
}

/// Suffixes of names and their units, longer ones first.
const UNITS: &[(&str, &str)] = &[
    ("per_nm", "/(N m)"),
    ("per_s", "/s"),
    ("nm_s_rad", "N m s/rad"),
    ("nm_rad", "N m/rad"),
    ("nm_m_s", "N m/(m s)"),
    ("nm_m", "N m/m"),
    ("rad_s", "rad/s"),
    ("nm_s", "N m/s"),
    ("m_s2", "m/s^2"),
    ("m_s", "m/s"),
    ("ticks", "control periods"),
    ("samples", "samples"),
    ("rad", "rad"),
    ("nm", "N m"),
    ("hz", "Hz"),
    ("ms", "ms"),
    ("m", "m"),
    ("s", "s"),
];

impl PartialEq for Key<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.parts().flat_map(str::bytes).eq(other.parts().flat_map(str::bytes))
    }
}

impl fmt::Display for Key<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.parts().try_for_each(|part| f.write_str(part))
    }
}
