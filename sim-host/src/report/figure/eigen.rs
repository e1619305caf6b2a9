//! Figure of eigenvalues over speed.

use super::canvas::{Area, Canvas, Stroke};
use super::colour::{GREY, INK, SERIES, STABLE};
use super::legend::{Sign, entry, rows, rows_height};
use super::modes::{imaginary, in_sight, real};
use super::panel::Panel;
use super::picture::Picture;
use super::scale::nice;
use super::shape::text_width;
use crate::eigen::{CriticalSpeeds, Mode};
use nalgebra::Complex;

/// Data of the figure.
#[derive(Clone, Copy, Debug)]
pub struct EigenFigure<'a> {
    /// Title above the figure.
    pub title: &'a str,
    /// Forward speeds \[m/s\], rising.
    pub speeds: &'a [f64],
    /// The modes at these speeds.
    pub modes: &'a [Mode],
    /// The ranges of speed in which the straight ride is stable \[m/s\].
    pub stable: &'a [(f64, f64)],
    /// The critical speeds.
    pub critical: CriticalSpeeds,
}

const LEFT: f64 = 66.0;
const WIDTH: f64 = 600.0;
/// Real parts beyond this are cut off \[1/s\]: the fast caster mode would flatten the rest.
const REAL_LIMIT: f64 = 10.0;
const IMAGINARY_LIMIT: f64 = 20.0;
const LABEL_TEXT: u32 = 13;
const LABEL_LINE: f64 = 16.0;

/// Draws real parts above in solid lines and imaginary parts below in dashed ones, each mode in its colour, with the
/// critical speeds and the stable ranges. Modes entirely left of the panel are omitted.
pub fn eigen(figure: &EigenFigure) -> Picture {
    let x = match figure.speeds {
        [first, .., last] if first < last => (*first, *last),
        [only, ..] => (only - 0.5, only + 0.5),
        [] => (0.0, 10.0),
    };
    let modes: Vec<(&Mode, &str)> =
        figure.modes.iter().filter(|m| in_sight(m, (-REAL_LIMIT, REAL_LIMIT))).zip(colours()).collect();
    let roots = || modes.iter().flat_map(|(mode, _)| mode.roots.iter().flatten().flatten());
    let parts = |part: fn(&Complex<f64>) -> f64| roots().map(part);
    let growth = parts(|e| e.re.clamp(-REAL_LIMIT, REAL_LIMIT)).chain([-1.0, 1.0]);
    let turning = parts(|e| e.im.clamp(0.0, IMAGINARY_LIMIT)).chain([0.0, 1.0]);
    let labels = labels(&figure.critical, x);
    let label_rows = labels.iter().map(|l| l.row + 1).max().unwrap_or(0);
    let top = 40.0 + LABEL_LINE * label_rows as f64;
    let area = |y: f64, height: f64| Area { x: LEFT, y, width: WIDTH, height };
    let above = Panel { area: area(top, 260.0), x, y: nice(growth, 8) };
    let below = Panel { area: area(above.area.bottom() + 16.0, 150.0), x, y: nice(turning, 5) };

    let mut legend: Vec<_> = modes
        .iter()
        .map(|(mode, colour)| entry(Sign::Line(Stroke::solid(colour, 2.0)), mode.name.as_str()))
        .collect();
    if figure.stable.iter().any(|(from, to)| *from < x.1 && *to > x.0) {
        legend.push(entry(Sign::Fill(STABLE, 0.3), "stable straight ride"));
    }
    let legend_y = below.area.bottom() + 50.0;
    let mut canvas = Canvas::new(LEFT + WIDTH + 24.0, legend_y + rows_height(&legend, WIDTH) + 12.0);
    canvas.title((LEFT, 26.0), WIDTH, figure.title);
    for panel in [&above, &below] {
        for &range in figure.stable {
            panel.shade_x(&mut canvas, range);
        }
        for label in &labels {
            panel.vertical(&mut canvas, label.speed, Stroke::dashed(INK, 0.9));
        }
    }
    above.line(&mut canvas, [(x.0, 0.0), (x.1, 0.0)], Stroke::solid(GREY, 0.9));
    for label in &labels {
        label.draw(&mut canvas, &above);
    }
    for (mode, colour) in &modes {
        for root in &mode.roots {
            for line in real(figure.speeds, root) {
                above.line(&mut canvas, line, Stroke::solid(colour, 2.0));
            }
            for line in imaginary(figure.speeds, root) {
                below.line(&mut canvas, line, Stroke::dashed(colour, 2.0));
            }
        }
    }
    above.frame(&mut canvas, None, "Re λ [1/s]");
    below.frame(&mut canvas, Some("Forward speed v [m/s]"), "Im λ [rad/s]");
    rows(&mut canvas, &legend, (LEFT, legend_y), WIDTH);
    canvas.finish()
}

/// A colour for each mode, repeating after the last.
fn colours() -> impl Iterator<Item = &'static str> {
    SERIES.into_iter().cycle()
}

/// Name of a critical speed above the figure.
struct Label {
    speed: f64,
    index: &'static str,
    value: String,
    /// Its horizontal extent.
    span: (f64, f64),
    /// Number of rows that it is raised to avoid its neighbours.
    row: usize,
}

impl Label {
    fn draw(&self, canvas: &mut Canvas, panel: &Panel) {
        let y = panel.area.y - 7.0 - LABEL_LINE * self.row as f64;
        canvas.indexed((self.span.0, y), LABEL_TEXT, ("v", self.index), &self.value);
    }
}

/// The labels of the speeds in range, without overlap.
fn labels(critical: &CriticalSpeeds, x: (f64, f64)) -> Vec<Label> {
    let speeds = [("d", critical.v_d), ("w", critical.v_w), ("c", critical.v_c)];
    let mut labels: Vec<Label> = Vec::new();
    let in_sight = speeds.into_iter().filter_map(|(index, v)| v.map(|v| (index, v)));
    for (index, speed) in in_sight.filter(|&(_, v)| x.0 <= v && v <= x.1) {
        let value = format!(" = {speed:.2}");
        let width = text_width(&format!("vw{value}"), LABEL_TEXT);
        let middle = LEFT + (speed - x.0) / (x.1 - x.0) * WIDTH;
        let left = (middle - 0.5 * width).clamp(LEFT, LEFT + WIDTH - width);
        let span = (left, left + width);
        let touches = |other: &&Label| other.span.0 < span.1 + 8.0 && span.0 < other.span.1 + 8.0;
        let taken: Vec<usize> = labels.iter().filter(touches).map(|o| o.row).collect();
        let row = (0..).find(|row| !taken.contains(row)).unwrap_or(0);
        labels.push(Label { speed, index, value, span, row });
    }
    labels
}
