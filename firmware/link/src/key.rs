//! A parameter's name: its group and its own name, a dot between them.

use crate::frame::CRC;
use control::param::ParamSpec;
use core::fmt;

/// A parameter's name in two parts, so that no memory is needed to put them together. Keys are equal
/// when they read the same, wherever they are parted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Key<'a> {
    /// The group, dotted; empty for none.
    pub group: &'a str,
    /// Its own name; a key that came over the link is here as a whole.
    pub name: &'a str,
}

impl<'a> Key<'a> {
    /// The key of a parameter.
    pub const fn of(leaf: &ParamSpec) -> Key<'static> {
        Key { group: leaf.group, name: leaf.name }
    }

    /// A key that is written out.
    pub const fn whole(name: &'a str) -> Self {
        Key { group: "", name }
    }

    /// What is read one after the other.
    pub fn parts(self) -> impl Iterator<Item = &'a str> + Clone {
        let dot = if self.group.is_empty() { "" } else { "." };
        [self.group, dot, self.name].into_iter()
    }

    /// The number it has in the store: the CRC-32 of what it reads. It never changes as long as the name
    /// does not; a test holds that no two parameters share one.
    pub fn hash(self) -> u32 {
        let mut digest = CRC.digest();
        self.parts().for_each(|part| digest.update(part.as_bytes()));
        digest.finalize()
    }

    /// The unit its name ends with; empty for a plain number, or one whose unit is that of its sensor. One that begins
    /// with a stroke is per that, of whatever the sensor measures.
    pub fn unit(self) -> &'static str {
        let ends = |suffix: &str| {
            let before = self.name.strip_suffix(suffix);
            before.is_some_and(|before| before.is_empty() || before.ends_with(['_', '.']))
        };
        UNITS.iter().find(|(suffix, _)| ends(suffix)).map_or("", |(_, unit)| unit)
    }
}

/// The endings of names and their units, the longer before the shorter.
const UNITS: &[(&str, &str)] = &[
    ("per_nm", "/(N m)"),
    ("per_s", "/s"),
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
