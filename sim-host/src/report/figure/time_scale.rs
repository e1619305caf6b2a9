//! Colour scale of times to fall.

use super::canvas::{Area, Canvas, Stroke};
use super::colour::{INK, SHADES, shade};
use crate::basin::Basin;
use kuva::render::render::TextAnchor;

/// Round times \[s\] at which a scale can end.
const ROUND: [f64; 16] =
    [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0];
/// Width of the bar beside the axes \[pixels\].
const WIDTH: f64 = 14.0;

/// A logarithmic scale between two round times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeScale {
    from: f64,
    to: f64,
}

impl TimeScale {
    /// A scale for the falls of a basin.
    pub(super) fn new(basin: &Basin) -> Self {
        let times = || basin.columns.iter().flat_map(|c| &c.scan).filter_map(|p| p.outcome.time_to_fall_s());
        let (least, most) = (times().fold(1.0, f64::min), times().fold(1.0, f64::max));
        Self {
            from: ROUND.into_iter().rfind(|&t| t < least).unwrap_or(ROUND[0]),
            to: ROUND.into_iter().find(|&t| t >= most).unwrap_or(ROUND[ROUND.len() - 1]),
        }
    }

    /// Position of a time on the scale, 0 to 1.
    fn along(&self, time: f64) -> f64 {
        (libm::log(time / self.from) / libm::log(self.to / self.from)).clamp(0.0, 1.0)
    }

    /// Index of a time's shade.
    pub(super) fn shade_of(&self, time: f64) -> usize {
        ((self.along(time) * SHADES as f64) as usize).min(SHADES - 1)
    }

    /// The scale as a bar, right of `axes`.
    pub(super) fn bar(&self, canvas: &mut Canvas, axes: Area) {
        let x = axes.right() + 18.0;
        let ink = Stroke::solid(INK, 1.0);
        let step = axes.height / SHADES as f64;
        for i in 0..SHADES {
            // A pixel of overlap hides the seams.
            let overlap = if i > 0 { 1.0 } else { 0.0 };
            let y = axes.bottom() - (i + 1) as f64 * step;
            canvas.rect(Area { x, y, width: WIDTH, height: step + overlap }, &*shade(i), 1.0);
        }
        for time in ROUND.into_iter().filter(|&t| t >= self.from && t <= self.to) {
            let y = axes.bottom() - self.along(time) * axes.height;
            canvas.line(&[(x + WIDTH, y), (x + WIDTH + 4.0, y)], ink);
            canvas.text((x + WIDTH + 7.0, y + 4.0), 12, TextAnchor::Start, &time.to_string());
        }
        canvas.text_upwards((x + WIDTH + 48.0, axes.y + 0.5 * axes.height), 13, "Time to fall [s]");
    }
}
