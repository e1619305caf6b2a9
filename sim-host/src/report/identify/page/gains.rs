//! The selected gains, and those that are zero or do not differ significantly from it.

use super::{list, number, paragraph};
use crate::identify::{Identified, symbols};
use crate::report::html::table;
use crate::report::identify::correlation::NORMAL_95;
use crate::report::identify::document::IdentifyDocument;
use crate::report::identify::text::percent;

/// What a gain feeds back, and its unit.
fn meaning(symbol: &str) -> (&'static str, &'static str) {
    let steer = symbol.starts_with("K_delta");
    match symbol.rsplit('_').next() {
        Some("i") if steer => ("integral of steer", "N m/(rad s)"),
        Some("i") => ("integral of roll", "N m/(rad s)"),
        Some("d") if steer => ("steer rate", "N m s/rad"),
        Some("d") => ("roll rate", "N m s/rad"),
        Some("dd") if steer => ("steer acceleration", "N m s²/rad"),
        Some("dd") => ("roll acceleration", "N m s²/rad"),
        _ if steer => ("steer", "N m/rad"),
        _ => ("roll", "N m/rad"),
    }
}

pub(super) fn gains(document: &IdentifyDocument, found: &Identified) -> String {
    let row = |name: &&'static str| {
        let gain = document.gains.get(name)?;
        let (what, unit) = meaning(name);
        let uncertainty = gain.std_error.map_or(std::array::from_fn(|_| "not known".into()), |error| {
            let half = NORMAL_95 * error;
            let [error_shown, from, to] = [error, gain.value - half, gain.value + half].map(number);
            [error_shown, from, to, format!("{:.1}", 100.0 * error / gain.value.abs())]
        });
        let names = [(*name).to_owned(), what.into(), number(gain.value)];
        Some(names.into_iter().chain(uncertainty).chain([unit.into()]).collect())
    };
    let rows: Vec<Vec<String>> = symbols().iter().filter_map(row).collect();
    let columns =
        ["Gain", "Of", "Value", "Standard error", "95 % from", "95 % to", "Relative error [%]", "Unit"];
    let mut text = table("", &columns, &rows);
    text += &match &found.refined {
        Some(Ok(_)) => paragraph(
            "The gains are refined on the nonlinear bicycle; their standard errors are those of the linear model at these gains.",
        ),
        Some(Err(error)) => paragraph(&format!(
            "The gains are those of the linear bicycle, and their errors are not known: they could not be refined on the nonlinear \
             one, because {error}."
        )),
        None => paragraph("The gains are those of the linear bicycle."),
    };
    if matches!(found.refined, None | Some(Ok(_)))
        && let Some(why) = found.errors_unknown()
    {
        text += &paragraph(&format!("Their errors are not known: {why}."));
    }
    let by_signal: Vec<String> =
        document.vaf_by_signal.iter().map(|(signal, vaf)| format!("{signal} {} %", percent(*vaf))).collect();
    let real_1_s = document.rightmost_eigenvalue_1_s;
    let stable = if real_1_s < 0.0 { "stable" } else { "unstable" };
    text + &paragraph(&format!(
        "Variance accounted for: {}. The closed loop is {stable}: the real part of its rightmost eigenvalue is {real_1_s:.3} 1/s. Condition \
         number of the fit: {:.0}. The residuals count as {:.0} independent samples; their correlation is accounted for in the \
         standard errors.",
        by_signal.join(", "),
        document.condition,
        document.independent_samples
    ))
}

pub(super) fn insignificant(document: &IdentifyDocument) -> String {
    let loose = document.not_identified.iter().map(|gain| format!("{} {}.", gain.gain, gain.why));
    let full = &document.config.feedback;
    let reason = |name: &&'static str| match document.gains.contains_key(name) {
        true => None,
        false if full.contains(name) => {
            Some(format!("{name}: zero; left out by the selection (criterion {}).", document.config.select))
        }
        false => Some(format!("{name}: zero; not among the gains of the full fit.")),
    };
    let all: Vec<String> = loose.chain(symbols().iter().filter_map(reason)).collect();
    match all[..] {
        [] if document.covariance.is_none() => paragraph(
            "Which gains differ significantly from zero is not known: they have no standard errors.",
        ),
        [] => paragraph("Every gain differs significantly from zero: no 95 % interval contains zero."),
        _ => list(all.iter().map(String::as_str)),
    }
}
