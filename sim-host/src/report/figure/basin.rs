//! A basin of attraction over speed.

use super::canvas::{Area, Canvas, Picture, Stroke};
use super::colour::{BASIN, INK, ISLAND, SHADES, STABLE, shade};
use super::legend::{Entry, Sign, entry, rows, rows_height, triangle};
use super::outlines::outlines;
use super::panel::Panel;
use super::time_scale::TimeScale;
use crate::basin::{Axis, Basin, Column};
use crate::ride::Outcome;

/// What a figure of basins shows.
#[derive(Clone, Copy, Debug)]
pub struct BasinFigure<'a> {
    /// Above the figure.
    pub title: &'a str,
    /// Names and basins. One is drawn with its inside and outside, of several the outlines.
    pub series: &'a [(&'a str, &'a Basin)],
    /// Weave and capsize speed of the uncontrolled bicycle, between which it balances itself \[m/s\].
    pub self_stable: Option<(f64, f64)>,
    /// The disturbed rate.
    pub axis: Axis,
    /// Largest disturbance tried \[rad/s\].
    pub cap: f64,
}

/// The figure of one basin, or of the outlines of several.
///
/// One basin: its inside filled, hatched where a ride outlasted the time limit without coming back;
/// outside a dot for every point of the scan in the colour of its time to fall.
pub fn basin(figure: &BasinFigure) -> Picture {
    match figure.series {
        [(name, basin)] => inside_and_outside(figure, name, basin),
        _ => outlines(figure),
    }
}

/// Where the axes are.
pub(super) const AREA: Area = Area { x: 66.0, y: 44.0, width: 600.0, height: 380.0 };
/// From the axes down to the legend.
pub(super) const LEGEND_GAP: f64 = 50.0;
/// How opaque the inside is laid over its black hatching.
pub(super) const SOFTER: f64 = 0.5;
/// The height of a figure with this legend.
pub(super) fn height(legend: &[Entry]) -> f64 {
    AREA.bottom() + LEGEND_GAP + rows_height(legend, AREA.width) + 12.0
}
/// The label of the speeds.
pub(super) const SPEED: &str = "Forward speed v [m/s]";

impl BasinFigure<'_> {
    /// The label of the disturbances.
    pub(super) fn rate_label(&self) -> &'static str {
        match self.axis {
            Axis::SteerRate => "Initial steer rate [rad/s]",
            Axis::RollRate => "Initial roll rate [rad/s]",
        }
    }

    /// Axes from the least to the greatest of `speeds`, and to a little over `top`.
    pub(super) fn panel(&self, speeds: impl Iterator<Item = f64>, top: f64) -> Panel {
        let (low, high) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| (r.0.min(v), r.1.max(v)));
        let x = match (low, high) {
            _ if low < high => (low, high),
            _ if low == high => (low - 0.5, low + 0.5),
            _ => (0.0, 10.0),
        };
        Panel { area: AREA, x, y: (0.0, if top > 0.0 { 1.015 * top } else { 1.0 }) }
    }

    /// The legend's entry of the self-stable range, if there is one.
    pub(super) fn stable_entry(&self) -> Option<Entry> {
        let (from, to) = self.self_stable?;
        let label = format!("uncontrolled: self-stable, {from:.2}–{to:.2} m/s");
        Some(entry(Sign::Fill(STABLE, 0.3), label))
    }
}

/// From where to where every column stands for the basin \[m/s\]: half way to its neighbours.
fn edges(basin: &Basin) -> Vec<(f64, f64)> {
    let v: Vec<f64> = basin.columns.iter().map(|c| c.speed).collect();
    let between = |i: usize| 0.5 * (v[i - 1] + v[i]);
    let n = v.len();
    let half = |i: usize| if n < 2 { 0.25 } else { 0.5 * (v[i] - v[i - 1]) };
    (0..n)
        .map(|i| {
            let left = if i > 0 { between(i) } else { v[0] - half(1) };
            let right = if i + 1 < n { between(i + 1) } else { v[i] + half(i) };
            (left, right)
        })
        .collect()
}

/// Ranges of the disturbance that outlasted the time limit but did not come back \[rad/s\].
fn undecided(column: &Column) -> Vec<(f64, f64)> {
    let safe = std::iter::once((0.0, column.upper)).chain(column.islands.iter().map(|i| (i.from, i.to)));
    let mut ranges = Vec::new();
    for (from, to) in safe {
        let inside: Vec<_> = column.scan.iter().filter(|p| p.rate >= from && p.rate <= to).collect();
        for (i, point) in inside.iter().enumerate().filter(|(_, p)| p.outcome == Outcome::Undecided) {
            let low = if i > 0 { 0.5 * (inside[i - 1].rate + point.rate) } else { from };
            let high = inside.get(i + 1).map_or(to, |next| 0.5 * (point.rate + next.rate));
            ranges.push((low, high));
        }
    }
    // Neighbours become one, so that a picture needs few rectangles.
    ranges.dedup_by(|next, last| {
        let joined = next.0 <= last.1;
        if joined {
            last.1 = next.1;
        }
        joined
    });
    ranges
}

fn inside_and_outside(figure: &BasinFigure, name: &str, basin: &Basin) -> Picture {
    let edges = edges(basin);
    // Half a column further than the speeds and a little over the cap, so that the dots are whole.
    let ends = edges.iter().flat_map(|&(a, b)| [a, b]);
    let panel = figure.panel(ends, figure.cap);
    let legend = entries(figure, name, basin);
    let mut canvas = Canvas::new(AREA.right() + 92.0, height(&legend));
    canvas.title((AREA.x, 26.0), AREA.width, figure.title);
    let outline = outline(basin, &edges);
    let pixels = |data: &[(f64, f64)]| data.iter().map(|&p| panel.at(p)).collect::<Vec<_>>();
    let inside = |canvas: &mut Canvas, opacity: f64| {
        if let ([first, ..], [.., last]) = (&outline[..], &outline[..]) {
            let corners = [&[(first.0, 0.0)], &outline[..], &[(last.0, 0.0)]].concat();
            canvas.polygon(&pixels(&corners), BASIN, opacity);
        }
        for (column, &edge) in basin.columns.iter().zip(&edges) {
            for island in &column.islands {
                let mut area = panel.span(edge, (island.from, island.to));
                area.height = area.height.max(2.0);
                canvas.rect(area, ISLAND, opacity);
            }
        }
    };
    canvas.clipped(panel.area, |canvas| {
        inside(canvas, 1.0);
        for (i, &edge) in edges.iter().enumerate() {
            for range in undecided(&basin.columns[i]) {
                canvas.hatch(&pixels(&cell(basin, i, edge, range)));
            }
        }
        inside(canvas, SOFTER);
        if let Some(range) = figure.self_stable {
            panel.shade_x(canvas, range);
        }
        falls(canvas, &panel, basin);
        canvas.line(&pixels(&outline), Stroke::solid(INK, 1.6));
    });
    caps(&mut canvas, &panel, basin);
    panel.frame(&mut canvas, Some(SPEED), figure.rate_label());
    rows(&mut canvas, &legend, (AREA.x, AREA.bottom() + LEGEND_GAP), AREA.width);
    TimeScale::new(basin).bar(&mut canvas, AREA);
    canvas.finish()
}

/// The border of the basin, level from the outer columns to their edges.
fn outline(basin: &Basin, edges: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let columns = &basin.columns;
    let first = columns.first().zip(edges.first()).map(|(c, e)| (e.0, c.upper));
    let last = columns.last().zip(edges.last()).map(|(c, e)| (e.1, c.upper));
    first.into_iter().chain(columns.iter().map(|c| (c.speed, c.upper))).chain(last).collect()
}

/// The corners of a range of column `i` from edge to edge; in the basin none is beyond its border.
fn cell(basin: &Basin, i: usize, edge: (f64, f64), (low, high): (f64, f64)) -> [(f64, f64); 5] {
    let column = &basin.columns[i];
    let border = |neighbour: Option<&Column>| match neighbour {
        Some(n) if high <= column.upper => 0.5 * (column.upper + n.upper),
        _ => f64::INFINITY,
    };
    let left = border(i.checked_sub(1).map(|k| &basin.columns[k]));
    let right = border(basin.columns.get(i + 1));
    [
        (edge.0, low.min(left)),
        (edge.0, high.min(left)),
        (column.speed, high),
        (edge.1, high.min(right)),
        (edge.1, low.min(right)),
    ]
}

/// What of the legend this basin needs.
fn entries(figure: &BasinFigure, name: &str, basin: &Basin) -> Vec<Entry> {
    let any = |f: &dyn Fn(&Column) -> bool| basin.columns.iter().any(f);
    let label =
        if name.is_empty() { "basin of attraction".into() } else { format!("basin of attraction: {name}") };
    let mut legend = vec![entry(Sign::Fill(BASIN, 1.0), label)];
    if any(&|c| !undecided(c).is_empty()) {
        legend.push(entry(Sign::Hatched(BASIN), "outlasts the time limit, not come back"));
    }
    if any(&|c| !c.islands.is_empty()) {
        legend.push(entry(Sign::Fill(ISLAND, 1.0), "beyond a first fall, not fallen"));
    }
    if any(&|c| c.capped) {
        legend.push(entry(Sign::Triangle(INK), "no fall up to the largest rate tried"));
    }
    legend.extend(figure.stable_entry());
    legend
}

/// A dot for every fall, in the colour of its time.
fn falls(canvas: &mut Canvas, panel: &Panel, basin: &Basin) {
    let scale = TimeScale::new(basin);
    let mut shades = vec![Vec::new(); SHADES];
    let mut nearest = f64::INFINITY;
    for column in &basin.columns {
        for w in column.scan.windows(2) {
            nearest = nearest.min(panel.y(w[0].rate) - panel.y(w[1].rate));
        }
        for point in &column.scan {
            if let Some(time) = point.outcome.time_to_fall_s() {
                shades[scale.shade_of(time)].push(panel.at((column.speed, point.rate)));
            }
        }
    }
    for w in basin.columns.windows(2) {
        nearest = nearest.min(panel.x(w[1].speed) - panel.x(w[0].speed));
    }
    let r = (0.42 * nearest).clamp(0.8, 4.0);
    for (i, centres) in shades.iter().enumerate().filter(|(_, centres)| !centres.is_empty()) {
        canvas.dots(centres, r, &shade(i));
    }
}

/// Triangles along the upper edge where nothing fell, some pixels apart.
pub(super) fn caps(canvas: &mut Canvas, panel: &Panel, basin: &Basin) {
    let mut last = f64::NEG_INFINITY;
    for column in basin.columns.iter().filter(|c| c.capped) {
        let (x, y) = panel.at((column.speed, column.upper));
        if x - last >= 11.0 {
            triangle(canvas, (x, y + 3.0), INK);
            last = x;
        }
    }
}
