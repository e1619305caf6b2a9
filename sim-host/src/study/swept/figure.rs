//! Figures of a sweep study.

use super::Part;
use super::part_result::{Group, PartResult};
use super::threshold::LEAST;
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Picture, Plot, Series, chart};
use crate::sweep::{AT_LEAST, Grid, pictures};

/// The figures of a part's sweep with their names: along a numeric axis a line for every group; over several axes heat
/// maps; along an axis of names the heights over speed.
pub fn figures(part: &Part, grid: &Grid) -> Vec<(String, Picture)> {
    let Some(result) = PartResult::new(part, grid) else { return Vec::new() };
    match (result.numbers(part), &result.others[..]) {
        (Some((numbers, unit)), []) => vec![(part.name.clone(), lines(part, &result, &numbers, &unit))],
        (Some(_), _) => {
            let named = |(name, picture)| (format!("{}-{name}", part.name), picture);
            let wanted = |(name, _): &(String, Picture)| {
                part.reference.keys().filter(|k| name.contains(*k)).count() > 1
            };
            pictures(grid).into_iter().filter(wanted).map(named).collect()
        }
        (None, _) => vec![(part.name.clone(), heights(part, grid))],
    }
}

/// The fraction of the area over the axis.
fn lines(part: &Part, result: &PartResult, numbers: &[(usize, f64)], unit: &str) -> Picture {
    let look = |i| Look { marker: Some(Marker::Point), ..Look::line(i, Line::Solid) };
    let mut series: Vec<Series> = result
        .groups
        .iter()
        .enumerate()
        .map(|(i, group)| {
            let at = |&(place, x): &(usize, f64)| Some((x, group.part(0, place)?.0));
            Series::new(group.label.clone(), look(i), numbers.iter().filter_map(at).collect())
        })
        .collect();
    let parts = |group: &Group| {
        let at = |&(place, x): &(usize, f64)| group.part(0, place).map(|(part, bound)| (x, part, bound));
        numbers.iter().filter_map(at).collect::<Vec<_>>()
    };
    let bounds: Vec<(f64, f64)> = result
        .groups
        .iter()
        .flat_map(parts)
        .filter(|(_, _, bound)| !bound.is_measured())
        .map(|(x, part, _)| (x, part))
        .collect();
    if !bounds.is_empty() {
        series.push(Series::new("a bound only: see the table", Look::marks(7, Marker::Triangle), bounds));
    }
    let ends = [numbers[0].1, numbers[numbers.len() - 1].1];
    let range = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    let level = [(range.0, LEAST), (range.1, LEAST)].to_vec();
    series.insert(0, Series::new(format!("{:.0} %", 100.0 * LEAST), Look::line(0, Line::Faint), level));
    let label = if unit.is_empty() {
        result.along.key.clone()
    } else {
        format!("{} [{}]", result.along.key, unit.trim())
    };
    let x = Axis::new(&label).over(range.0, range.1);
    let plot = Plot {
        x: if range.0 > 0.0 { x.log() } else { x },
        y: Axis::new(&format!("Part of the reference's {}", result.what)),
        series,
        ..Plot::default()
    };
    chart(&Chart { title: part.title.clone(), columns: 1, plots: vec![plot], ..Chart::default() })
}

/// The heights over speed, a panel for each combination of the other axes.
fn heights(part: &Part, grid: &Grid) -> Picture {
    let axes = &grid.plan.axes;
    let at = axes.iter().position(|axis| axis.key == part.along).unwrap_or(0);
    let mut plots: Vec<Plot> = Vec::new();
    for (i, unit) in grid.units.iter().enumerate() {
        let Some(unit) = unit else { continue };
        let values = grid.plan.values(i);
        let others: Vec<String> =
            (0..axes.len()).filter(|&j| j != at).map(|j| format!("{} {}", axes[j].key, values[j])).collect();
        let title = others.join(", ");
        let colour = axes[at].values.iter().position(|v| *v == values[at]).unwrap_or(0);
        let line = if colour % 2 == 0 { Line::Solid } else { Line::Dashed };
        let points =
            grid.plan.search.speeds.iter().copied().zip(unit.found.iter().map(|f| f.height)).collect();
        let mut series =
            vec![Series::new(format!("{} {}", axes[at].key, values[at]), Look::line(colour, line), points)];
        let found = grid.plan.search.speeds.iter().zip(&unit.found);
        let capped: Vec<_> = found.filter(|(_, f)| f.capped).map(|(v, f)| (*v, f.height)).collect();
        if !capped.is_empty() {
            series.push(Series::new(AT_LEAST, Look::marks(colour, Marker::Triangle), capped));
        }
        match plots.iter_mut().find(|plot| plot.title == title) {
            Some(plot) => plot.series.extend(series),
            None => plots.push(Plot {
                title,
                x: Axis::new("Forward speed [m/s]"),
                y: Axis::new("Height [rad/s]"),
                series,
                ..Plot::default()
            }),
        }
    }
    chart(&Chart { title: part.title.clone(), columns: 3, plots, ..Chart::default() })
}
