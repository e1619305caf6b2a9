//! Evaluates a part's sweep: groups of cells, each with the area of its reference.

use super::Part;
use crate::basin::Bound;
use crate::sweep::{Axis, Grid};

/// Cells with the same reference.
pub(super) struct Group {
    /// Label of the group: "rider=smart"; empty for a single group.
    pub(super) label: String,
    /// Area of the reference \[rad m/s^2\], or its height \[rad/s\] at a single speed.
    pub(super) reference: f64,
    /// Whether the reference is exact or a bound.
    pub(super) reference_is: Bound,
    /// A line for each combination of the reference's other axes.
    pub(super) lines: Vec<Vec<Option<(f64, Bound)>>>,
}

impl Group {
    /// Value on a line relative to the reference, and whether it is exact or a bound.
    pub(super) fn part(&self, line: usize, place: usize) -> Option<(f64, Bound)> {
        let (area, bound) = self.lines[line][place]?;
        let is = Bound::of_ratio(!bound.is_measured(), !self.reference_is.is_measured());
        Some((area / self.reference, is))
    }

    /// Whether all values on a line are exact.
    pub(super) fn measured(&self, line: usize) -> bool {
        let areas = self.lines[line].iter().flatten();
        self.reference_is.is_measured() && areas.map(|a| a.1).all(Bound::is_measured)
    }
}

/// Numerical result of a part.
pub(super) struct PartResult {
    /// The axis along which the area is compared.
    pub(super) along: Axis,
    /// The reference's other axes.
    pub(super) others: Vec<Axis>,
    /// The groups.
    pub(super) groups: Vec<Group>,
    /// The compared quantity: "area", or "height" at a single speed.
    pub(super) what: &'static str,
    /// Its unit.
    pub(super) unit: &'static str,
}

/// Combinations of the values of `axes`, as key and value; the last axis varies fastest.
fn combinations(axes: &[&Axis]) -> Vec<Vec<(String, String)>> {
    axes.iter().fold(vec![Vec::new()], |all, axis| {
        let longer = |one: &Vec<(String, String)>| {
            let one = one.clone();
            axis.values.iter().map(move |v| [&one[..], &[(axis.key.clone(), v.clone())]].concat())
        };
        all.iter().flat_map(longer).collect()
    })
}

impl PartResult {
    /// The result of a finished sweep.
    pub(super) fn new(part: &Part, grid: &Grid) -> Option<Self> {
        let axes = &grid.plan.axes;
        let along = axes.iter().find(|axis| axis.key == part.along)?;
        let referred = |axis: &&Axis| part.reference.contains_key(&axis.key);
        let others: Vec<&Axis> = axes.iter().filter(referred).filter(|axis| axis.key != part.along).collect();
        let grouping: Vec<&Axis> = axes.iter().filter(|axis| !referred(axis)).collect();
        let areas = grid.measures();
        let area = |wanted: &[(String, String)]| {
            let value = |axis: &Axis| wanted.iter().find(|(key, _)| *key == axis.key).map(|(_, v)| v);
            let place = axes.iter().try_fold(0, |i, axis| {
                let value = value(axis)?;
                Some(i * axis.values.len() + axis.values.iter().position(|v| v == value)?)
            })?;
            areas[place]
        };
        let reference: Vec<(String, String)> =
            part.reference.iter().map(|(k, v)| (k.clone(), v.clone())).collect();
        let group = |of: Vec<(String, String)>| {
            let line = |rest: Vec<(String, String)>| {
                let at = |v: &String| area(&[&of[..], &rest[..], &[(along.key.clone(), v.clone())]].concat());
                along.values.iter().map(at).collect()
            };
            let label: Vec<String> = of.iter().map(|(key, value)| format!("{key} {value}")).collect();
            let (reference, reference_is) = area(&[&of[..], &reference[..]].concat())?;
            Some(Group {
                label: label.join(", "),
                reference,
                reference_is,
                lines: combinations(&others).into_iter().map(line).collect(),
            })
        };
        let groups = combinations(&grouping).into_iter().map(group).collect::<Option<_>>()?;
        let (what, unit) = if grid.one_speed() { ("height", "rad/s") } else { ("area", "rad m/s^2") };
        Some(Self { along: along.clone(), others: others.into_iter().cloned().collect(), groups, what, unit })
    }

    /// The numbers along the axis, beginning at the reference's side, with their positions and unit; `None` for an axis
    /// of names. A name among numbers, such as `none`, is left out.
    pub(super) fn numbers(&self, part: &Part) -> Option<(Vec<(usize, f64)>, String)> {
        let numeric = |(i, value): (usize, &String)| {
            let one = Axis { key: String::new(), values: vec![value.clone()] };
            one.numbers().map(|(x, unit)| (i, x[0], unit.to_owned()))
        };
        let all: Vec<_> = self.along.values.iter().enumerate().filter_map(numeric).collect();
        let unit = match &all.first()?.2 {
            none if none.is_empty() && !part.unit.is_empty() => format!(" {}", part.unit),
            unit => unit.clone(),
        };
        let mut numbers: Vec<(usize, f64)> = all.into_iter().map(|(i, x, _)| (i, x)).collect();
        if numbers.len() < 2 {
            return None;
        }
        let reference = self.along.values.iter().position(|v| *v == part.reference[&part.along])?;
        if reference > numbers[0].0 {
            numbers.reverse();
        }
        Some((numbers, unit))
    }
}
