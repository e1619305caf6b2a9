//! Figure of a replay over time.

use super::canvas::{Area, Canvas, Stroke};
use super::colour::{FALL, GREY, SERIES};
use super::legend::{Sign, column, entry};
use super::panel::Panel;
use super::picture::Picture;
use super::ride::padded;
use super::scale::nice;
use super::thin::thinned;
use crate::replay::{CauseRecord, ModeRecord, Row};

/// Data of the figure.
#[derive(Clone, Copy, Debug)]
pub struct ReplayFigure<'a> {
    /// Title above the figure.
    pub title: &'a str,
    /// The rows of the table.
    pub rows: &'a [Row],
    /// The modes with their start times.
    pub modes: &'a [ModeRecord],
    /// The causes, whose alarms are marked.
    pub causes: &'a [CauseRecord],
}

const LEFT: f64 = 70.0;
const TOP: f64 = 56.0;
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 118.0;
const GAP: f64 = 16.0;
const LEGEND: f64 = 186.0;

/// A curve's name and its values; NaN without a value.
type Curve = (&'static str, fn(&Row) -> f64);

fn or_none(value: Option<f32>) -> f64 {
    value.map_or(f64::NAN, f64::from)
}

const PANELS: [(&str, &[Curve]); 5] = [
    (
        "Roll [deg]",
        &[
            ("estimated", |r| f64::from(r.roll).to_degrees()),
            ("the log's own", |r| r.log_roll.unwrap_or(f64::NAN).to_degrees()),
        ],
    ),
    (
        "Rate [rad/s]",
        &[("roll rate", |r| or_none(r.measured_roll_rate)), ("yaw rate", |r| or_none(r.measured_yaw_rate))],
    ),
    ("Steer [deg]", &[("steer", |r| or_none(r.measured_steer).to_degrees())]),
    (
        "Speed [m/s]",
        &[
            ("front wheel", |r| or_none(r.measured_front_speed)),
            ("rear wheel", |r| or_none(r.measured_rear_speed)),
        ],
    ),
    (
        "Torque [N m]",
        &[("commanded", |r| f64::from(r.torque)), ("the log's own", |r| r.log_torque.unwrap_or(f64::NAN))],
    ),
];

/// Draws roll, rates, steer, speeds and torque over time; modes with torque are shaded, alarms marked.
pub fn replay(figure: &ReplayFigure) -> Picture {
    let x = match figure.rows {
        [first, .., last] => (first.t, last.t),
        _ => (0.0, 1.0),
    };
    let rows = PANELS.len() as f64;
    let bottom = TOP + rows * HEIGHT + (rows - 1.0) * GAP;
    let mut canvas = Canvas::new(LEFT + WIDTH + LEGEND, bottom + 52.0);
    canvas.title((LEFT, 26.0), WIDTH + LEGEND - 12.0, figure.title);
    for (i, (label, curves)) in PANELS.iter().enumerate() {
        let area = Area { x: LEFT, y: TOP + i as f64 * (HEIGHT + GAP), width: WIDTH, height: HEIGHT };
        let there = |of: &fn(&Row) -> f64| figure.rows.iter().any(|row| of(row).is_finite());
        let values = || curves.iter().flat_map(|(_, of)| figure.rows.iter().map(of));
        let panel = Panel { area, x, y: padded(nice(values(), 4)) };
        let last = i + 1 == PANELS.len();
        let mut legend = Vec::new();
        for (k, mode) in figure.modes.iter().enumerate() {
            if mode.mode == "engaged" || mode.mode == "limp" {
                let until = figure.modes.get(k + 1).map_or(x.1, |next| next.from_s);
                panel.shade_x(&mut canvas, (mode.from_s, until));
            }
        }
        if panel.y.0 < 0.0 && 0.0 < panel.y.1 {
            panel.line(&mut canvas, [(x.0, 0.0), (x.1, 0.0)], Stroke::solid(GREY, 0.7));
        }
        for (k, (name, of)) in curves.iter().enumerate().filter(|(_, (_, of))| there(of)) {
            let stroke = Stroke::solid(SERIES[k], 1.4);
            let points = figure.rows.iter().map(|row| (row.t, of(row)));
            panel.line(&mut canvas, thinned(points, (x.1 - x.0) / WIDTH), stroke);
            legend.push(entry(Sign::Line(stroke), *name));
        }
        let alarm = Stroke::dashed(FALL, 1.0);
        for at_s in figure.causes.iter().flat_map(|cause| &cause.alarms_s) {
            panel.vertical(&mut canvas, *at_s, alarm);
        }
        if last && figure.causes.iter().any(|cause| cause.alarms > 0) {
            legend.push(entry(Sign::Line(alarm), "a cause begins"));
        }
        panel.frame(&mut canvas, last.then_some("Time [s]"), label);
        column(&mut canvas, &legend, (area.right() + 14.0, area.y));
    }
    canvas.finish()
}
