//! NetCDF file of a sweep: its dimensions are the axes and the speed.

use super::document::SweepDocument;
use super::names::variable;
use super::{Axis, Found, Grid, Unit};
use crate::report::netcdf::{BOUND, File, Values, Variable, border_flags, effort_numbers, switch_flags};

/// The file of a sweep without missing cells. Axes of numbers rise,
/// whatever their order in the plan: coordinates must be monotonic.
pub(super) fn netcdf(grid: &Grid, document: &SweepDocument) -> File {
    let axes = &grid.plan.axes;
    let names: Vec<String> = axes.iter().map(variable).collect();
    let all: Vec<String> = names.iter().cloned().chain(["speed".into()]).collect();
    let orders: Vec<Vec<usize>> = axes.iter().map(order).collect();
    let units: Vec<&Unit> = cells(&orders).into_iter().filter_map(|i| grid.units[i].as_ref()).collect();
    let found = || units.iter().flat_map(|unit| &unit.found);
    let heights = found().map(|f| f.height).collect();
    let mut variables: Vec<Variable> = axes
        .iter()
        .zip(&names)
        .zip(&orders)
        .map(|((axis, name), order)| coordinate(axis, name, order))
        .collect();
    let speeds = grid.plan.search.speeds.clone();
    variables.extend([
        Variable::numbers(("speed", "m s-1", "forward speed"), &["speed"], speeds),
        Variable::numbers(("height", "rad s-1", "largest disturbance not to fall"), &all, heights),
    ]);
    let falls = found().map(|f: &Found| f.fall.as_deref());
    variables.extend(border_flags("height", &all, found().map(|f| f.capped), falls));
    variables.extend(effort_numbers(&all, found().map(|f| f.effort)));
    let areas = units.iter().map(|unit| grid.area(unit).unwrap_or(f64::NAN)).collect();
    let means = units.iter().map(|unit| unit.mean_height()).collect();
    variables.extend([
        Variable::numbers(
            ("area", "rad m s-2", "area under height; missing at a single speed"),
            &names,
            areas,
        ),
        Variable::numbers(("mean_height", "rad s-1", "mean of height over the speeds"), &names, means),
        Variable::new(
            ("area_capped", "whether area and mean_height are lower bounds"),
            &names,
            switch_flags(BOUND, units.iter().map(|unit| unit.capped())),
        ),
    ]);
    File {
        title: "Basins of attraction over a grid of conditions".into(),
        tool: grid.plan.tool.clone(),
        attributes: vec![("configuration", document.heading().to_string())],
        variables,
    }
}

/// The axis as the coordinate of its dimension, its values in `order`.
fn coordinate(axis: &Axis, name: &str, order: &[usize]) -> Variable {
    let values = match axis.numbers() {
        Some((numbers, _)) => {
            let unit = axis.unit().map_or("1", |unit| unit.netcdf);
            Values::Numbers(unit.into(), order.iter().map(|&i| numbers[i]).collect())
        }
        None => Values::Texts(order.iter().map(|&i| axis.values[i].clone()).collect()),
    };
    Variable::new((name, &axis.about()), &[name], values)
}

/// Indices of the axis's values: numbers rising, texts as given.
fn order(axis: &Axis) -> Vec<usize> {
    let mut order: Vec<usize> = (0..axis.values.len()).collect();
    if let Some((numbers, _)) = axis.numbers() {
        order.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
    }
    order
}

/// Indices of the plan's cells, the axes' values in these orders, the last axis fastest.
fn cells(orders: &[Vec<usize>]) -> Vec<usize> {
    orders.iter().fold(vec![0], |outer, order| {
        outer.iter().flat_map(|cell| order.iter().map(move |value| cell * order.len() + value)).collect()
    })
}
