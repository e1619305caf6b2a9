//! Heat maps: a number over two axes of named values, evenly spaced.

use super::canvas::{Area, Canvas, Stroke};
use super::colour::{GREY, INK, SHADES, shade};
use super::legend::triangle;
use super::panel::Panel;
use super::picture::Picture;
use super::scale::{nice, ticks};
use super::shape::text_width;
use crate::basin::Bound;
use kuva::render::render::TextAnchor;

/// Heat maps side by side, with a common colour scale.
#[derive(Clone, Debug)]
pub struct HeatMap<'a> {
    /// Title above the figure.
    pub title: &'a str,
    /// The number's name and unit.
    pub label: &'a str,
    /// Name and values of the horizontal axis.
    pub x: (&'a str, &'a [String]),
    /// Name and values of the vertical axis.
    pub y: (&'a str, &'a [String]),
    /// The maps: a title, and the numbers row by row from below; `None` if unknown.
    pub maps: &'a [(String, Map)],
    /// Level of the contour line, as a fraction of a map's largest number; not drawn if a number involved is only a
    /// bound.
    pub contour: f64,
}

/// Numbers row by row, each with the kind of bound it is.
pub type Map = Vec<Vec<Option<(f64, Bound)>>>;

const LEFT: f64 = 86.0;
const TOP: f64 = 62.0;
const BELOW: f64 = 78.0;
const BAR: f64 = 14.0;

/// Draws a rectangle for every number; unknown ones stay grey.
pub fn heatmap(figure: &HeatMap) -> Picture {
    let columns = figure.maps.len().clamp(1, 3);
    let (width, height) = [(460.0, 340.0), (320.0, 260.0), (250.0, 210.0)][columns - 1];
    let lines = figure.maps.len().div_ceil(columns);
    let whole = (LEFT + width) * columns as f64 - LEFT;
    let below = TOP + (height + BELOW) * lines as f64 - 8.0;
    let mut canvas = Canvas::new(LEFT + whole + 96.0, below + 14.0);
    canvas.title((LEFT, 26.0), whole, figure.title);
    let numbers = || figure.maps.iter().flat_map(|(_, rows)| rows.iter().flatten().flatten());
    let range = nice(numbers().map(|n| n.0).chain([0.0]), 6);
    for (i, (title, map)) in figure.maps.iter().enumerate() {
        let (column, line) = ((i % columns) as f64, (i / columns) as f64);
        let area =
            Area { x: LEFT + (LEFT + width) * column, y: TOP + (height + BELOW) * line, width, height };
        canvas.text((area.x + 0.5 * width, area.y - 8.0), 12, TextAnchor::Middle, title);
        draw(&mut canvas, figure, map, area, range);
    }
    let mut line = format!("White line: {} % of the map's largest", 100.0 * figure.contour);
    if !numbers().all(|n| n.1.is_measured()) {
        line += "; triangle: at least this, and no line in its map";
    }
    canvas.text((LEFT, below), 12, TextAnchor::Start, &line);
    let last = Area { x: LEFT, y: TOP, width: whole, height };
    bar(&mut canvas, last, range, figure.label);
    canvas.finish()
}

/// Visible on dark shades, and by its dark edges on light ones.
const LINE: &str = "#ffffff";

/// Shade of a number in a range.
fn shade_of(x: f64, (low, high): (f64, f64)) -> usize {
    (((x - low) / (high - low) * SHADES as f64) as usize).min(SHADES - 1)
}

fn draw(canvas: &mut Canvas, figure: &HeatMap, map: &Map, area: Area, range: (f64, f64)) {
    let (across, up) = (figure.x.1.len(), figure.y.1.len());
    // Cell i is centred at i.
    let panel = Panel { area, x: (-0.5, across as f64 - 0.5), y: (-0.5, up as f64 - 0.5) };
    canvas.rect(area, GREY, 0.4);
    canvas.clipped(area, |canvas| {
        for (j, row) in map.iter().enumerate() {
            for (i, (x, bound)) in row.iter().enumerate().filter_map(|(i, x)| Some((i, (*x)?))) {
                let (i, j) = (i as f64, j as f64);
                let cell = panel.span((i - 0.5, i + 0.5), (j - 0.5, j + 0.5));
                // Half a pixel of overlap hides the seams.
                let cell = Area { width: cell.width + 0.5, height: cell.height + 0.5, ..cell };
                canvas.rect(cell, &*shade(shade_of(x, range)), 1.0);
                if !bound.is_measured() {
                    let (x, y) = panel.at((i, j));
                    triangle(canvas, (x, y - 3.5), LINE);
                }
            }
        }
    });
    let pieces = contour_of(map, figure.contour);
    canvas.clipped(area, |canvas| {
        for (color, width) in [(INK, 3.4), (LINE, 2.2)] {
            for piece in &pieces {
                canvas.line(&piece.map(|p| panel.at(p)), Stroke::solid(color, width));
            }
        }
    });
    let names = |names: &[String], room: f64, wide: bool| {
        let size = |name: &String| if wide { text_width(name, 12) + 8.0 } else { 16.0 };
        let widest = names.iter().map(size).fold(1.0, f64::max);
        let step = (widest * names.len() as f64 / room).ceil().max(1.0) as usize;
        let all = names.iter().enumerate().map(|(i, name)| (i as f64, name.clone()));
        all.step_by(step).collect::<Vec<_>>()
    };
    let along = [names(figure.x.1, area.width, true), names(figure.y.1, area.height, false)];
    panel.frame_with(canvas, &along, Some(figure.x.0), figure.y.0);
}

/// The colour scale as a bar, right of `axes`.
fn bar(canvas: &mut Canvas, axes: Area, range: (f64, f64), label: &str) {
    let x = axes.right() + 18.0;
    let step = axes.height / SHADES as f64;
    for i in 0..SHADES {
        let overlap = if i > 0 { 1.0 } else { 0.0 };
        let y = axes.bottom() - (i + 1) as f64 * step;
        canvas.rect(Area { x, y, width: BAR, height: step + overlap }, &*shade(i), 1.0);
    }
    for (value, name) in ticks(range, 6) {
        let y = axes.bottom() - (value - range.0) / (range.1 - range.0) * axes.height;
        canvas.line(&[(x + BAR, y), (x + BAR + 4.0, y)], Stroke::solid(INK, 1.0));
        canvas.text((x + BAR + 7.0, y + 4.0), 12, TextAnchor::Start, &name);
    }
    canvas.text_upwards((x + BAR + 52.0, axes.y + 0.5 * axes.height), 13, label);
}

/// The contour line at a fraction of the map's largest number; none if that number, or one to compare with it, is only
/// a bound.
fn contour_of(map: &Map, part: f64) -> Vec<[(f64, f64); 2]> {
    let numbers = || map.iter().flatten().flatten();
    if !numbers().all(|n| n.1.is_measured()) {
        return Vec::new();
    }
    let most = numbers().map(|n| n.0).fold(0.0, f64::max);
    let plain: Vec<Vec<Option<f64>>> =
        map.iter().map(|row| row.iter().map(|n| n.map(|n| n.0)).collect()).collect();
    contour(&plain, part * most)
}

/// The straight pieces of the line on which `map` equals `level`, in cells: linear between the centres of three
/// neighbours, two triangles per square, so that no saddle is ambiguous.
fn contour(map: &[Vec<Option<f64>>], level: f64) -> Vec<[(f64, f64); 2]> {
    let mut pieces = Vec::new();
    let at = |i: usize, j: usize| Some(((i as f64, j as f64), (*map.get(j)?.get(i)?)? - level));
    let across = map.first().map_or(0, Vec::len);
    for j in 0..map.len() {
        for i in 0..across {
            for corners in [[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i, j + 1), (i + 1, j + 1)]] {
                let [Some(a), Some(b), Some(c)] = corners.map(|(i, j)| at(i, j)) else { continue };
                let crossed: Vec<_> = [(a, b), (b, c), (c, a)].into_iter().filter_map(crossing).collect();
                if let [from, to] = crossed[..] {
                    pieces.push([from, to]);
                }
            }
        }
    }
    pieces
}

/// A position and the number there.
type At = ((f64, f64), f64);

/// Position between two points at which a number changes its sign.
fn crossing(((p, a), (q, b)): (At, At)) -> Option<(f64, f64)> {
    let part = a / (a - b);
    ((a < 0.0) != (b < 0.0)).then_some((p.0 + part * (q.0 - p.0), p.1 + part * (q.1 - p.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_with_a_lower_bound_has_no_line() {
        let number = |x, capped| Some((x, Bound::of(capped)));
        let map = |capped| {
            vec![vec![number(0.0, false), number(4.0, capped)], vec![number(0.0, false), number(4.0, false)]]
        };
        assert_eq!((contour_of(&map(false), 0.25).len(), contour_of(&map(true), 0.25).len()), (2, 0));
    }

    #[test]
    fn a_contour_lies_between_the_numbers() {
        let map = [vec![Some(0.0), Some(4.0)], vec![Some(0.0), Some(4.0)]];
        let pieces = contour(&map, 1.0);
        assert_eq!(pieces.len(), 2);
        assert!(pieces.iter().flatten().all(|p| p.0 == 0.25), "{pieces:?}");
        assert!(contour(&map, 5.0).is_empty());
        assert!(contour(&[vec![Some(0.0), None], vec![Some(4.0), None]], 1.0).is_empty());
    }
}
