//! Units of numbers by the end of their key or name.

/// Ends of names, and the units in the form of UDUNITS. An end that is part of a longer one comes after it.
const UNITS: [(&str, &str); 12] = [
    ("nm_s_rad", "N m s rad-1"),
    ("kg_m2", "kg m2"),
    ("rad_s", "rad s-1"),
    ("nm_s", "N m s-1"),
    ("m_s", "m s-1"),
    ("1_s", "s-1"),
    ("rad", "rad"),
    ("nm", "N m"),
    ("kg", "kg"),
    ("m", "m"),
    ("s", "s"),
    ("j", "J"),
];

/// The unit of a number called `name`, as the end of the name and in the form of UDUNITS: `nm` and `N m` of
/// `torque_limit_nm`; `None` of a name without a unit.
pub fn unit_of(name: &str) -> Option<(&'static str, &'static str)> {
    let ends = |end: &str| name.strip_suffix(end).is_some_and(|start| start.ends_with('_'));
    UNITS.into_iter().find(|(end, _)| ends(end))
}
