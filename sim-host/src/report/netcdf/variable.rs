//! A variable of a NetCDF file: names, dimensions, values.

use crate::basin::ScanPoint;
use crate::ride::{Effort, FallCause, Outcome};

/// A variable with its description.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name: letters, digits and underscores.
    pub name: String,
    /// What it is, in a phrase.
    pub long_name: String,
    /// Names of its dimensions, the slowest first; none for a single value.
    pub dims: Vec<String>,
    /// The values, the last dimension varying fastest.
    pub values: Values,
}

/// Values of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers in a unit of UDUNITS; NaN is missing.
    Numbers(String, Vec<f64>),
    /// One of several categories: their names, without blanks, and per value the index of one of them.
    Flags(Vec<String>, Vec<u8>),
    /// Texts.
    Texts(Vec<String>),
}

impl Values {
    /// Number of values.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Numbers(_, values) => values.len(),
            Self::Flags(_, values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }
}

impl Variable {
    /// A variable of numbers in `units`.
    pub fn numbers<D: AsRef<str>>(
        (name, units, long_name): (&str, &str, &str),
        dims: &[D],
        values: Vec<f64>,
    ) -> Self {
        Self::new((name, long_name), dims, Values::Numbers(units.into(), values))
    }

    /// A variable.
    pub fn new<D: AsRef<str>>((name, long_name): (&str, &str), dims: &[D], values: Values) -> Self {
        let dims = dims.iter().map(|dim| dim.as_ref().to_owned()).collect();
        Self { name: name.into(), long_name: long_name.into(), dims, values }
    }

    /// Whether it is the coordinate of its dimension.
    pub(super) fn is_coordinate(&self) -> bool {
        self.dims == [self.name.as_str()]
    }
}

/// Flags of two states, the first if false.
pub fn switch_flags(states: [&str; 2], values: impl IntoIterator<Item = bool>) -> Values {
    Values::Flags(states.map(str::to_owned).to_vec(), values.into_iter().map(u8::from).collect())
}

/// Flags of falls by their names: 0 is none.
pub fn fall_flags<'a>(falls: impl IntoIterator<Item = Option<&'a str>>) -> Values {
    named_flags(
        &[&["none"][..], &FallCause::ALL.map(FallCause::name)].concat(),
        falls.into_iter().map(|f| f.unwrap_or("none")),
    )
}

/// About borders called `border`, over `dims`: whether each is a lower bound, and why the ride next beyond it counts as fallen.
pub fn border_flags<'a, D: AsRef<str>>(
    border: &str,
    dims: &[D],
    capped: impl IntoIterator<Item = bool>,
    falls: impl IntoIterator<Item = Option<&'a str>>,
) -> [Variable; 2] {
    let bound = format!("whether nothing fell, so that {border} is a lower bound");
    let reason = format!("reason for which the ride next beyond {border} counts as fallen");
    [
        Variable::new(("capped", &bound), dims, switch_flags(BOUND, capped)),
        Variable::new(("fall_cause", &reason), dims, fall_flags(falls)),
    ]
}

/// States of a border that may be a lower bound.
pub const BOUND: [&str; 2] = ["measured", "lower_bound"];

/// Outcome and time of the fall of the rides of a scan, over `dims`.
pub(super) fn scan_outcomes<'a, D: AsRef<str>>(
    dims: &[D],
    scan: impl Iterator<Item = &'a ScanPoint> + Clone,
) -> [Variable; 2] {
    let times = scan.clone().map(|p| p.outcome.time_to_fall_s().unwrap_or(f64::NAN)).collect();
    [
        Variable::new(
            ("outcome", "outcome of each ride of the scan"),
            dims,
            outcome_flags(scan.map(|p| p.outcome)),
        ),
        Variable::numbers(
            ("time_to_fall", "s", "time of the fall since the disturbance; missing without a fall"),
            dims,
            times,
        ),
    ]
}

/// Flags of outcomes.
pub(super) fn outcome_flags(outcomes: impl IntoIterator<Item = Outcome>) -> Values {
    named_flags(&["fallen", "recovered", "undecided"], outcomes.into_iter().map(|outcome| outcome.name()))
}

/// A number of an effort: its name, unit, meaning and value.
type EffortNumber = (&'static str, &'static str, &'static str, fn(&Effort) -> f64);

const EFFORTS: [EffortNumber; 3] = [
    ("peak_torque", "N m", "largest torque of the border ride", |e| e.peak_torque_nm),
    ("rms_torque", "N m", "root mean square torque of the border ride", |e| e.rms_torque_nm),
    ("peak_slew", "N m s-1", "largest change of torque of the border ride", |e| e.peak_slew_nm_s),
];

/// The torques of rides at the border, over `dims`; missing where there is none.
pub fn effort_numbers<D: AsRef<str>>(
    dims: &[D],
    efforts: impl Iterator<Item = Option<Effort>> + Clone,
) -> Vec<Variable> {
    let number = |&(name, units, long_name, of): &EffortNumber| {
        let values = efforts.clone().map(|effort| effort.as_ref().map_or(f64::NAN, of)).collect();
        Variable::numbers((name, units, long_name), dims, values)
    };
    EFFORTS.iter().map(number).collect()
}

/// Flags of `names`; a name that is not among them counts as the first.
fn named_flags<'a>(names: &[&str], values: impl Iterator<Item = &'a str>) -> Values {
    let index = |value| names.iter().position(|name| *name == value).unwrap_or_default() as u8;
    Values::Flags(names.iter().map(|name| (*name).to_owned()).collect(), values.map(index).collect())
}
