//! Charts: panels in a grid, each with curves and markers, and a common legend below.

use super::canvas::{Area, Canvas, Dash, Stroke};
use super::chart_axes::{Axis, Fitted};
use super::colour::{GREY, INK, SERIES, STABLE};
use super::legend::{Entry, Sign, entry, rows, rows_height};
use super::marker::{Marker, mark};
use super::panel::Panel;
use super::picture::Picture;
use kuva::render::render::TextAnchor;

/// A figure of panels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Title above the figure.
    pub title: String,
    /// Number of panels side by side.
    pub columns: usize,
    /// The panels, row by row.
    pub plots: Vec<Plot>,
    /// Meaning of the shaded ranges; empty without any.
    pub shaded: String,
}

/// A panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Title above the panel.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series; later ones are drawn over earlier ones.
    pub series: Vec<Series>,
    /// Shaded ranges of x.
    pub shaded: Vec<(f64, f64)>,
    /// Thin vertical lines.
    pub verticals: Vec<f64>,
}

/// Points of one series. A point with NaN interrupts the line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; listed once if several panels have it, omitted if empty.
    pub name: String,
    /// The data.
    pub points: Vec<(f64, f64)>,
    /// Its style.
    pub look: Look,
}

/// Line style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// No line, markers only.
    None,
    /// Unbroken.
    Solid,
    /// In dashes.
    Dashed,
    /// In dots.
    Dotted,
    /// Thin and grey, whatever the colour, for the background.
    Faint,
    /// No line; the area between the points and zero is filled.
    Filled,
}

/// Style of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Index of the colour, modulo the palette.
    pub colour: usize,
    /// The line.
    pub line: Line,
    /// The marker at every point.
    pub marker: Option<Marker>,
}

impl Look {
    /// A line without markers.
    pub fn line(colour: usize, line: Line) -> Self {
        Self { colour, line, marker: None }
    }

    /// Markers without a line.
    pub fn marks(colour: usize, marker: Marker) -> Self {
        Self { colour, line: Line::None, marker: Some(marker) }
    }

    fn stroke(&self) -> Stroke {
        let color = SERIES[self.colour % SERIES.len()];
        match self.line {
            Line::Faint => Stroke::solid(GREY, 1.1),
            Line::Dashed => Stroke { color, width: 1.9, dash: Dash::Dashed },
            Line::Dotted => Stroke { color, width: 2.1, dash: Dash::Dotted },
            Line::None | Line::Solid | Line::Filled => Stroke::solid(color, 1.9),
        }
    }

    fn sign(&self) -> Sign {
        match (self.line, self.marker) {
            (Line::Filled, _) => Sign::Fill(self.stroke().color, FILLED),
            (line, Some(marker)) => Sign::Marked(marker, self.stroke(), line != Line::None),
            _ => Sign::Line(self.stroke()),
        }
    }
}

impl Series {
    /// A named series.
    pub fn new(name: impl Into<String>, look: Look, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, look }
    }
}

/// Opacity of a filled area.
const FILLED: f64 = 0.25;
const LEFT: f64 = 76.0;
const TITLE: f64 = 40.0;
const PLOT_TITLE: f64 = 22.0;
const BELOW: f64 = 48.0;

/// Width and height of a panel, by the number of columns.
fn size(columns: usize) -> (f64, f64) {
    match columns {
        0 | 1 => (600.0, 290.0),
        2 => (330.0, 210.0),
        _ => (250.0, 170.0),
    }
}

/// Draws a chart.
pub fn chart(chart: &Chart) -> Picture {
    let columns = chart.columns.clamp(1, chart.plots.len().max(1));
    let (width, height) = size(columns);
    let titled = chart.plots.iter().any(|p| !p.title.is_empty());
    let above = if titled { PLOT_TITLE } else { 4.0 };
    let (across, down) = (LEFT + width, above + height + BELOW);
    let lines = chart.plots.len().div_ceil(columns);
    let whole = across * columns as f64 - LEFT;
    let legend = legend(chart);
    let legend_y = TITLE + down * lines as f64 + 4.0;
    let bottom = legend_y + rows_height(&legend, whole) + 12.0;
    let mut canvas = Canvas::new(LEFT + whole + 24.0, bottom);
    canvas.title((LEFT, 26.0), whole, &chart.title);
    for (i, plot) in chart.plots.iter().enumerate() {
        let (column, line) = ((i % columns) as f64, (i / columns) as f64);
        let area = Area { x: LEFT + across * column, y: TITLE + down * line + above, width, height };
        draw(&mut canvas, plot, area);
    }
    rows(&mut canvas, &legend, (LEFT, legend_y), whole);
    canvas.finish()
}

/// Legend entries, each name once.
fn legend(chart: &Chart) -> Vec<Entry> {
    let mut names: Vec<&str> = vec![""];
    let mut entries = Vec::new();
    for series in chart.plots.iter().flat_map(|p| &p.series) {
        if !names.contains(&series.name.as_str()) {
            names.push(&series.name);
            entries.push(entry(series.look.sign(), series.name.clone()));
        }
    }
    if !chart.shaded.is_empty() {
        entries.push(entry(Sign::Fill(STABLE, 0.3), chart.shaded.clone()));
    }
    entries
}

fn draw(canvas: &mut Canvas, plot: &Plot, area: Area) {
    let values = |of: fn(&(f64, f64)) -> f64| plot.series.iter().flat_map(|s| &s.points).map(of);
    let (x, y) = (Fitted::new(&plot.x, values(|p| p.0), false), Fitted::new(&plot.y, values(|p| p.1), true));
    let panel = Panel { area, x: x.range, y: y.range };
    for &(from, to) in &plot.shaded {
        if let (Some(from), Some(to)) = (x.place(from), x.place(to)) {
            panel.shade_x(canvas, (from, to));
        }
    }
    for at in plot.verticals.iter().filter_map(|&v| x.place(v)) {
        panel.vertical(canvas, at, Stroke::dashed(GREY, 0.9));
    }
    if !plot.y.log && panel.y.0 < 0.0 && 0.0 < panel.y.1 {
        panel.line(canvas, [(panel.x.0, 0.0), (panel.x.1, 0.0)], Stroke::solid(GREY, 0.7));
    }
    for series in &plot.series {
        let place = |&(a, b): &(f64, f64)| x.place(a).zip(y.place(b)).map(|p| panel.at(p));
        let places: Vec<Option<(f64, f64)>> = series.points.iter().map(place).collect();
        let pieces: Vec<Vec<(f64, f64)>> =
            places.split(Option::is_none).map(|piece| piece.iter().flatten().copied().collect()).collect();
        canvas.clipped(area, |canvas| draw_series(canvas, series.look, &pieces, panel.y(0.0)));
    }
    let ticks = [x.ticks(area.width, 60.0), y.ticks(area.height, 42.0)];
    panel.frame_with(canvas, &ticks, Some(&plot.x.label), &plot.y.label);
    if !plot.title.is_empty() {
        canvas.text((area.x + 0.5 * area.width, area.y - 7.0), 12, TextAnchor::Middle, &plot.title);
    }
}

/// Draws the continuous `pieces` of a series, in pixels; `zero` is the pixel height of y = 0.
fn draw_series(canvas: &mut Canvas, look: Look, pieces: &[Vec<(f64, f64)>], zero: f64) {
    for piece in pieces {
        match (look.line, &piece[..]) {
            (Line::None, _) => {}
            (Line::Filled, [first, .., last]) => {
                let corners = [&[(first.0, zero)], &piece[..], &[(last.0, zero)]].concat();
                canvas.polygon(&corners, look.stroke().color, FILLED);
                canvas.line(piece, Stroke::solid(INK, 0.7));
            }
            _ => canvas.line(piece, look.stroke()),
        }
        if let Some(marker) = look.marker {
            mark(canvas, piece, marker, look.stroke().color);
        }
    }
}
