//! Figure of the outlines of several basins.

use super::basin_axes::{AREA, BasinFigure, LEGEND_GAP, SPEED, caps, height};
use super::canvas::{Canvas, Dash, Stroke};
use super::colour::{INK, SERIES};
use super::legend::{Sign, entry, rows};
use super::picture::Picture;
use super::scale::nice;

/// Draws a line for each basin. Every second line is dashed and drawn last, so that both are visible where two
/// coincide.
pub(super) fn outlines(figure: &BasinFigure) -> Picture {
    let columns = || figure.series.iter().flat_map(|(_, b)| &b.columns);
    let top = nice(columns().map(|c| c.upper).chain([0.0]), 8).1.min(figure.cap);
    let panel = figure.panel(columns().map(|c| c.speed), top);
    let stroke = |i: usize| {
        let color = SERIES[i % SERIES.len()];
        if i.is_multiple_of(2) { Stroke::solid(color, 2.2) } else { Stroke::dashed(color, 2.2) }
    };
    let mut legend: Vec<_> =
        figure.series.iter().enumerate().map(|(i, (name, _))| entry(Sign::Line(stroke(i)), *name)).collect();
    legend.extend(figure.stable_entry());
    if columns().any(|c| c.capped) {
        legend.push(entry(Sign::Triangle(INK), "no fall up to the largest rate tried"));
    }
    let mut canvas = Canvas::new(AREA.right() + 24.0, height(&legend));
    canvas.title((AREA.x, 26.0), AREA.width, figure.title);
    if let Some(range) = figure.self_stable {
        panel.shade_x(&mut canvas, range);
    }
    for dash in [Dash::Solid, Dash::Dashed] {
        for (i, (_, basin)) in figure.series.iter().enumerate().filter(|(i, _)| stroke(*i).dash == dash) {
            panel.line(&mut canvas, basin.columns.iter().map(|c| (c.speed, c.upper)), stroke(i));
        }
    }
    for (_, basin) in figure.series {
        caps(&mut canvas, &panel, basin);
    }
    panel.frame(&mut canvas, Some(SPEED), figure.rate_label());
    rows(&mut canvas, &legend, (AREA.x, AREA.bottom() + LEGEND_GAP), AREA.width);
    canvas.finish()
}
