//! A basin of attraction over speed.

use super::canvas::{Area, Canvas, Picture, Stroke, text_width};
use super::colour::{BASIN, INK, ISLAND, SHADES, STABLE, shade};
use super::legend::{Entry, Sign, entry, rows, rows_height, triangle};
use super::outlines::outlines;
use super::panel::Panel;
use super::scale::{nice, ticks};
use crate::basin::{Axis, Basin, Column};
use crate::ride::Outcome;
use kuva::render::render::TextAnchor;

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

    /// Axes that show every column whole, up to `top`.
    pub(super) fn panel(&self, top: f64) -> Panel {
        let edges: Vec<f64> =
            self.series.iter().flat_map(|(_, b)| edges(b)).flat_map(|(a, b)| [a, b]).collect();
        let x = match edges.len() {
            0 => (0.0, 10.0),
            _ => edges.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, &e| (r.0.min(e), r.1.max(e))),
        };
        Panel { area: AREA, x, y: (0.0, if top > 0.0 { top } else { 1.0 }) }
    }

    /// The legend's entry of the self-stable range, if there is one.
    pub(super) fn stable_entry(&self) -> Option<Entry> {
        let (from, to) = self.self_stable?;
        let label = format!("self-stable without control, {from:.2} to {to:.2} m/s");
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
    let panel = figure.panel(figure.cap);
    let edges = edges(basin);
    let legend = entries(figure, name, basin);
    let height = AREA.bottom() + LEGEND_GAP + rows_height(&legend, AREA.width) + 12.0;
    let mut canvas = Canvas::new(AREA.right() + 92.0, height);
    canvas.title((AREA.x, 26.0), AREA.width, figure.title);
    let outline: Vec<(f64, f64)> = match basin.columns.as_slice() {
        [only] => vec![(edges[0].0, only.upper), (edges[0].1, only.upper)],
        columns => columns.iter().map(|c| (c.speed, c.upper)).collect(),
    };
    canvas.clipped(panel.area, |canvas| {
        if let ([first, ..], [.., last]) = (&outline[..], &outline[..]) {
            let corners = [&[(first.0, 0.0)], &outline[..], &[(last.0, 0.0)]].concat();
            canvas.polygon(&corners.iter().map(|&p| panel.at(p)).collect::<Vec<_>>(), BASIN);
        }
        for (column, &edge) in basin.columns.iter().zip(&edges) {
            for island in &column.islands {
                canvas.rect(panel.span(edge, (island.from, island.to)), ISLAND, 1.0);
            }
        }
        for (column, &edge) in basin.columns.iter().zip(&edges) {
            for range in undecided(column) {
                canvas.hatch(panel.span(edge, range));
            }
        }
        if let Some(range) = figure.self_stable {
            panel.shade_x(canvas, range);
        }
        falls(canvas, &panel, basin);
        canvas.line(&outline.iter().map(|&p| panel.at(p)).collect::<Vec<_>>(), Stroke::solid(INK, 1.6));
        caps(canvas, &panel, basin);
    });
    panel.frame(&mut canvas, Some(SPEED), figure.rate_label());
    rows(&mut canvas, &legend, (AREA.x, AREA.bottom() + LEGEND_GAP), AREA.width);
    colour_bar(&mut canvas, longest(basin));
    canvas.finish()
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

/// The end of the colour scale \[s\]: the longest time to fall, rounded up.
fn longest(basin: &Basin) -> f64 {
    let times = basin.columns.iter().flat_map(|c| &c.scan).filter_map(|p| p.outcome.time_to_fall_s());
    nice(times.chain([0.0, 0.5]), 5).1
}

/// A dot for every fall, in the colour of its time.
fn falls(canvas: &mut Canvas, panel: &Panel, basin: &Basin) {
    let longest = longest(basin);
    let mut shades = vec![Vec::new(); SHADES];
    let mut nearest = f64::INFINITY;
    for column in &basin.columns {
        for w in column.scan.windows(2) {
            nearest = nearest.min(panel.y(w[0].rate) - panel.y(w[1].rate));
        }
        for point in &column.scan {
            if let Some(time) = point.outcome.time_to_fall_s() {
                let shade = (time / longest * SHADES as f64) as usize;
                shades[shade.min(SHADES - 1)].push(panel.at((column.speed, point.rate)));
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

/// The scale of times to fall, right of the axes.
fn colour_bar(canvas: &mut Canvas, longest: f64) {
    let bar = Area { x: AREA.right() + 18.0, y: AREA.y, width: 14.0, height: AREA.height };
    let scale = Panel { area: bar, x: (0.0, 1.0), y: (0.0, longest) };
    for i in 0..SHADES {
        let (low, high) = (i as f64 / SHADES as f64, (i + 1) as f64 / SHADES as f64);
        let area = scale.span((0.0, 1.0), (low * longest, high * longest));
        canvas.rect(area, shade(i), 1.0);
    }
    let mut widest = 0.0_f64;
    for (t, number) in ticks(scale.y, 7) {
        let at = scale.y(t);
        canvas.line(&[(bar.right(), at), (bar.right() + 4.0, at)], Stroke::solid(INK, 1.0));
        canvas.text((bar.right() + 7.0, at + 4.0), 12, TextAnchor::Start, &number);
        widest = widest.max(text_width(&number, 12));
    }
    canvas.text_upwards((bar.right() + 24.0 + widest, bar.y + 0.5 * bar.height), 13, "Time to fall [s]");
}
