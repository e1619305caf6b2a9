//! Units as an FMU has them: a name in Modelica's form, and the exponents of SI base units.

/// A unit.
#[derive(Debug)]
pub(super) struct Unit {
    /// As in the variables' tables.
    pub(super) ours: &'static str,
    /// Name in the FMU.
    pub(super) name: &'static str,
    /// Base units and their exponents.
    pub(super) base: &'static [(&'static str, i8)],
    /// Value of one in base units, if not 1.
    pub(super) factor: Option<&'static str>,
}

const fn unit(ours: &'static str, name: &'static str, base: &'static [(&'static str, i8)]) -> Unit {
    Unit { ours, name, base, factor: None }
}

const UNITS: [Unit; 20] = [
    unit("s", "s", &[("s", 1)]),
    Unit { factor: Some("0.001"), ..unit("ms", "ms", &[("s", 1)]) },
    unit("Hz", "Hz", &[("s", -1)]),
    unit("m", "m", &[("m", 1)]),
    unit("m/s", "m/s", &[("m", 1), ("s", -1)]),
    unit("m/s^2", "m/s2", &[("m", 1), ("s", -2)]),
    unit("rad", "rad", &[("rad", 1)]),
    unit("rad/s", "rad/s", &[("s", -1), ("rad", 1)]),
    unit("rad/s^2", "rad/s2", &[("s", -2), ("rad", 1)]),
    unit("kg", "kg", &[("kg", 1)]),
    unit("kg m^2", "kg.m2", &[("kg", 1), ("m", 2)]),
    unit("N", "N", &[("kg", 1), ("m", 1), ("s", -2)]),
    unit("N m", "N.m", &[("kg", 1), ("m", 2), ("s", -2)]),
    unit("N m/s", "N.m/s", &[("kg", 1), ("m", 2), ("s", -3)]),
    unit("N m s/rad", "N.m.s/rad", &[("kg", 1), ("m", 2), ("s", -1), ("rad", -1)]),
    unit("N m/rad", "N.m/rad", &[("kg", 1), ("m", 2), ("s", -2), ("rad", -1)]),
    unit("N m/m", "N.m/m", &[("kg", 1), ("m", 1), ("s", -2)]),
    unit("N m/(m s)", "N.m/(m.s)", &[("kg", 1), ("m", 1), ("s", -3)]),
    unit("N s^2/rad", "N.s2/rad", &[("kg", 1), ("m", 1), ("rad", -1)]),
    unit("/(N m)", "1/(N.m)", &[("kg", -1), ("m", -2), ("s", 2)]),
];

/// The unit of a variable; `None` for a number without one, and for a unit that follows that of a sensor.
pub(super) fn of(ours: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.ours == ours)
}
