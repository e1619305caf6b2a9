//! An identified rider as text.

use super::document::{IdentifyDocument, ReductionEntry};
use crate::identify::symbols;
use std::fmt::Write;

/// A fraction in %.
pub(super) fn percent(vaf: f64) -> String {
    format!("{:.2}", 100.0 * vaf)
}

/// A fraction in %, or a dash.
pub(super) fn optional(vaf: Option<f64>) -> String {
    vaf.map_or("-".into(), percent)
}

/// A number with four significant digits.
pub(super) fn number(x: f64) -> String {
    if x != 0.0 && x.abs() < 1e-4 {
        return format!("{x:.1e}");
    }
    let digits = if x == 0.0 { 3 } else { (3 - libm::floor(libm::log10(x.abs())) as i32).clamp(0, 6) };
    format!("{x:.*}", digits as usize)
}

/// Gains with standard errors, the reduction, the optima and the delay.
pub fn text(document: &IdentifyDocument) -> String {
    let mut text = String::new();
    let record = &document.record;
    let _ = writeln!(
        text,
        "{}: {:.1} s at {:.0} Hz, {:.2} m/s, on {}; delay {:.1} ms",
        record.file,
        record.duration_s,
        record.sample_s.recip(),
        record.speed_m_s,
        document.bicycle.name,
        1e3 * document.delay_s
    );
    for black_box in &document.black_box {
        let _ = writeln!(
            text,
            "{}: the perturbation explains {} % of it (impulse response without a model; signal to noise {})",
            black_box.signal.name(),
            percent(black_box.signal_to_noise / (1.0 + black_box.signal_to_noise)),
            number(black_box.signal_to_noise)
        );
    }
    let bicycle = if document.refined { "nonlinear" } else { "linear" };
    let _ = writeln!(text, "\n{:11} {:>12} {:>14}   ({bicycle} bicycle)", "gain", "value", "std. error");
    for name in symbols() {
        if let Some(gain) = document.gains.get(name) {
            let error = gain.std_error.map_or("not known".into(), number);
            let _ = writeln!(text, "{name:11} {:>12} {error:>14}", number(gain.value));
        }
    }
    let _ = writeln!(
        text,
        "variance accounted for {} %, within 1 s of the perturbations' onsets {} %; rightmost eigenvalue {} 1/s",
        percent(document.vaf),
        optional(document.vaf_after_onset.as_ref().map(|of| of.values().sum::<f64>() / of.len() as f64)),
        number(document.rightmost_eigenvalue_1_s)
    );
    for gain in &document.not_identified {
        let _ = writeln!(text, "{} {}", gain.gain, gain.why);
    }
    if document.reduction.len() > 1 {
        reduction(&mut text, document);
    }
    if document.optima.len() > 1 {
        let _ = writeln!(text, "\nDistinct optima of the full fit:");
        for optimum in &document.optima {
            let gains: Vec<_> = symbols()
                .iter()
                .filter_map(|name| Some(format!("{name} {}", number(*optimum.gains.get(name)?))))
                .collect();
            let _ = writeln!(text, "  VAF {} %: {}", percent(optimum.vaf), gains.join(", "));
        }
    }
    if let Some(delay) = &document.delay {
        let _ = writeln!(text, "\n{}", delay.sentence());
    }
    text
}

fn reduction(text: &mut String, document: &IdentifyDocument) {
    let shown: Vec<&str> =
        symbols().iter().copied().filter(|name| document.reduction[0].gains.contains_key(name)).collect();
    let _ = write!(text, "\nReduction on the linear bicycle (* selected):\n ");
    shown.iter().for_each(|name| {
        let _ = write!(text, "{name:>11}");
    });
    let _ = writeln!(text, "{:>8}{:>8}{:>8}{:>11}{:>11}", "VAF", "onset", "held", "AIC", "BIC");
    for (i, step) in document.reduction.iter().enumerate() {
        let _ = write!(text, "{}", if i == document.selected { "*" } else { " " });
        shown.iter().for_each(|name| {
            let gain = step.gains.get(name).map_or(String::new(), |gain| number(gain.value));
            let _ = write!(text, "{gain:>11}");
        });
        let ReductionEntry { vaf, vaf_after_onset, vaf_cross_validated, aic, bic, .. } = step;
        let _ = writeln!(
            text,
            "{:>8}{:>8}{:>8}{aic:>11.1}{bic:>11.1}",
            percent(*vaf),
            optional(*vaf_after_onset),
            optional(*vaf_cross_validated)
        );
    }
    let _ = writeln!(
        text,
        "VAF: variance accounted for in %; onset: within 1 s of a perturbation's start; held: of parts of the record that were \
         not fitted; AIC, BIC: information criteria, less is better"
    );
}
