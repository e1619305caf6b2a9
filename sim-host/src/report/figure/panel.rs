//! A pair of axes that maps data to an area of the canvas.

use super::canvas::{Area, Canvas, Stroke};
use super::colour::{INK, STABLE};
use super::scale::ticks;
use super::shape::text_width;
use kuva::render::render::TextAnchor;

const TICK_TEXT: u32 = 12;
const LABEL_TEXT: u32 = 13;
/// Distance from the labels at the left to the axis, equal in all panels.
const LABEL_GAP: f64 = 46.0;

/// A range of data over an area of the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Panel {
    pub(super) area: Area,
    /// Data values at the left and right edge.
    pub(super) x: (f64, f64),
    /// Data values at the bottom and top edge.
    pub(super) y: (f64, f64),
}

impl Panel {
    pub(super) fn x(&self, x: f64) -> f64 {
        self.area.x + (x - self.x.0) / (self.x.1 - self.x.0) * self.area.width
    }

    pub(super) fn y(&self, y: f64) -> f64 {
        self.area.bottom() - (y - self.y.0) / (self.y.1 - self.y.0) * self.area.height
    }

    pub(super) fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.x(x), self.y(y))
    }

    /// The area of a rectangle of data, in pixels.
    pub(super) fn span(&self, x: (f64, f64), y: (f64, f64)) -> Area {
        let (left, top) = self.at((x.0, y.1));
        let (right, bottom) = self.at((x.1, y.0));
        Area { x: left, y: top, width: right - left, height: bottom - top }
    }

    /// A line through data, clipped to the frame.
    pub(super) fn line(
        &self,
        canvas: &mut Canvas,
        data: impl IntoIterator<Item = (f64, f64)>,
        stroke: Stroke,
    ) {
        let points: Vec<_> = data.into_iter().map(|p| self.at(p)).collect();
        canvas.clipped(self.area, |canvas| canvas.line(&points, stroke));
    }

    /// A shaded range of x, over the whole height.
    pub(super) fn shade_x(&self, canvas: &mut Canvas, range: (f64, f64)) {
        let range = (range.0.max(self.x.0), range.1.min(self.x.1));
        if range.0 < range.1 {
            canvas.rect(self.span(range, self.y), STABLE, 0.3);
        }
    }

    /// A line over the whole height, if `x` is in range.
    pub(super) fn vertical(&self, canvas: &mut Canvas, x: f64, stroke: Stroke) {
        if self.x.0 <= x && x <= self.x.1 {
            canvas.line(&[(self.x(x), self.area.bottom()), (self.x(x), self.area.y)], stroke);
        }
    }

    /// The frame with ticks, numbers and labels; without an `x_label`, the numbers below are omitted.
    pub(super) fn frame(&self, canvas: &mut Canvas, x_label: Option<&str>, y_label: &str) {
        let Area { width, height, .. } = self.area;
        let along = [ticks(self.x, (width / 70.0) as usize), ticks(self.y, (height / 50.0) as usize)];
        self.frame_with(canvas, &along, x_label, y_label);
    }

    /// The frame with the given ticks (position and text) along x and y.
    pub(super) fn frame_with(
        &self,
        canvas: &mut Canvas,
        [along_x, along_y]: &[Vec<(f64, String)>; 2],
        x_label: Option<&str>,
        y_label: &str,
    ) {
        let Area { x, y, width, height } = self.area;
        let ink = Stroke::solid(INK, 1.0);
        let corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y)];
        canvas.line(&corners, ink);
        let bottom = y + height;
        for (v, number) in along_x {
            let at = self.x(*v);
            canvas.line(&[(at, bottom), (at, bottom + 4.0)], ink);
            if x_label.is_some() {
                canvas.text((at, bottom + 17.0), TICK_TEXT, TextAnchor::Middle, number);
            }
        }
        for (v, number) in along_y {
            let at = self.y(*v);
            canvas.line(&[(x - 4.0, at), (x, at)], ink);
            canvas.text((x - 7.0, at + 4.0), TICK_TEXT, TextAnchor::End, number);
        }
        if let Some(label) = x_label {
            canvas.text((x + 0.5 * width, bottom + 36.0), LABEL_TEXT, TextAnchor::Middle, label);
        }
        let widest = along_y.iter().map(|(_, number)| text_width(number, TICK_TEXT)).fold(0.0, f64::max);
        canvas.text_upwards((x - LABEL_GAP.max(widest + 16.0), y + 0.5 * height), LABEL_TEXT, y_label);
    }
}
