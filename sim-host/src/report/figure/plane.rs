//! Figure of a basin over steer rate and roll rate at one speed.

use super::basin_axes::{AREA, LEGEND_GAP, height};
use super::canvas::{Canvas, Stroke};
use super::colour::{BASIN, GREY, INK, ISLAND, SHADES, shade};
use super::legend::{Sign, entry, rows, triangle};
use super::panel::Panel;
use super::picture::Picture;
use super::scale::nice;
use super::time_scale::TimeScale;
use crate::basin::{Basin, Plane};

/// Data of the figure.
#[derive(Clone, Copy, Debug)]
pub struct PlaneFigure<'a> {
    /// Title above the figure.
    pub title: &'a str,
    /// The plane.
    pub plane: &'a Plane,
}

/// Reach of the figure as a multiple of the outline's reach.
const MARGIN: f64 = 1.35;

/// Draws the inside filled, falls in the colour of their time, islands as separate dots.
pub fn plane(figure: &PlaneFigure) -> Picture {
    let plane = figure.plane;
    let outline = plane.outline();
    let reach = |of: fn(&(f64, f64)) -> f64, most: f64| {
        let reached = outline.iter().map(of).fold(0.0, f64::max);
        let end = if reached > 0.0 { (MARGIN * reached).min(most) } else { most };
        nice([-end, end], 6).1.min(most)
    };
    let largest = |of: fn(&crate::basin::Ray) -> f64| plane.rays.iter().map(of).fold(0.0, f64::max);
    let x = reach(|p| p.0, largest(|ray| ray.steer_rate.abs()));
    let y = reach(|p| p.1, largest(|ray| ray.roll_rate.abs()));
    let panel = Panel { area: AREA, x: (-x, x), y: (-y, y) };
    let all = Basin { columns: plane.rays.iter().map(|ray| ray.column.clone()).collect() };
    let scale = TimeScale::new(&all);
    let (falls, stays) = dots(plane, &panel, &scale);
    let mut legend = vec![entry(Sign::Fill(BASIN, 1.0), "basin of attraction")];
    if !stays.is_empty() {
        legend.push(entry(Sign::Fill(ISLAND, 1.0), "beyond a ride that falls, but does not fall itself"));
    }
    let capped = || plane.rays.iter().filter(|ray| ray.column.capped);
    if capped().next().is_some() {
        legend.push(entry(Sign::Triangle(INK), "no fall up to the largest rates tried"));
    }
    let mut canvas = Canvas::new(AREA.right() + 92.0, height(&legend));
    canvas.title((AREA.x, 26.0), AREA.width, figure.title);
    let mut closed: Vec<_> = outline.iter().map(|&p| panel.at(p)).collect();
    closed.extend(closed.first().copied());
    canvas.clipped(panel.area, |canvas| {
        for (i, centres) in falls.iter().enumerate().filter(|(_, centres)| !centres.is_empty()) {
            canvas.dots(centres, 1.6, &shade(i));
        }
        canvas.dots(&stays, 1.8, ISLAND);
        canvas.polygon(&closed, BASIN, 1.0);
        canvas.line(&closed, Stroke::solid(INK, 1.6));
        for axis in [[(-x, 0.0), (x, 0.0)], [(0.0, -y), (0.0, y)]] {
            canvas.line(&axis.map(|p| panel.at(p)), Stroke::solid(GREY, 0.7));
        }
    });
    for (steer, roll) in capped().map(|ray| ray.at(ray.column.upper)) {
        for end in [(steer, roll), (-steer, -roll)] {
            triangle(&mut canvas, panel.at(end), INK);
        }
    }
    panel.frame(&mut canvas, Some("Initial steer rate [rad/s]"), "Initial roll rate [rad/s]");
    rows(&mut canvas, &legend, (AREA.x, AREA.bottom() + LEGEND_GAP), AREA.width);
    scale.bar(&mut canvas, AREA);
    canvas.finish()
}

/// Positions of dots, in pixels.
type Dots = Vec<(f64, f64)>;

/// The falls by shade, and the rides beyond the outline that do not fall; with mirror images.
fn dots(plane: &Plane, panel: &Panel, scale: &TimeScale) -> (Vec<Dots>, Dots) {
    let (mut falls, mut stays) = (vec![Vec::new(); SHADES], Vec::new());
    for ray in &plane.rays {
        for point in ray.column.scan.iter().filter(|p| p.rate > ray.column.upper) {
            let (steer, roll) = ray.at(point.rate);
            let both = [(steer, roll), (-steer, -roll)].map(|p| panel.at(p));
            match point.outcome.time_to_fall_s() {
                Some(time) => falls[scale.shade_of(time)].extend(both),
                None => stays.extend(both),
            }
        }
    }
    (falls, stays)
}
