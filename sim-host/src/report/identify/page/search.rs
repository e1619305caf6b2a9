//! How the gains were found: reduction, optima, profile of the delay.

use super::{number, paragraph};
use crate::identify::symbols;
use crate::report::figure::{self, Chart};
use crate::report::html::{self, table};
use crate::report::identify::document::IdentifyDocument;
use crate::report::identify::plots;
use crate::report::identify::text::{optional, percent};

/// The gains of the full fit, in their order.
fn full(document: &IdentifyDocument) -> Vec<&'static str> {
    symbols().iter().copied().filter(|name| document.config.feedback.contains(name)).collect()
}

pub(super) fn reduction(document: &IdentifyDocument) -> String {
    let gains = full(document);
    let mut columns = vec!["Step"];
    columns.extend(&gains);
    columns.extend(["VAF [%]", "onset [%]", "held [%]", "AIC", "BIC", "eigenvalue [1/s]"]);
    let row = |(i, step): (usize, &crate::report::identify::ReductionEntry)| {
        let mut cells =
            vec![if i == document.selected { format!("<b>{i}, selected</b>") } else { i.to_string() }];
        cells.extend(
            gains.iter().map(|name| step.gains.get(name).map_or("–".into(), |gain| number(gain.value))),
        );
        cells.extend([percent(step.vaf), optional(step.vaf_after_onset), optional(step.vaf_cross_validated)]);
        cells.extend([step.aic, step.bic].map(|criterion| format!("{criterion:.1}").replace('-', "−")));
        cells.push(number(step.rightmost_eigenvalue_1_s));
        cells
    };
    let rows: Vec<Vec<String>> = document.reduction.iter().enumerate().map(row).collect();
    table("", &columns, &rows)
        + &paragraph(
            "Each step is without the gain whose variance, relative to its square, was highest; all gains are those of the linear \
             bicycle. VAF: variance accounted for; onset: within 1 s of a perturbation's start; held: of parts of the record that \
             were not fitted; AIC, BIC: information criteria, less is better; eigenvalue: real part of the closed loop's \
             rightmost one.",
        )
}

pub(super) fn optima(document: &IdentifyDocument) -> String {
    let gains = full(document);
    let mut columns = gains.clone();
    columns.extend(["VAF [%]", "onset [%]", "log-likelihood", "eigenvalue [1/s]", "starts"]);
    let row = |optimum: &crate::report::identify::OptimumEntry| {
        let mut cells: Vec<String> = gains
            .iter()
            .map(|name| optimum.gains.get(name).map_or("–".into(), |gain| number(*gain)))
            .collect();
        cells.extend([percent(optimum.vaf), optional(optimum.vaf_after_onset)]);
        cells.push(number(-optimum.log_likelihood_drop));
        cells.extend([number(optimum.rightmost_eigenvalue_1_s), optimum.starts.to_string()]);
        cells
    };
    let rows: Vec<Vec<String>> = document.optima.iter().map(row).collect();
    table("", &columns, &rows)
        + &paragraph(
            "Optima of the full fit on the linear bicycle, best first, with the log-likelihood relative to the best and the number of starts \
             of the search that led to each. A log-likelihood above −1.92, the end of a 95 % interval, means that the record does not tell \
             these gains from the best.",
        )
}

/// Empty without a profile.
pub(super) fn delay(document: &IdentifyDocument) -> String {
    let (Some(delay), Some(plot)) = (&document.delay, plots::delay(document)) else { return String::new() };
    let chart =
        Chart { title: String::new(), columns: 1, plots: vec![plot], shaded: plots::DELAY_SHADED.into() };
    paragraph(&delay.sentence())
        + &html::figure(
            "delay-profile",
            &figure::chart(&chart),
            "Profile likelihood of the neural delay: each delay with its own best gains. Drops above the figure's range are not shown.",
        )
}
