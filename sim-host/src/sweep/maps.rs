//! The figures of a sweep.

use super::plan::{combination, count, label};
use super::{Axis, Grid};
use crate::report::figure::{
    self, Chart, HeatMap, Line, Look, Marker, Picture, Plot, Series, chart, heatmap,
};

const AREA: &str = "Area [rad m/s²]";
/// Most maps side by side; of more combinations of the other axes the largest area is shown.
const MAPS: usize = 12;
/// What counts as nothing lost.
const CONTOUR: f64 = 0.95;

/// The figures and their names: the area over every two axes, or over the only one; then also the
/// height over speed.
pub fn pictures(grid: &Grid) -> Vec<(String, Picture)> {
    let axes = &grid.plan.axes;
    let varied: Vec<usize> = (0..axes.len()).filter(|&i| axes[i].values.len() > 1).collect();
    if let [only] = varied[..] {
        let key = &axes[only].key;
        return vec![
            (format!("area-{key}"), line(grid, only)),
            (format!("height-{key}"), heights(grid, only)),
        ];
    }
    let mut figures = Vec::new();
    for (i, &x) in varied.iter().enumerate() {
        for &y in &varied[i + 1..] {
            figures.push((format!("area-{}-{}", axes[x].key, axes[y].key), pair(grid, x, y)));
        }
    }
    figures
}

/// The area over two axes, a map for every combination of the others.
fn pair(grid: &Grid, x: usize, y: usize) -> Picture {
    let axes = &grid.plan.axes;
    let others: Vec<usize> = (0..axes.len()).filter(|i| ![x, y].contains(i)).collect();
    let other_axes: Vec<Axis> = others.iter().map(|&i| axes[i].clone()).collect();
    let areas = grid.areas();
    let strides: Vec<usize> = (0..axes.len()).map(|i| count(&axes[i + 1..])).collect();
    let place = |i: usize, axis: usize| i / strides[axis] % axes[axis].values.len();
    let map = |wanted: Option<&[String]>| {
        let mut rows = vec![vec![None; axes[x].values.len()]; axes[y].values.len()];
        for (i, area) in areas.iter().enumerate() {
            let here: Vec<String> = others.iter().map(|&o| axes[o].values[place(i, o)].clone()).collect();
            let cell: &mut Option<f64> = &mut rows[place(i, y)][place(i, x)];
            if wanted.is_none_or(|wanted| wanted == here) {
                *cell = cell.iter().chain(area).copied().reduce(f64::max);
            }
        }
        rows
    };
    let combinations = count(&other_axes);
    let maps = if combinations <= MAPS {
        let one = |i: usize| {
            let values = combination(&other_axes, i);
            (label(&other_axes, &values), map(Some(&values)))
        };
        (0..combinations).map(one).collect()
    } else {
        vec![("largest over the other axes".into(), map(None))]
    };
    heatmap(&HeatMap {
        title: &format!("Area of the basin: {} and {}", axes[x].key, axes[y].key),
        label: AREA,
        x: (&axes[x].key, &axes[x].values),
        y: (&axes[y].key, &axes[y].values),
        maps: &maps,
        contour: CONTOUR,
    })
}

/// The area over the only axis.
fn line(grid: &Grid, axis: usize) -> Picture {
    let axis = &grid.plan.axes[axis];
    let points = (1..).map(f64::from).zip(grid.areas()).filter_map(|(x, area)| Some((x, area?)));
    let look = Look { marker: Some(Marker::Dot), ..Look::line(0, Line::Solid) };
    let largest = grid.areas().into_iter().flatten().fold(0.0, f64::max);
    let plot = Plot {
        x: figure::Axis::of_names(&axis.key, axis.values.clone()),
        y: figure::Axis::new(AREA).over(0.0, 1.08 * largest.max(1e-9)),
        series: vec![Series::new("", look, points.collect())],
        ..Plot::default()
    };
    chart(&Chart {
        title: format!("Area of the basin over {}", axis.key),
        columns: 1,
        plots: vec![plot],
        ..Chart::default()
    })
}

/// The height over the only axis and speed.
fn heights(grid: &Grid, axis: usize) -> Picture {
    let (axis, speeds) = (&grid.plan.axes[axis], &grid.plan.search.speeds);
    let names: Vec<String> = speeds.iter().map(f64::to_string).collect();
    let row = |unit: &Option<super::Unit>| match unit {
        Some(unit) => unit.found.iter().map(|f| Some(f.height)).collect(),
        None => vec![None; speeds.len()],
    };
    heatmap(&HeatMap {
        title: &format!("Height of the basin over speed and {}", axis.key),
        label: "Height [rad/s]",
        x: ("Forward speed [m/s]", &names),
        y: (&axis.key, &axis.values),
        maps: &[(String::new(), grid.units.iter().map(row).collect())],
        contour: CONTOUR,
    })
}
