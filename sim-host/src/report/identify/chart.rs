//! Figure of an identified rider: measured and modelled signals over time, what is left, and the profile of the delay.

use super::document::IdentifyDocument;
use crate::identify::{Identified, Measured, Signal};
use crate::report::figure::{Axis, Chart, Line, Look, Plot, Series};

/// Time that the figure shows \[s\].
const SHOWN_S: f64 = 20.0;

/// The figure.
pub fn chart(document: &IdentifyDocument, found: &Identified) -> Chart {
    let record = &found.problem.record;
    let response = found.response();
    let mut plots = vec![disturbance(found)];
    plots.extend(record.measured.iter().map(|measured| signal(found, measured, &response)));
    plots.extend(document.delay.as_ref().map(|delay| Plot {
        x: Axis::new("Neural delay [ms]"),
        y: Axis::new("Drop of log-likelihood"),
        series: vec![Series::new(
            "profile likelihood of the delay",
            Look::line(3, Line::Solid),
            delay.profile.iter().map(|point| (1e3 * point.delay_s, point.log_likelihood_drop)).collect(),
        )],
        verticals: [delay.low_s, delay.high_s].into_iter().flatten().map(|s| 1e3 * s).collect(),
        ..Plot::default()
    }));
    let title = format!(
        "Rider of {} at {:.1} m/s: {:.1} % of the variance accounted for",
        document.record.file,
        document.record.speed_m_s,
        100.0 * document.vaf
    );
    Chart { title, columns: 1, plots, shaded: String::new() }
}

/// The samples that are shown: the first ones that are fitted.
fn shown(found: &Identified) -> impl Iterator<Item = usize> + Clone + use<> {
    let sample_s = found.problem.record.disturbances.sample_s;
    let first = (found.problem.skip_s / sample_s) as usize;
    first..found.problem.record.len().min(first + (SHOWN_S / sample_s) as usize)
}

fn disturbance(found: &Identified) -> Plot {
    let disturbances = &found.problem.record.disturbances;
    let has_force = disturbances.samples.iter().any(|x| x[0] != 0.0);
    let (input, label, name) = match has_force {
        true => (0, "Lateral force [N]", "lateral force"),
        false => (1, "Steer torque [N m]", "steer torque"),
    };
    let point = |k: usize| (k as f64 * disturbances.sample_s, disturbances.samples[k][input]);
    Plot {
        x: Axis::new("Time [s]"),
        y: Axis::new(label),
        series: vec![Series::new(name, Look::line(2, Line::Solid), shown(found).map(point).collect())],
        ..Plot::default()
    }
}

fn signal(found: &Identified, measured: &Measured, response: &[[f64; 3]]) -> Plot {
    let sample_s = found.problem.record.disturbances.sample_s;
    let (label, state) = match measured.signal {
        Signal::Roll => ("Roll [deg]", 0),
        Signal::Steer => ("Steer [deg]", 1),
        Signal::RollRate => ("Roll rate [deg/s]", 2),
    };
    let value = |k: usize| if measured.valid[k] { measured.values[k].to_degrees() } else { f64::NAN };
    let modelled = |k: usize| response.get(k).map_or(f64::NAN, |x| x[state].to_degrees());
    let curve = |of: &dyn Fn(usize) -> f64| shown(found).map(|k| (k as f64 * sample_s, of(k))).collect();
    Plot {
        x: Axis::new("Time [s]"),
        y: Axis::new(label),
        series: vec![
            Series::new("measured", Look::line(0, Line::Faint), curve(&value)),
            Series::new("model", Look::line(1, Line::Solid), curve(&modelled)),
            Series::new("difference", Look::line(0, Line::Dotted), curve(&|k| value(k) - modelled(k))),
        ],
        ..Plot::default()
    }
}
