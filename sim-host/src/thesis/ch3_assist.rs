//! Section 3.4: rides and basins of the steer assist without a rider model.

use super::case::{Assisted, Case};
use super::ch3_laws::{CL2, CL3, CROSSES, cross_name};
use super::draw::{SELF_STABLE, SPEED, STEER_RATE, outline, over_time};
use super::heights::{between, coarse, exact, mean};
use super::item::{Figure, Item, Value};
use super::study::Study;
use crate::basin::Basin;
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::ride::{ScheduleSpeed, Start, TracePoint, traced};
use std::sync::Arc;

/// The basins of Figure 3.7.
pub(super) fn cases_3_7() -> Vec<Case> {
    vec![Case::of(Assisted::Cl1).mapped()]
}

/// Figure 3.7: the basin of CL1.
pub(super) fn figure_3_7(study: &Study) -> Item {
    let basin = study.basin(&Case::of(Assisted::Cl1).mapped());
    let caption = "Basin of attraction under CL1. Inside: rides of 6 s that do not fall; outside, the colour shows the \
                   time to the fall.";
    Item {
        figures: vec![Figure::of_basins("figure-3.7", caption, study, &[("CL1", &basin)])],
        ..Item::default()
    }
}

/// Figure 3.8: rides under CL1 around its weave speed.
pub(super) fn figure_3_8(study: &Study) -> Item {
    let conditions = Case::of(Assisted::Cl1).conditions(&study.bicycle);
    let speeds = [0.5, 0.75, 1.0, 1.25, 1.4, 1.7, 2.0];
    let rides: Vec<(f64, Vec<TracePoint>)> = speeds
        .iter()
        .map(|&v| {
            let start = Start { speed_m_s: v, steer_rate_rad_s: 0.1, roll_rate_rad_s: 0.0 };
            (v, traced(&conditions, start).1)
        })
        .collect();
    let series = |of: &dyn Fn(&TracePoint) -> (f64, f64)| {
        let one = |(i, (v, trace)): (usize, &(f64, Vec<TracePoint>))| {
            let points = trace.iter().step_by(10).map(of).collect();
            Series::new(format!("{v} m/s"), Look::line(i, Line::Solid), points)
        };
        rides.iter().enumerate().map(one).collect::<Vec<_>>()
    };
    let time = Plot {
        x: Axis::new("Time [s]"),
        y: Axis::new("Roll rate [rad/s]").over(-0.3, 0.3),
        series: series(&|p| (p.t, p.roll_rate)),
        ..Plot::default()
    };
    let phase = |roll: f64, rate: f64| Plot {
        x: Axis::new("Roll [rad]").over(-roll, roll),
        y: Axis::new("Roll rate [rad/s]").over(-rate, rate),
        series: series(&|p| (p.roll, p.roll_rate)),
        ..Plot::default()
    };
    let plots = vec![time, phase(0.1, 0.3), phase(0.01, 0.03)];
    let title = "CL1: roll rate after a steer rate of 0.1 rad/s".to_owned();
    let chart = Chart { title, columns: 2, plots, shaded: String::new() };
    let caption = "Nonlinear rides under CL1 after an initial steer rate of 0.1 rad/s, over time and in phase space; \
                   the last panel is a close-up of the origin. Below 1.36 m/s the motion grows.";
    Item { figures: vec![Figure::of_chart("figure-3.8", caption, &chart)], ..Item::default() }
}

/// The basins of Figure 3.10.
pub(super) fn cases_3_10() -> Vec<Case> {
    [Assisted::Alone].iter().chain(&CL2).map(|&law| Case::of(law)).collect()
}

/// Figure 3.10: the basins of CL2.
pub(super) fn figure_3_10(study: &Study) -> Item {
    let crosses = CROSSES.iter().map(|&(_, v)| (v, 8.0)).collect();
    let mut chart = basins(study, "CL2: basins of attraction", &CL2);
    chart.plots[0].series.push(Series::new("wanted: 8 rad/s", Look::marks(4, Marker::Cross), crosses));
    let points =
        CROSSES.iter().map(|&c| (cross_name(c), c)).chain([("CL2, K = 1 at 8.2 m/s".into(), (1, 8.2))]);
    let points: Vec<_> = points.collect();
    let values = Item::compare("figure-3.10", |cell| {
        let at = points.iter().find(|(name, _)| *name == cell.row);
        match at {
            Some(&(_, (k, speed))) => {
                height_at(study, Case::of(Assisted::Cl2(k)), speed, Value::new(cell, None))
            }
            None => Value::new(cell, None),
        }
    });
    let caption = "Outlines of the basins under CL2, K (10 - v), beside the uncontrolled bicycle's. The crosses are \
                   where the thesis wants the outline.";
    Item { values, figures: vec![Figure::of_chart("figure-3.10", caption, &chart)], ..Item::default() }
}

/// `value` with a basin's height at one speed.
fn height_at(study: &Study, case: Case, speed: f64, value: Value) -> Value {
    let at = |case: Case| Basin { columns: study.columns_at(&case, &[speed]) };
    let basin = at(case);
    let (located, on_grid) = (mean(&exact(&basin)), mean(&coarse(&basin)));
    Value { exact: Some(located), coarse: Some(on_grid), capped: basin.capped(), ..value }
        .tried(BY_REAR, mean(&exact(&at(case.scheduled(ScheduleSpeed::Rear)))))
        .tried(BY_INITIAL, mean(&exact(&at(case.scheduled(ScheduleSpeed::Initial)))))
}

/// Name of the experiments with another scheduling speed.
pub(super) const BY_REAR: &str = "gain set by the rear wheel's speed";
/// The same for the initial speed.
pub(super) const BY_INITIAL: &str = "gain set by the initial speed";

/// Outlines of several laws and of the uncontrolled bicycle.
fn basins(study: &Study, title: &str, laws: &[Assisted]) -> Chart {
    let of = |law: Assisted| study.basin(&Case::of(law));
    let alone = outline("uncontrolled", Look::line(4, Line::Filled), &of(Assisted::Alone));
    let lines = [Line::Solid, Line::Dashed, Line::Dotted, Line::Solid];
    let assisted = laws
        .iter()
        .enumerate()
        .map(|(i, &law)| outline(&law.name(), Look::line(i, lines[i % lines.len()]), &of(law)));
    let plot = Plot {
        x: Axis::new(SPEED),
        y: Axis::new(STEER_RATE),
        series: std::iter::once(alone).chain(assisted).collect(),
        shaded: study.self_stable().into_iter().collect(),
        ..Plot::default()
    };
    Chart { title: title.into(), columns: 1, plots: vec![plot], shaded: SELF_STABLE.into() }
}

/// The basins of Figure 3.13.
pub(super) fn cases_3_13() -> Vec<Case> {
    let h = Case::of(Assisted::H);
    let front = [Assisted::Alone].iter().chain(&CL3).map(|&law| Case::of(law));
    front.chain([h.scheduled(ScheduleSpeed::Rear), h.scheduled(ScheduleSpeed::Initial)]).collect()
}

/// Figure 3.13: the basins of f, g and h.
pub(super) fn figure_3_13(study: &Study) -> Item {
    let mut chart = basins(study, "CL3: basins of attraction of f, g and h", &CL3);
    let h = Case::of(Assisted::H);
    let of = |case: Case| study.basin(&case);
    let (front, rear, initial) =
        (of(h), of(h.scheduled(ScheduleSpeed::Rear)), of(h.scheduled(ScheduleSpeed::Initial)));
    chart.plots[0].series.push(outline("h, by the rear wheel", Look::line(3, Line::Dashed), &rear));
    chart.plots[0].series.push(outline("h, by the initial speed", Look::line(5, Line::Dotted), &initial));
    let values = Item::compare("figure-3.13", |cell| {
        let least = cell.row.starts_with("h, least");
        let merit = |outline: Vec<(f64, f64)>| {
            let part = between(&outline, 2.0, 8.5);
            if least { part.iter().map(|p| p.1).fold(f64::INFINITY, f64::min) } else { mean(&part) }
        };
        let of = |basin: &Arc<Basin>| merit(exact(basin));
        Value::new(cell, Some(of(&front)))
            .on_grid(Some(merit(coarse(&front))))
            .tried(BY_REAR, of(&rear))
            .tried(BY_INITIAL, of(&initial))
    });
    let caption = "Outlines of the basins under the nonlinear laws, gains set by the front wheel's speed, beside the \
                   uncontrolled bicycle's; and h with its gain set by other speeds.";
    let note = "Which speed sets the gain matters: only with the front wheel's is the height under h nearly \
                constant, as the thesis prints.";
    let figures = vec![Figure::of_chart("figure-3.13", caption, &chart)];
    Item { values, figures, notes: vec![note.into()], ..Item::default() }
}

/// Figure 3.14: two rides whose laws have equal initial gain.
pub(super) fn figure_3_14(study: &Study) -> Item {
    let laws = [(Assisted::F, Line::Solid), (Assisted::H, Line::Dashed)];
    let start = Start { speed_m_s: 7.221, steer_rate_rad_s: 6.0, roll_rate_rad_s: 0.0 };
    let ride = |law: Assisted| traced(&Case::of(law).conditions(&study.bicycle), start).1;
    let rides = laws.map(|(law, line)| (law, line, ride(law)));
    let plot = |label: &str, of: &dyn Fn(Assisted, &TracePoint) -> f64| Plot {
        x: Axis::new("Time [s]").over(0.0, 3.0),
        y: Axis::new(label),
        series: rides
            .iter()
            .enumerate()
            .map(|(i, (law, line, trace))| {
                let points =
                    over_time(trace, 5, |p| of(*law, p)).into_iter().filter(|p| p.0 <= 3.0).collect();
                Series::new(law.name(), Look::line(i, *line), points)
            })
            .collect(),
        ..Plot::default()
    };
    let plots = vec![
        plot("Front wheel speed [m/s]", &|_, p| p.front_speed),
        plot("Rear wheel speed [m/s]", &|_, p| p.rear_speed),
        plot("Gain [N m s/rad]", &|law, p| law.law().gain(p.front_speed)),
        plot("Torque [N m]", &|_, p| p.torque),
        plot("Roll [rad]", &|_, p| p.roll),
        plot("Steer [rad]", &|_, p| p.steer),
    ];
    let title = "f and h: rides from 7.221 m/s, 6 rad/s".to_owned();
    let chart = Chart { title, columns: 2, plots, shaded: String::new() };
    let values = Item::compare("figure-3.14", |cell| {
        let ride = rides.iter().find(|(law, ..)| cell.row == format!("{} at 0.6 s", law.name()));
        let point = ride.and_then(|(_, _, trace)| trace.get(600));
        let value = Value::new(cell, point.map(|p| p.front_speed));
        match point {
            Some(p) => value.tried("speed of the rear wheel", p.rear_speed),
            None => value,
        }
    });
    let caption =
        "Rides under f and h from 7.221 m/s, where both have the same gain, after a steer rate of 6 rad/s.";
    let note = "The printed 8.4 m/s is a bound (“higher than”).";
    let figures = vec![Figure::of_chart("figure-3.14", caption, &chart)];
    Item { values, figures, notes: vec![note.into()], ..Item::default() }
}
