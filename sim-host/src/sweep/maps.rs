//! Figures of a sweep, from its results.

use super::plan::{combination, count, label};
use super::{Axis, Grid};
use crate::basin::Bound;
use crate::report::figure::{
    self, Chart, HeatMap, Line, Look, Map, Marker, Picture, Plot, Series, chart, heatmap,
};

/// Name in titles and axis label of the measure by which cells are compared.
fn measured(grid: &Grid) -> (&'static str, &'static str) {
    if grid.one_speed() { ("Height", "Height [rad/s]") } else { ("Area", "Area [rad m/s²]") }
}

/// Largest number of maps side by side. With more combinations of the other axes, the largest area is shown.
const MAPS: usize = 12;
/// Contour at this fraction of the largest value, above which nearly nothing is lost.
const CONTOUR: f64 = 0.95;

/// Figures and their names: area over each pair of axes, or over the only axis and then also height over
/// speed. At a single speed the height replaces the area.
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

/// Area over two axes, with one map for every combination of the others.
fn pair(grid: &Grid, x: usize, y: usize) -> Picture {
    let axes = &grid.plan.axes;
    let others: Vec<usize> = (0..axes.len()).filter(|i| ![x, y].contains(i)).collect();
    let other_axes: Vec<Axis> = others.iter().map(|&i| axes[i].clone()).collect();
    let (name, measure) = measured(grid);
    let strides: Vec<usize> = (0..axes.len()).map(|i| count(&axes[i + 1..])).collect();
    let place = |i: usize, axis: usize| i / strides[axis] % axes[axis].values.len();
    let map = |wanted: Option<&[String]>| {
        let mut rows: Map = vec![vec![None; axes[x].values.len()]; axes[y].values.len()];
        for (i, area) in grid.measures().into_iter().enumerate() {
            let here: Vec<String> = others.iter().map(|&o| axes[o].values[place(i, o)].clone()).collect();
            let cell = &mut rows[place(i, y)][place(i, x)];
            if wanted.is_none_or(|wanted| wanted == here) {
                *cell = cell.iter().copied().chain(area).reduce(larger);
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
        title: &format!("{name} of the basin: {} and {}", axes[x].key, axes[y].key),
        label: measure,
        x: (&axes[x].key, &axes[x].values),
        y: (&axes[y].key, &axes[y].values),
        maps: &maps,
        contour: CONTOUR,
    })
}

/// The larger of two numbers; a lower bound if either is.
fn larger(a: (f64, Bound), b: (f64, Bound)) -> (f64, Bound) {
    (a.0.max(b.0), Bound::of(!(a.1.is_measured() && b.1.is_measured())))
}

/// Area over the only axis; lower bounds as triangles.
fn line(grid: &Grid, axis: usize) -> Picture {
    let axis = &grid.plan.axes[axis];
    let measured_by = measured(grid);
    let points: Vec<(f64, (f64, Bound))> =
        (1..).map(f64::from).zip(grid.measures()).filter_map(|(x, m)| Some((x, m?))).collect();
    let largest = points.iter().map(|p| p.1.0).fold(0.0, f64::max);
    let all = points.iter().map(|&(x, (y, _))| (x, y)).collect();
    let bounds: Vec<_> = points.iter().filter(|p| !p.1.1.is_measured()).map(|&(x, (y, _))| (x, y)).collect();
    let look = Look { marker: Some(Marker::Dot), ..Look::line(0, Line::Solid) };
    let mut series = vec![Series::new("", look, all)];
    if !bounds.is_empty() {
        series.push(Series::new(AT_LEAST, Look::marks(1, Marker::Triangle), bounds));
    }
    let plot = Plot {
        x: figure::Axis::of_names(&axis.key, axis.values.clone()),
        y: figure::Axis::new(measured_by.1).over(0.0, 1.08 * largest.max(1e-9)),
        series,
        ..Plot::default()
    };
    chart(&Chart {
        title: format!("{} of the basin over {}", measured_by.0, axis.key),
        columns: 1,
        plots: vec![plot],
        ..Chart::default()
    })
}

/// Text of the legend for lower bounds.
pub(crate) const AT_LEAST: &str = "at least this: no fall up to the largest rate tried";

/// Height over the only axis and speed.
fn heights(grid: &Grid, axis: usize) -> Picture {
    let (axis, speeds) = (&grid.plan.axes[axis], &grid.plan.search.speeds);
    let names: Vec<String> = speeds.iter().map(f64::to_string).collect();
    let row = |unit: &Option<super::Unit>| match unit {
        Some(unit) => unit.found.iter().map(|f| Some((f.height, Bound::of(f.capped)))).collect(),
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
