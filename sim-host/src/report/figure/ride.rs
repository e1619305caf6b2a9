//! Figure of a ride over time.

use super::canvas::{Area, Canvas, Stroke};
use super::colour::{FALL, GREY, SERIES};
use super::legend::{Sign, column, entry};
use super::panel::Panel;
use super::picture::Picture;
use super::scale::nice;
use super::thin::thinned;
use crate::ride::{Outcome, TracePoint};
use control::ActiveLimits;
use kuva::render::render::TextAnchor;

/// Data of the figure.
#[derive(Clone, Copy, Debug)]
pub struct RideFigure<'a> {
    /// Title above the figure.
    pub title: &'a str,
    /// The ride.
    pub trace: &'a [TracePoint],
    /// Its outcome.
    pub outcome: Outcome,
}

impl RideFigure<'_> {
    /// End of the ride \[s\], including the last control period.
    pub(in crate::report) fn end(&self) -> f64 {
        let end = match (self.outcome.time_to_fall_s(), self.trace) {
            (Some(t), _) => t,
            (None, [.., before, last]) => last.t + (last.t - before.t),
            _ => 1.0,
        };
        // Rounded to a microsecond; otherwise a rounding error could hide the last tick.
        (end * 1e6).round().max(1.0) / 1e6
    }
}

const LEFT: f64 = 70.0;
const TOP: f64 = 56.0;
const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 128.0;
const GAP: f64 = 16.0;
const LEGEND: f64 = 186.0;

/// A curve's name and its values.
pub(in crate::report) type Curve = (&'static str, fn(&TracePoint) -> f64);

const ROWS: [(&str, &[Curve]); 4] = [
    ("Angle [deg]", &[("roll", |p| p.roll.to_degrees()), ("steer", |p| p.steer.to_degrees())]),
    ("Rate [rad/s]", &[("roll rate", |p| p.roll_rate), ("steer rate", |p| p.steer_rate)]),
    ("Speed [m/s]", &[("front wheel", |p| p.front_speed), ("rear wheel", |p| p.rear_speed)]),
    ("Torque [N m]", &[("assist", |p| p.torque), ("rider", |p| p.rider_torque)]),
];

/// Limits with their names and colours.
const LIMITS: [(ActiveLimits, &str, &str); 3] = [
    (ActiveLimits::TAPER, "low-speed taper", SERIES[3]),
    (ActiveLimits::MAGNITUDE, "largest torque", SERIES[1]),
    (ActiveLimits::RATE, "rate of change", SERIES[2]),
];

/// Draws angles, rates, wheel speeds and torque over time, and the times at which limits changed the torque.
pub fn ride(figure: &RideFigure) -> Picture {
    let fall = figure.outcome.time_to_fall_s();
    // Space to the right, so that a fall is not drawn on the frame.
    let x = (0.0, figure.end() * if fall.is_some() { 1.03 } else { 1.0 });
    let rows = ROWS.len() as f64;
    let bottom = TOP + rows * HEIGHT + (rows - 1.0) * GAP;
    let mut canvas = Canvas::new(LEFT + WIDTH + LEGEND, bottom + 52.0);
    canvas.title((LEFT, 26.0), WIDTH + LEGEND - 12.0, figure.title);
    for (i, (label, curves)) in ROWS.iter().enumerate() {
        let area = Area { x: LEFT, y: TOP + i as f64 * (HEIGHT + GAP), width: WIDTH, height: HEIGHT };
        let values = || curves.iter().flat_map(|(_, of)| figure.trace.iter().map(of));
        let panel = Panel { area, x, y: padded(nice(values(), 4)) };
        let mut legend = Vec::new();
        let last = i + 1 == ROWS.len();
        if last {
            legend.extend(limits(&mut canvas, &panel, figure.trace));
        }
        if panel.y.0 < 0.0 && 0.0 < panel.y.1 {
            panel.line(&mut canvas, [(x.0, 0.0), (x.1, 0.0)], Stroke::solid(GREY, 0.7));
        }
        for (k, (name, of)) in curves.iter().enumerate() {
            // There is no rider.
            if *name == "rider" && figure.trace.iter().all(|p| p.rider_torque == 0.0) {
                continue;
            }
            let stroke = Stroke::solid(SERIES[k], 1.8);
            let points = figure.trace.iter().map(|p| (p.t, of(p)));
            panel.line(&mut canvas, thinned(points, x.1 / WIDTH), stroke);
            legend.insert(k, entry(Sign::Line(stroke), *name));
        }
        if let Some(t) = fall {
            panel.vertical(&mut canvas, t, Stroke::dashed(FALL, 1.4));
        }
        panel.frame(&mut canvas, last.then_some("Time [s]"), label);
        column(&mut canvas, &legend, (area.right() + 14.0, area.y));
    }
    let ending = match fall {
        Some(t) => format!("falls at {t:.3} s"),
        None => figure.outcome.name().into(),
    };
    canvas.text((LEFT + WIDTH, TOP - 8.0), 12, TextAnchor::End, &ending);
    canvas.finish()
}

/// A range with a margin above and below, for lines at its ends.
pub(super) fn padded((low, high): (f64, f64)) -> (f64, f64) {
    let room = 0.06 * (high - low);
    (low - room, high + room)
}

/// Marks along the lower edge when limits were active; returns the legend of those limits.
fn limits(canvas: &mut Canvas, panel: &Panel, trace: &[TracePoint]) -> Vec<super::legend::Entry> {
    let mut legend = Vec::new();
    let mut y = panel.area.bottom();
    for (limit, name, color) in LIMITS {
        let spans = active(trace, limit);
        if spans.is_empty() {
            continue;
        }
        y -= 5.0;
        for (from, to) in spans {
            let (left, right) = (panel.x(from), panel.x(to));
            let area = Area { x: left, y, width: (right - left).max(0.75), height: 4.0 };
            canvas.rect(area, color, 1.0);
        }
        legend.push(entry(Sign::Fill(color, 1.0), format!("limit: {name}")));
    }
    legend
}

/// Time intervals in which a limit was active \[s\].
fn active(trace: &[TracePoint], limit: ActiveLimits) -> Vec<(f64, f64)> {
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut open = false;
    for (i, point) in trace.iter().enumerate() {
        let on = ActiveLimits(point.limits).contains(limit);
        // The torque of a control period is held until the next one.
        let until = trace.get(i + 1).map_or(point.t, |next| next.t);
        match spans.last_mut() {
            Some(span) if on && open => span.1 = until,
            _ if on => spans.push((point.t, until)),
            _ => {}
        }
        open = on;
    }
    spans
}
