//! Figure of one basin: its inside, and the times to fall outside.

use super::basin_axes::{AREA, Band, BasinFigure, LEGEND_GAP, SPEED, caps, height};
use super::canvas::{Canvas, Stroke};
use super::colour::{BASIN, INK, ISLAND, SHADES, shade};
use super::legend::{Entry, SOFTER, Sign, entry, rows};
use super::panel::Panel;
use super::picture::Picture;
use super::time_scale::TimeScale;
use crate::basin::{Basin, Column};
use crate::ride::Outcome;

/// Opacity of a band.
const BAND: f64 = 0.3;

/// Speed interval of each column \[m/s\]: half-way to its neighbours.
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

/// Ranges of the disturbance from which the ride lasts the time limit without recovering \[rad/s\].
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
    // Adjacent ranges are merged, so that a figure needs few rectangles.
    ranges.dedup_by(|next, last| {
        let joined = next.0 <= last.1;
        if joined {
            last.1 = next.1;
        }
        joined
    });
    ranges
}

/// Draws the inside filled and outlined, the outside as dots.
pub(super) fn inside_and_outside(figure: &BasinFigure, name: &str, basin: &Basin) -> Picture {
    let edges = edges(basin);
    // Half a column beyond the speeds and slightly beyond the cap, so that the dots are not cut.
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
        if let Some(Band { edges: band, .. }) = figure.band {
            let low = band.iter().map(|&(v, low, _)| (v, low));
            let high = band.iter().rev().map(|&(v, _, high)| (v, high));
            canvas.polygon(&pixels(&low.chain(high).collect::<Vec<_>>()), INK, BAND);
        }
        canvas.line(&pixels(&outline), Stroke::solid(INK, 1.6));
    });
    caps(&mut canvas, &panel, basin);
    panel.frame(&mut canvas, Some(SPEED), figure.rate_label());
    rows(&mut canvas, &legend, (AREA.x, AREA.bottom() + LEGEND_GAP), AREA.width);
    TimeScale::new(basin).bar(&mut canvas, AREA);
    canvas.finish()
}

/// The border of the basin, constant from the outer columns to their edges.
fn outline(basin: &Basin, edges: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let columns = &basin.columns;
    let first = columns.first().zip(edges.first()).map(|(c, e)| (e.0, c.upper));
    let last = columns.last().zip(edges.last()).map(|(c, e)| (e.1, c.upper));
    first.into_iter().chain(columns.iter().map(|c| (c.speed, c.upper))).chain(last).collect()
}

/// The corners of a range of column `i` from edge to edge; inside the basin, limited by its border.
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

/// The legend entries that this basin needs.
fn entries(figure: &BasinFigure, name: &str, basin: &Basin) -> Vec<Entry> {
    let any = |f: &dyn Fn(&Column) -> bool| basin.columns.iter().any(f);
    let label =
        if name.is_empty() { "basin of attraction".into() } else { format!("basin of attraction: {name}") };
    let mut legend = vec![entry(Sign::Fill(BASIN, 1.0), label)];
    if any(&|c| !undecided(c).is_empty()) {
        legend.push(entry(Sign::Hatched(BASIN), "still upright at the time limit, not settled yet"));
    }
    if any(&|c| !c.islands.is_empty()) {
        legend.push(entry(Sign::Fill(ISLAND, 1.0), "above a rate that falls, but does not fall itself"));
    }
    if any(&|c| c.capped) {
        legend.push(entry(Sign::Triangle(INK), "no fall up to the largest rate tried"));
    }
    legend.extend(figure.band.map(|band| entry(Sign::Fill(INK, BAND), band.label)));
    legend.extend(figure.stable_entry());
    legend
}

/// Draws a dot for each fall, in the colour of its time.
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
