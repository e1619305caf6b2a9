//! Appendix D: accuracy of integrators on the uncontrolled benchmark bicycle.

use super::draw::over_time;
use super::item::{Figure, Item, Table};
use super::solvers::{Adaptive, Entries, Free, RK4, RKF45, Tableau, adaptive, distance, entries, fixed};
use super::study::Study;
use crate::bicycle::{Geometry, catalogue};
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::ride::{Assist, Conditions, Ride, Start, TracePoint, traced};
use rayon::prelude::*;

/// Speed \[m/s\], steer rate \[rad/s\] and name in the thesis of the four rides.
pub const RIDES: [(f64, f64, &str); 4] =
    [(4.0, 0.5, "weave"), (5.0, 0.5, "stable"), (7.0, 0.5, "capsize"), (3.0, 3.0, "chaos")];
/// Duration of the rides \[s\].
const SECONDS: f64 = 15.0;

/// Number of steps of the solution that the reference is compared with.
const STEPS: usize = 40_000;

/// A ride of the study and its reference solution.
#[derive(Debug)]
pub struct Problem {
    /// Its number and name.
    pub name: String,
    start: Entries,
    /// Time at which solutions are compared \[s\]: 15 s, or the last millisecond before the fall.
    pub seconds: f64,
    reference: Entries,
    /// Distance between two reference solutions of different families.
    pub floor: f64,
}

/// The four rides on the benchmark bicycle.
pub fn problems(benchmark: &Geometry) -> Vec<Problem> {
    let problem = |(i, &(speed, rate, name)): (usize, &(f64, f64, &str))| {
        let ride = ride(benchmark, speed, rate).0;
        let fall = ride.outcome.time_to_fall_s();
        let seconds = fall.map_or(SECONDS, |t| (t * 1e3).floor() / 1e3);
        let start = entries(&ride.start.state(benchmark));
        let free = Free(benchmark);
        // Steps small enough that eighth order leaves rounding errors only, and large enough that the library's summed
        // time reaches the end; a second method for comparison.
        let reference = adaptive(&free, Adaptive::Dop853, &start, seconds, 1e-14, 0.01);
        let other = fixed(&free, &RKF45, &start, seconds, STEPS);
        let reference = reference.or(other).unwrap_or([f64::NAN; 6]);
        let floor = other.map_or(f64::NAN, |other| distance(&reference, &other));
        Problem {
            name: format!("{}: {name}, {speed} m/s, {rate} rad/s", i + 1),
            start,
            seconds,
            reference,
            floor,
        }
    };
    RIDES.par_iter().enumerate().map(problem).collect()
}

impl Problem {
    /// The error of a solution; `None` if it was broken off.
    fn error(&self, solution: Option<Entries>) -> Option<f64> {
        solution.map(|y| distance(&y, &self.reference)).filter(|e| e.is_finite())
    }

    /// The error of a method with `steps` equal steps.
    pub fn error_of_fixed(&self, benchmark: &Geometry, method: &Tableau, steps: usize) -> Option<f64> {
        self.error(fixed(&Free(benchmark), method, &self.start, self.seconds, steps))
    }

    /// The error of a solver at a tolerance.
    pub fn error_of_adaptive(&self, benchmark: &Geometry, solver: Adaptive, tolerance: f64) -> Option<f64> {
        self.error(adaptive(&Free(benchmark), solver, &self.start, self.seconds, tolerance, 0.1))
    }
}

fn benchmark() -> Option<Geometry> {
    catalogue::load("benchmark").ok().map(|b| Geometry::new(&b.parameters))
}

fn ride(benchmark: &Geometry, speed: f64, rate: f64) -> (Ride, Vec<TracePoint>) {
    let conditions = Conditions { time_limit_s: SECONDS, ..Conditions::thesis(*benchmark, Assist::None) };
    traced(&conditions, Start { speed_m_s: speed, steer_rate_rad_s: rate, roll_rate_rad_s: 0.0 })
}

/// Figure D.1: the four rides.
pub fn figure_d_1(_: &Study) -> Item {
    let Some(benchmark) = benchmark() else { return Item::default() };
    let plot = |(i, &(speed, rate, name)): (usize, &(f64, f64, &str))| {
        let trace = ride(&benchmark, speed, rate).1;
        let series = |label: &str, colour: usize, line: Line, of: fn(&TracePoint) -> f64| {
            Series::new(label, Look::line(colour, line), over_time(&trace, 10, of))
        };
        Plot {
            title: format!("{}: {name}, {speed} m/s, {rate} rad/s", i + 1),
            x: Axis::new("Time [s]"),
            y: Axis::new("Angle [rad], rate [rad/s]"),
            series: vec![
                series("roll", 0, Line::Solid, |p| p.roll),
                series("steer", 1, Line::Solid, |p| p.steer),
                series("roll rate", 0, Line::Dotted, |p| p.roll_rate),
                series("steer rate", 1, Line::Dotted, |p| p.steer_rate),
            ],
            ..Plot::default()
        }
    };
    let plots = RIDES.iter().enumerate().map(plot).collect();
    let title = "The rides of the convergence study".to_owned();
    let chart = Chart { title, columns: 2, plots, shaded: String::new() };
    let caption = "Rides of the uncontrolled benchmark bicycle, 15 s or to the fall.";
    Item { figures: vec![Figure::of_chart("figure-D.1", caption, &chart)], ..Item::default() }
}

/// Errors over steps or tolerances: the setting and the error; `None` where the solution was broken off.
type Errors = Vec<(f64, Option<f64>)>;

/// Figure D.2: errors of two methods with fixed steps.
pub fn figure_d_2(study: &Study) -> Item {
    let Some(benchmark) = benchmark() else { return Item::default() };
    let problems = problems(&benchmark);
    let shortest = if study.quick { 10 } else { 15 };
    let steps: Vec<f64> = (4..=shortest).map(|k| libm::pow(10.0, -f64::from(k) / 3.0)).collect();
    let run = |problem: &Problem, method: &Tableau| -> Errors {
        let one = |&h: &f64| {
            let n = (problem.seconds / h).ceil() as usize;
            (problem.seconds / n as f64, problem.error_of_fixed(&benchmark, method, n))
        };
        steps.par_iter().map(one).collect()
    };
    let axis = Axis::new("Step [s]").log();
    let methods = [(RK4.name, &RK4), (RKF45.name, &RKF45)];
    let results = grid(&problems, &methods, |p, m| run(p, m));
    let caption = "Error at the end of the four rides over the length of fixed steps. Crosses at the upper edge: the \
                   solution fell or broke off before.";
    let chart = errors_chart("Errors of fixed steps", &problems, axis, &results);
    let figures = vec![Figure::of_chart("figure-D.2", caption, &chart)];
    Item {
        figures,
        tables: vec![best(&problems, &results, "step")],
        notes: vec![note(&problems)],
        ..Item::default()
    }
}

/// Figure D.3: errors of adaptive solvers.
pub fn figure_d_3(study: &Study) -> Item {
    let Some(benchmark) = benchmark() else { return Item::default() };
    let problems = problems(&benchmark);
    let last = if study.quick { 10 } else { 14 };
    let tolerances: Vec<f64> = (3..=last).map(|k| 10f64.powi(-k)).collect();
    let run = |problem: &Problem, solver: Adaptive| -> Errors {
        let one = |&tolerance: &f64| (tolerance, problem.error_of_adaptive(&benchmark, solver, tolerance));
        tolerances.par_iter().map(one).collect()
    };
    let axis = Axis::new("Absolute and relative tolerance").log();
    let methods = Adaptive::ALL.map(|solver| (solver.name(), solver));
    let results = grid(&problems, &methods, |p, solver| run(p, *solver));
    let caption = "Error at the end of the four rides over the tolerance of adaptive solvers. Crosses at the upper \
                   edge: the solution fell or the solver gave up.";
    let chart = errors_chart("Errors of adaptive solvers", &problems, axis, &results);
    let figures = vec![Figure::of_chart("figure-D.3", caption, &chart)];
    let tables = vec![best(&problems, &results, "tolerance")];
    Item { figures, tables, notes: vec![note(&problems)], ..Item::default() }
}

/// Every method on every problem: method, then problem.
fn grid<M: Sync>(
    problems: &[Problem],
    methods: &[(&'static str, M)],
    run: impl Fn(&Problem, &M) -> Errors + Sync,
) -> Vec<(&'static str, Vec<Errors>)> {
    let of =
        |(name, method): &(&'static str, M)| (*name, problems.par_iter().map(|p| run(p, method)).collect());
    methods.par_iter().map(of).collect()
}

fn errors_chart(
    title: &str,
    problems: &[Problem],
    x: Axis,
    results: &[(&'static str, Vec<Errors>)],
) -> Chart {
    const TOP: f64 = 10.0;
    let markers = [Marker::Dot, Marker::Square, Marker::Triangle, Marker::Ring];
    let plot = |(k, problem): (usize, &Problem)| {
        let mut series = Vec::new();
        for (i, (name, errors)) in results.iter().enumerate() {
            let look = Look { marker: Some(markers[i % markers.len()]), ..Look::line(i, Line::Solid) };
            let points = errors[k].iter().map(|(x, e)| (*x, e.map_or(f64::NAN, |e| e.max(1e-16)))).collect();
            series.push(Series::new(*name, look, points));
            let broken: Vec<_> =
                errors[k].iter().filter(|(_, e)| e.is_none()).map(|(x, _)| (*x, 0.4 * TOP)).collect();
            if !broken.is_empty() {
                series.push(Series::new("", Look::marks(i, Marker::Cross), broken));
            }
        }
        Plot {
            title: problem.name.clone(),
            x: x.clone(),
            y: Axis::new("Error").log().over(1e-16, TOP),
            series,
            ..Plot::default()
        }
    };
    let plots = problems.iter().enumerate().map(plot).collect();
    Chart { title: title.into(), columns: 2, plots, shaded: String::new() }
}

/// The smallest error of every method with its setting, and the coarsest setting below 1e-5.
fn best(problems: &[Problem], results: &[(&'static str, Vec<Errors>)], setting: &str) -> Table {
    let mut rows = Vec::new();
    for (name, errors) in results {
        for (problem, errors) in problems.iter().zip(errors) {
            let known = || errors.iter().filter_map(|(x, e)| e.map(|e| (*x, e)));
            let least = known().min_by(|a, b| a.1.total_cmp(&b.1));
            let enough = known().filter(|(_, e)| *e < ENOUGH).map(|(x, _)| x).reduce(f64::max);
            let text = |x: Option<f64>| x.map_or("none".into(), |x| format!("{x:.1e}"));
            rows.push(vec![
                (*name).into(),
                problem.name.clone(),
                text(least.map(|l| l.1)),
                text(least.map(|l| l.0)),
                text(enough),
            ]);
        }
    }
    let last = format!("coarsest {setting} with an error below 1e-5");
    Table {
        title: "Least errors".into(),
        columns: ["method", "ride", "least error", &format!("at {setting}"), &last]
            .map(String::from)
            .to_vec(),
        rows,
    }
}

/// The error the thesis calls sufficient.
const ENOUGH: f64 = 1e-5;

fn note(problems: &[Problem]) -> String {
    let each = problems.iter().map(|p| format!("{} (compared at {} s): {:.0e}", p.name, p.seconds, p.floor));
    format!(
        "Errors are distances from a reference: Dormand-Prince of eighth order at a tolerance of 1e-14. Distance of \
         that reference from RKF45 in {STEPS} steps, the least error that can be told: {}.",
        each.collect::<Vec<_>>().join("; ")
    )
}
