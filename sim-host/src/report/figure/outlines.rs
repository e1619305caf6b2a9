//! The outlines of several basins.

use super::basin::{AREA, BasinFigure, LEGEND_GAP, SPEED, caps};
use super::canvas::{Canvas, Picture, Stroke};
use super::colour::{INK, SERIES};
use super::legend::{Sign, entry, rows, rows_height};
use super::scale::nice;

/// A line for every basin: solid in the palette's colours, then dashed in the same.
pub(super) fn outlines(figure: &BasinFigure) -> Picture {
    let highest = figure.series.iter().flat_map(|(_, b)| &b.columns).map(|c| c.upper);
    let top = nice(highest.chain([0.0]), 8).1.min(figure.cap);
    let panel = figure.panel(top);
    let line = |i: usize| {
        let color = SERIES[i % SERIES.len()];
        if i < SERIES.len() { Stroke::solid(color, 2.2) } else { Stroke::dashed(color, 2.2) }
    };
    let mut legend: Vec<_> =
        figure.series.iter().enumerate().map(|(i, (name, _))| entry(Sign::Line(line(i)), *name)).collect();
    legend.extend(figure.stable_entry());
    if figure.series.iter().any(|(_, b)| b.columns.iter().any(|c| c.capped)) {
        legend.push(entry(Sign::Triangle(INK), "no fall up to the largest rate tried"));
    }
    let height = AREA.bottom() + LEGEND_GAP + rows_height(&legend, AREA.width) + 12.0;
    let mut canvas = Canvas::new(AREA.right() + 24.0, height);
    canvas.title((AREA.x, 26.0), AREA.width, figure.title);
    if let Some(range) = figure.self_stable {
        panel.shade_x(&mut canvas, range);
    }
    for (i, (_, basin)) in figure.series.iter().enumerate() {
        panel.line(&mut canvas, basin.columns.iter().map(|c| (c.speed, c.upper)), line(i));
    }
    canvas.clipped(panel.area, |canvas| {
        for (_, basin) in figure.series {
            caps(canvas, &panel, basin);
        }
    });
    panel.frame(&mut canvas, Some(SPEED), figure.rate_label());
    rows(&mut canvas, &legend, (AREA.x, AREA.bottom() + LEGEND_GAP), AREA.width);
    canvas.finish()
}
