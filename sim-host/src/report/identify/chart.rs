//! Figure of an identified rider: measured and modelled signals over time, what is left, and the profile of the delay.

use super::document::IdentifyDocument;
use super::plots::{Course, DELAY_SHADED, delay, inputs};
use crate::identify::Identified;
use crate::report::figure::Chart;

/// Time that the figure shows \[s\].
const SHOWN_S: f64 = 20.0;

/// The figure.
pub fn chart(document: &IdentifyDocument, found: &Identified) -> Chart {
    let course = Course::new(found);
    let from_s = found.problem.skip_s;
    let shown = course.between(from_s, from_s + SHOWN_S);
    let signals = 0..found.problem.record.measured.len();
    let mut plots: Vec<_> =
        inputs(found).into_iter().map(|input| course.disturbance(input, &shown)).collect();
    plots.extend(signals.clone().map(|signal| course.signal(signal, &shown)));
    plots.extend(signals.map(|signal| course.residual(signal, &shown)));
    plots.extend(delay(document));
    let title = format!(
        "Rider of {} at {:.1} m/s: {:.1} % of the variance accounted for",
        document.record.file,
        document.record.speed_m_s,
        100.0 * document.vaf
    );
    let shaded = if document.delay.is_some() { DELAY_SHADED.into() } else { String::new() };
    Chart { title, columns: 1, plots, shaded }
}
