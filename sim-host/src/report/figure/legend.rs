//! Draws legends, in rows below a figure or in a column beside a panel.

use super::canvas::{Area, Canvas, Stroke};
use super::colour::GREY;
use super::marker::{Marker, mark};
use super::shape::text_width;
use kuva::render::render::TextAnchor;

const TEXT: u32 = 12;
const LINE: f64 = 19.0;
const SWATCH: f64 = 24.0;
/// Opacity of a colour over its black hatching.
pub(super) const SOFTER: f64 = 0.5;

/// A sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sign {
    /// A line.
    Line(Stroke),
    /// A filled area with an opacity.
    Fill(&'static str, f64),
    /// A hatched area.
    Hatched(&'static str),
    /// Triangles.
    Triangle(&'static str),
    /// Marks on a line, or without one.
    Marked(Marker, Stroke, bool),
}

/// A sign and its meaning.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    sign: Sign,
    label: String,
}

/// An entry of a legend.
pub(super) fn entry(sign: Sign, label: impl Into<String>) -> Entry {
    Entry { sign, label: label.into() }
}

/// Number of columns of a legend below a figure of this width.
fn columns(entries: &[Entry], width: f64) -> usize {
    let widest = entries.iter().map(entry_width).fold(1.0, f64::max);
    ((width / widest) as usize).clamp(1, entries.len().max(1))
}

/// Height of the rows below a figure.
pub(super) fn rows_height(entries: &[Entry], width: f64) -> f64 {
    LINE * entries.len().div_ceil(columns(entries, width)) as f64
}

/// Draws rows of entries with their upper left corner at (`x`, `y`).
pub(super) fn rows(canvas: &mut Canvas, entries: &[Entry], (x, y): (f64, f64), width: f64) {
    let columns = columns(entries, width);
    let column = entries.iter().map(entry_width).fold(0.0, f64::max);
    for (i, e) in entries.iter().enumerate() {
        let at = (x + column * (i % columns) as f64, y + LINE * ((i / columns) as f64 + 0.5));
        draw(canvas, e, at);
    }
}

/// Draws a column of entries with its upper left corner at (`x`, `y`).
pub(super) fn column(canvas: &mut Canvas, entries: &[Entry], (x, y): (f64, f64)) {
    for (i, e) in entries.iter().enumerate() {
        draw(canvas, e, (x, y + LINE * (i as f64 + 0.5)));
    }
}

fn entry_width(entry: &Entry) -> f64 {
    SWATCH + 8.0 + text_width(&entry.label, TEXT) + 12.0
}

fn draw(canvas: &mut Canvas, entry: &Entry, (x, y): (f64, f64)) {
    let area = Area { x, y: y - 6.0, width: SWATCH, height: 12.0 };
    let border = |canvas: &mut Canvas| {
        let (r, b) = (area.right(), area.bottom());
        let corners = [(area.x, area.y), (r, area.y), (r, b), (area.x, b), (area.x, area.y)];
        canvas.line(&corners, Stroke::solid(GREY, 0.8));
    };
    match entry.sign {
        Sign::Line(stroke) => canvas.line(&[(x, y), (x + SWATCH, y)], stroke),
        Sign::Fill(color, opacity) => {
            canvas.rect(area, color, opacity);
            border(canvas);
        }
        Sign::Hatched(color) => {
            canvas.rect(area, color, 1.0);
            let (r, b) = (area.right(), area.bottom());
            canvas.hatch(&[(x, area.y), (r, area.y), (r, b), (x, b)]);
            canvas.rect(area, color, SOFTER);
            border(canvas);
        }
        Sign::Triangle(color) => triangle(canvas, (x + 0.5 * SWATCH, y - 4.0), color),
        Sign::Marked(marker, stroke, line) => {
            if line {
                canvas.line(&[(x, y), (x + SWATCH, y)], stroke);
            }
            mark(canvas, &[(x + 0.5 * SWATCH, y)], marker, stroke.color);
        }
    }
    canvas.text((x + SWATCH + 8.0, y + 4.0), TEXT, TextAnchor::Start, &entry.label);
}

/// A small triangle whose tip points up at `tip`.
pub(super) fn triangle(canvas: &mut Canvas, (x, y): (f64, f64), color: &str) {
    canvas.polygon(&[(x, y), (x - 4.0, y + 7.0), (x + 4.0, y + 7.0)], color, 1.0);
}
