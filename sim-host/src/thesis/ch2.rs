//! Chapter 2: the uncontrolled bicycle's eigenvalues and modes, and the initial controller.

use super::case::Assisted;
use super::draw::{EigenLines, SELF_STABLE, SPEED, eigen_plot, over_time, same_name, sorted_lines, speeds};
use super::item::{Figure, Item, Value};
use super::study::Study;
use crate::bicycle::catalogue;
use crate::bicycle::linear::Linear;
use crate::eigen::{Feedback, Intuitive, Model, critical_speeds};
use crate::report::figure::{Axis, Chart, Line, Look, Plot, Series};
use crate::ride::{Assist, Conditions, Start, TracePoint, traced};
use control::Law;
use std::f64::consts::TAU;

/// Figure 2.2: eigenvalues of the uncontrolled bicycle.
pub(super) fn figure_2_2(study: &Study) -> Item {
    let critical = study.critical;
    let mut plot = eigen_plot(study, Assisted::Alone, 12.0);
    plot.shaded.extend(study.self_stable());
    plot.verticals.extend(critical.v_d);
    let title = "Eigenvalues of the uncontrolled bicycle".to_owned();
    let chart = Chart { title, columns: 1, plots: vec![plot], shaded: SELF_STABLE.into() };
    let values = Item::compare("figure-2.2", |cell| {
        let speed = match cell.row.as_str() {
            "v_d" => critical.v_d,
            "v_w" => critical.v_w,
            _ => critical.v_c,
        };
        Value::new(cell, speed)
    });
    let caption = "Eigenvalues of the linearised bicycle over forward speed. The dashed vertical line is v_d, where \
                   the weave pair forms; the shaded range lies between v_w and v_c.";
    Item { values, figures: vec![Figure::of_chart("figure-2.2", caption, &chart)], ..Item::default() }
}

/// The steer rate that disturbs the rides of Figure 2.3 \[rad/s\]; the thesis says "a small
/// perturbation".
const SMALL: f64 = 0.1;

/// Duration of the ride at v_c \[s\]: the thesis has a full circle after 400 s.
const CIRCLE_S: f64 = 1000.0;
/// Duration of its experiments with larger disturbances \[s\].
const TRIED_S: f64 = 600.0;
/// Time step of these rides \[s\]: they last long and change slowly. The times of a full circle are those of the usual step within
/// 1 ms.
const CIRCLE_STEP_S: f64 = 9e-3;

/// Figure 2.3: the modes of the nonlinear bicycle.
pub(super) fn figure_2_3(study: &Study) -> Item {
    let (v_w, v_c) = (study.critical.v_w.unwrap_or(f64::NAN), study.critical.v_c.unwrap_or(f64::NAN));
    let usual = Conditions::thesis(study.bicycle, Assist::None);
    let lasting = |time_limit_s: f64| Conditions { time_limit_s, ..usual.clone() };
    let circling = |time_limit_s: f64| Conditions { step_s: CIRCLE_STEP_S, ..lasting(time_limit_s) };
    let rides = [
        ("weave: 4 m/s", 4.0, lasting(6.0)),
        ("at v_w", v_w, lasting(6.0)),
        ("self-stable: 7 m/s", 7.0, lasting(6.0)),
        ("at v_c", v_c, circling(CIRCLE_S)),
        ("capsize: 14 m/s", 14.0, lasting(20.0)),
    ];
    let mut plots = Vec::new();
    let mut circle = None;
    for (title, speed, conditions) in rides {
        let trace = free_ride(&conditions, speed, SMALL);
        if speed == v_c {
            circle = time_of_full_turn(&trace);
        }
        let points = over_time(&trace, trace.len() / 1500, |p| p.roll_rate);
        plots.push(Plot {
            title: title.into(),
            x: Axis::new("Time [s]"),
            y: Axis::new("Roll rate [rad/s]"),
            series: vec![Series::new("nonlinear, uncontrolled", Look::line(0, Line::Solid), points)],
            ..Plot::default()
        });
    }
    let title = format!("Modes of the bicycle: roll rate after a steer rate of {SMALL} rad/s");
    let chart = Chart { title, columns: 2, plots, shaded: String::new() };
    let values = Item::compare("figure-2.3", |cell| {
        let tried =
            [0.2, 0.25, 0.3].map(|rate| (rate, time_of_full_turn(&free_ride(&circling(TRIED_S), v_c, rate))));
        tried.iter().fold(Value::new(cell, circle), |value, (rate, time)| {
            value.tried(&format!("a disturbance of {rate} rad/s"), time.unwrap_or(f64::NAN))
        })
    });
    let caption = format!(
        "Roll rate of the nonlinear uncontrolled bicycle after an initial steer rate of {SMALL} rad/s (the \
         thesis says “a small perturbation”), at 4, 7 and 14 m/s and at the computed v_w = {v_w:.3} and \
         v_c = {v_c:.3} m/s."
    );
    let mut notes = Vec::new();
    if circle.is_none() {
        notes.push(format!("The ride at v_c does not turn a full circle within {CIRCLE_S} s."));
    }
    let figures = vec![Figure::of_chart("figure-2.3", &caption, &chart)];
    Item { values, figures, notes, ..Item::default() }
}

fn free_ride(conditions: &Conditions, speed: f64, steer_rate: f64) -> Vec<TracePoint> {
    traced(conditions, Start { speed_m_s: speed, steer_rate_rad_s: steer_rate, roll_rate_rad_s: 0.0 }).1
}

/// Time at which the bicycle has turned once about the vertical \[s\].
fn time_of_full_turn(trace: &[TracePoint]) -> Option<f64> {
    let mut heading = 0.0;
    trace.windows(2).find_map(|w| {
        let (before, step_s) = (heading, w[1].t - w[0].t);
        heading += 0.5 * (w[0].yaw_rate + w[1].yaw_rate) * step_s;
        (heading.abs() >= TAU)
            .then(|| w[0].t + step_s * (TAU - before.abs()) / (heading.abs() - before.abs()))
    })
}

/// Largest gain of the controller in Figure 2.7 \[N m s/rad\] (sections 2.1.4 and 2.4.3).
const LARGEST_GAIN: f64 = 40.0;

/// Figure 2.7: the controller of Schwab et al. 2008 on the benchmark bicycle.
pub(super) fn figure_2_7(study: &Study) -> Item {
    let Ok(benchmark) = catalogue::load("benchmark") else { return Item::default() };
    let critical = critical_speeds(&Linear::new(&benchmark.parameters), &Law::None);
    let model = |controller| Model::new(&benchmark.parameters, Feedback::Intuitive(controller), None);
    let speeds = speeds(10.0, if study.quick { 400 } else { 1000 });
    let v_max = most_stable(&model(Intuitive { k_v: 0.0, v_max: 0.0, k_c: 0.0 }), &speeds);
    let k_v = LARGEST_GAIN / v_max;
    let k_c = least_capsize_gain(|k_c| model(Intuitive { k_v, v_max, k_c }), v_max, &speeds);
    let controller = Intuitive { k_v, v_max, k_c };
    let feedback = Feedback::Intuitive(controller);
    let whole = model(controller);
    let EigenLines { real, imaginary } = sorted_lines(&speeds, |v| controlled(&whole, v));
    let eigen = Plot {
        x: Axis::new(SPEED),
        y: Axis::new("Eigenvalue λ").over(-10.0, 10.0),
        series: [
            same_name("real part [1/s]", Look::line(0, Line::Solid), real),
            same_name("imaginary part [rad/s]", Look::line(1, Line::Dashed), imaginary),
        ]
        .concat(),
        shaded: critical.v_w.zip(critical.v_c).into_iter().collect(),
        ..Plot::default()
    };
    let roll_rate = speeds.iter().map(|&v| (v, feedback.at(v).roll_rate)).collect();
    let roll = speeds.iter().map(|&v| (v, feedback.at(v).roll)).collect();
    let gains = Plot {
        x: Axis::new(SPEED),
        y: Axis::new("Gain [N m s/rad], [N m/rad]"),
        series: vec![
            Series::new("gain on roll rate", Look::line(2, Line::Solid), roll_rate),
            Series::new("gain on roll", Look::line(3, Line::Dashed), roll),
        ],
        verticals: vec![v_max],
        ..Plot::default()
    };
    let title = "The intuitive controller on the benchmark bicycle".to_owned();
    let chart = Chart { title, columns: 2, plots: vec![eigen, gains], shaded: SELF_STABLE.into() };
    let caption = format!(
        "Eigenvalues and gains of the controller of eq. 2.16 on the benchmark bicycle of Meijaard et al. \
         2007, v_max = {v_max:.2} m/s, K_v = {k_v:.2} N s²/rad, K_c = {k_c:.3} N s/rad; positive gains steer \
         into the fall."
    );
    let note = "The thesis prints neither K_v, K_c nor v_max of this controller. Here v_max is the speed at which \
                the uncontrolled bicycle is most stable, as section 2.1.4 says, K_v brings the gain to 40 N m s/rad \
                at rest, as sections 2.1.4 and 2.4.3 say, and K_c is the least that keeps capsize stable to 10 m/s.";
    Item {
        figures: vec![Figure::of_chart("figure-2.7", &caption, &chart)],
        notes: vec![note.into()],
        ..Item::default()
    }
}

/// Eigenvalues under eq. 2.16, `(real, imaginary)`.
fn controlled(model: &Model, v: f64) -> Vec<(f64, f64)> {
    model.at(v).spectrum().iter().flatten().map(|e| (e.re, e.im)).collect()
}

fn growth(values: &[(f64, f64)]) -> f64 {
    values.iter().map(|e| e.0).fold(f64::NEG_INFINITY, f64::max)
}

/// The speed at which the uncontrolled bicycle's rightmost eigenvalue is furthest left \[m/s\].
fn most_stable(uncontrolled: &Model, speeds: &[f64]) -> f64 {
    let growth_at = |v: f64| growth(&controlled(uncontrolled, v));
    let by_growth = |a: &f64, b: &f64| growth_at(*a).total_cmp(&growth_at(*b));
    speeds.iter().copied().min_by(by_growth).unwrap_or(0.0)
}

/// The smallest roll gain per speed above `v_max` with which no mode grows at `speeds` \[N s/rad\].
fn least_capsize_gain(with: impl Fn(f64) -> Model, v_max: f64, speeds: &[f64]) -> f64 {
    let stable = |k_c: f64| {
        let model = with(k_c);
        let above = speeds.iter().filter(|&&v| v > v_max);
        above.into_iter().all(|&v| growth(&controlled(&model, v)) <= 0.0)
    };
    let (mut low, mut high) = (0.0, 10.0);
    while high - low > 1e-4 {
        let middle = 0.5 * (low + high);
        if stable(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Situation: the ride at v_c after 0.3 rad/s, which turns in the shortest time. Action: the time of a full circle with the long
    /// rides' step and with the usual one. Must hold: they differ by less than 1 ms.
    #[test]
    fn the_longer_step_turns_in_the_same_time() {
        let study = Study::new(true).unwrap();
        let usual = Conditions { time_limit_s: 400.0, ..Conditions::thesis(study.bicycle, Assist::None) };
        let long = Conditions { step_s: CIRCLE_STEP_S, ..usual.clone() };
        let v_c = study.critical.v_c.unwrap();
        let [a, b] = [usual, long].map(|c| time_of_full_turn(&free_ride(&c, v_c, 0.3)).unwrap());
        assert!((300.0..360.0).contains(&a) && (a - b).abs() < 1e-3, "{a} {b}");
    }
}
