//! Data of a figure of basins, and the axes of its two forms.

use super::canvas::{Area, Canvas};
use super::colour::{INK, STABLE};
use super::legend::{Entry, Sign, entry, rows_height, triangle};
use super::panel::Panel;
use crate::basin::{Axis, Basin};

/// Data of the figure.
#[derive(Clone, Copy, Debug)]
pub struct BasinFigure<'a> {
    /// Title above the figure.
    pub title: &'a str,
    /// Names and basins. A single basin is drawn with inside and outside, several as outlines.
    pub series: &'a [(&'a str, &'a Basin)],
    /// Weave and capsize speed of the uncontrolled bicycle, the ends of its self-stable range \[m/s\].
    pub self_stable: Option<(f64, f64)>,
    /// The disturbed rate.
    pub axis: Axis,
    /// Largest disturbance tried \[rad/s\].
    pub cap: f64,
    /// A band of heights around one basin.
    pub band: Option<Band<'a>>,
}

/// A band of heights over speed.
#[derive(Clone, Copy, Debug)]
pub struct Band<'a> {
    /// Name in the legend.
    pub label: &'a str,
    /// Speed \[m/s\], lower and upper edge \[rad/s\].
    pub edges: &'a [(f64, f64, f64)],
}

/// Area of the axes.
pub(super) const AREA: Area = Area { x: 66.0, y: 44.0, width: 600.0, height: 380.0 };
/// Distance from the axes to the legend.
pub(super) const LEGEND_GAP: f64 = 50.0;
/// The height of a figure with this legend.
pub(super) fn height(legend: &[Entry]) -> f64 {
    AREA.bottom() + LEGEND_GAP + rows_height(legend, AREA.width) + 12.0
}
/// The label of the speeds.
pub(super) const SPEED: &str = "Forward speed v [m/s]";

impl BasinFigure<'_> {
    /// The label of the disturbances.
    pub(super) fn rate_label(&self) -> &'static str {
        match self.axis {
            Axis::SteerRate => "Initial steer rate [rad/s]",
            Axis::RollRate => "Initial roll rate [rad/s]",
        }
    }

    /// Axes over the range of `speeds`, and up to slightly more than `top`.
    pub(super) fn panel(&self, speeds: impl Iterator<Item = f64>, top: f64) -> Panel {
        let (low, high) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| (r.0.min(v), r.1.max(v)));
        let x = match (low, high) {
            _ if low < high => (low, high),
            _ if low == high => (low - 0.5, low + 0.5),
            _ => (0.0, 10.0),
        };
        Panel { area: AREA, x, y: (0.0, if top > 0.0 { 1.015 * top } else { 1.0 }) }
    }

    /// The legend's entry of the self-stable range, if there is one.
    pub(super) fn stable_entry(&self) -> Option<Entry> {
        let (from, to) = self.self_stable?;
        let label = format!("uncontrolled: self-stable, {from:.2}–{to:.2} m/s");
        Some(entry(Sign::Fill(STABLE, 0.3), label))
    }
}

/// Triangles along the upper edge where nothing fell, at a minimum distance.
pub(super) fn caps(canvas: &mut Canvas, panel: &Panel, basin: &Basin) {
    let mut last = f64::NEG_INFINITY;
    for column in basin.columns.iter().filter(|c| c.capped) {
        let (x, y) = panel.at((column.speed, column.upper));
        if x - last >= 11.0 {
            triangle(canvas, (x, y + 3.0), INK);
            last = x;
        }
    }
}
