//! Markers at single points.

use super::canvas::{Canvas, Stroke};
use std::f64::consts::TAU;

/// Shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A filled circle.
    Dot,
    /// A small filled circle, for many points.
    Point,
    /// A circle.
    Ring,
    /// A filled square.
    Square,
    /// A filled triangle.
    Triangle,
    /// A diagonal cross.
    Cross,
}

/// Draws equal marks at `centres`, in pixels.
pub(super) fn mark(canvas: &mut Canvas, centres: &[(f64, f64)], marker: Marker, color: &'static str) {
    let stroke = Stroke::solid(color, 1.5);
    let shape = |canvas: &mut Canvas, corners: &[(f64, f64)]| {
        for &(x, y) in centres {
            let moved: Vec<_> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
            canvas.polygon(&moved, color, 1.0);
        }
    };
    match marker {
        Marker::Dot => canvas.dots(centres, 3.2, color),
        Marker::Point => canvas.dots(centres, 1.8, color),
        Marker::Square => shape(canvas, &[(-3.2, -3.2), (3.2, -3.2), (3.2, 3.2), (-3.2, 3.2)]),
        Marker::Triangle => shape(canvas, &[(0.0, -4.0), (4.0, 3.2), (-4.0, 3.2)]),
        Marker::Ring => {
            for &(x, y) in centres {
                let on = |i: i32| {
                    let (s, c) = libm::sincos(TAU * f64::from(i) / 16.0);
                    (x + 3.4 * c, y + 3.4 * s)
                };
                canvas.line(&(0..=16).map(on).collect::<Vec<_>>(), stroke);
            }
        }
        Marker::Cross => {
            for &(x, y) in centres {
                canvas.line(&[(x - 3.5, y - 3.5), (x + 3.5, y + 3.5)], stroke);
                canvas.line(&[(x - 3.5, y + 3.5), (x + 3.5, y - 3.5)], stroke);
            }
        }
    }
}
