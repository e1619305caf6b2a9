//! What was fitted: record, bicycle, settings, remarks.

use super::{list, paragraph};
use crate::report::html::{escaped, table};
use crate::report::identify::document::{IdentifyDocument, ResolvedIdentify};
use crate::report::identify::text::percent;
use std::f64::consts::TAU;

/// The result in a sentence, and the program.
pub(super) fn summary(document: &IdentifyDocument) -> String {
    let tool = &document.tool;
    let bicycle = if document.refined { "nonlinear" } else { "linear" };
    let mut text = format!(
        "{} gains of a rider at {:.2} m/s with a neural delay of {:.1} ms, on the {bicycle} bicycle: they account for {} % of the \
         variance of the measured signals",
        document.gains.len(),
        document.record.speed_m_s,
        1e3 * document.delay_s,
        percent(document.vaf)
    );
    if let Some(after) = &document.vaf_after_onset {
        let mean = after.values().sum::<f64>() / after.len() as f64;
        text += &format!(", and for {} % within 1 s of the perturbations' onsets", percent(mean));
    }
    let warnings = match document.warnings[..] {
        [] => String::new(),
        _ => {
            paragraph("The gains may be wrong by more than their standard errors:")
                + &list(document.warnings.iter().map(String::as_str))
        }
    };
    let made = format!("Made by {} {} (commit {}).", tool.name, tool.version, tool.commit);
    paragraph(&(text + ".")) + &warnings + &format!("<p class=\"note\">{}</p>\n", escaped(&made))
}

pub(super) fn fitted(document: &IdentifyDocument) -> String {
    let record = &document.record;
    let deviation = match record.speed_deviation_m_s {
        Some(deviation) => format!("recorded with a standard deviation of {deviation:.3} m/s"),
        None => "not recorded".into(),
    };
    let bicycle = match &document.bicycle.source {
        Some(source) => format!("{} ({source})", document.bicycle.name),
        None => document.bicycle.name.clone(),
    };
    let mut rows = vec![
        ("File", record.file.clone()),
        ("SHA-256", record.sha256.clone()),
        ("Duration", format!("{:.2} s, {} samples", record.duration_s, record.samples)),
        ("Sample rate", format!("{:.2} Hz", record.sample_s.recip())),
        ("Speed of the model", format!("{:.3} m/s; {deviation}", record.speed_m_s)),
        ("Bicycle", bicycle),
        ("Neural delay", delay(document)),
    ];
    rows.extend(record.root_mean_square.iter().map(|(signal, rms)| {
        let unit = if signal.ends_with("rate") { "deg/s" } else { "deg" };
        ("Root mean square", format!("{signal}: {:.3} {unit}", rms.to_degrees()))
    }));
    rows.extend(settings(&document.config));
    let cells = |(name, value): (&str, String)| vec![name.to_owned(), escaped(&value)];
    let rows: Vec<Vec<String>> = rows.into_iter().map(cells).collect();
    let remarks: Vec<&str> =
        record.remarks.iter().chain(&document.bicycle.warnings).map(String::as_str).collect();
    let remarks = match remarks[..] {
        [] => paragraph("No remarks on the record: nothing was left out, and nothing looks wrong."),
        _ => paragraph("Remarks on the record and the bicycle:") + &list(remarks),
    };
    table("", &["Quantity", "Value"], &rows) + &remarks
}

fn delay(document: &IdentifyDocument) -> String {
    let delay_ms = 1e3 * document.delay_s;
    match document.config.delay_s {
        Some(_) => format!("{delay_ms:.1} ms, given"),
        None => format!("{delay_ms:.1} ms, estimated from the record"),
    }
}

/// The settings in words, each with its option.
fn settings(config: &ResolvedIdentify) -> Vec<(&'static str, String)> {
    let neuromuscular = &config.neuromuscular;
    let drift = match config.drift.as_str() {
        "none" => "none: the signals are used as they are".into(),
        "offset" => "a constant offset, estimated with the gains".into(),
        slower => format!("all motion slower than {slower}, estimated with the gains"),
    };
    let signals: Vec<&str> = config.fit.iter().map(|signal| signal.name()).collect();
    let measured = if config.filter { "the output of their impulse responses" } else { "as measured" };
    let bicycle =
        if config.linear { "linear" } else { "linear, the selected gains refined on the nonlinear one" };
    let until = match config.reduce_until {
        Some(vaf) => format!("until less than {} % of the variance is accounted for", percent(vaf)),
        None => "none".into(),
    };
    let select = match config.select.as_str() {
        "full" => "all gains".into(),
        "aic" => "the step with the least information criterion of Akaike".into(),
        "bic" => "the step with the least information criterion of Bayes".into(),
        "held" => "the step that is best for parts of the record that were not fitted".into(),
        fewest => {
            let (of, percent) = fewest.split_once(':').unwrap_or(("vaf", fewest));
            let after = if of == "onset" { " within 1 s of the perturbations' onsets" } else { "" };
            format!("the fewest gains that account for {percent} % of the variance{after}")
        }
    };
    let hold = match config.hold {
        crate::identify::Hold::Zero => "constant until the next sample",
        crate::identify::Hold::Linear => "a straight line to the next sample",
    };
    let (ahead_m, height_m) = (config.force_at.ahead_m, config.force_at.height_m);
    vec![
        ("Map of the columns", config.map.clone()),
        (
            "Lateral force acts",
            format!("{ahead_m} m ahead of the rear contact, {height_m} m above the ground"),
        ),
        ("Disturbance between samples", hold.into()),
        ("Fitted signals", format!("{}, {measured}", signals.join(", "))),
        ("Gains of the full fit", config.feedback.join(", ")),
        (
            "Neuromuscular dynamics",
            format!("{:.3} Hz, damping ratio {:.3}", neuromuscular.omega_rad_s / TAU, neuromuscular.zeta),
        ),
        ("Drift", drift),
        ("Left out at the start", format!("{} s", config.skip_s)),
        ("Bicycle model", bicycle.into()),
        ("Reduction", until),
        ("Selected", select),
        ("Seed of the global search", config.seed.to_string()),
    ]
}
