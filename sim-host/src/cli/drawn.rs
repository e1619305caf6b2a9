//! Text of drawn bicycles or riders of `sim-host basin`.

use crate::commands::drawn::DrawnBasins;
use crate::report::document::UncertainEntry;
use crate::rider::Drawing;
use std::fmt::Write;

/// What was drawn.
fn noun(drawn: &DrawnBasins) -> &'static str {
    if drawn.riders.is_some() { "riders" } else { "bicycles" }
}

/// Label of the band in figures.
pub(super) fn label(drawn: &DrawnBasins) -> String {
    format!("5 % to 95 % of {} drawn {}", drawn.of.basins.len(), noun(drawn))
}

/// Text: what was drawn, and quantiles of area and mean height.
pub(super) fn summary(drawn: &DrawnBasins, speeds: &[f64]) -> String {
    let entry = UncertainEntry::new(&drawn.of);
    let at_least = if entry.capped > 0 { ", at least" } else { "" };
    let mut text = String::new();
    let mut line = |name, [low, middle, high]: [f64; 3], unit| {
        let (n, noun) = (entry.draws, noun(drawn));
        let _ = writeln!(
            text,
            "{name} of {n} drawn {noun}: 5 % {low:.3}, median {middle:.3}, 95 % {high:.3} {unit}{at_least}"
        );
    };
    if let Some(area) = entry.area {
        line("area", area, "rad m/s^2");
    }
    line("mean height", entry.mean_height, "rad/s");
    let Some(riders) = &drawn.riders else { return text };
    let from = match riders.from {
        Drawing::Posterior => "each set of gains from the normal distribution of its covariance",
        Drawing::Bootstrap => "the sets of each group with replacement (bootstrap)",
    };
    let _ = writeln!(text, "drawn: {from}");
    let most = riders.unstable.iter().zip(speeds).max_by_key(|(n, _)| **n);
    let _ = match most.filter(|(n, _)| **n > 0) {
        None => writeln!(text, "no drawn rider is linearly unstable at any of the speeds"),
        Some((most, _)) => {
            let some = riders.unstable.iter().filter(|n| **n > 0).count();
            let at = riders.unstable.iter().position(|n| n == most).map_or(0.0, |i| speeds[i]);
            writeln!(
                text,
                "linearly unstable drawn riders (part of all quantiles): at {some} of {} speeds; most, {most} of {}, \
                 at {at} m/s",
                speeds.len(),
                entry.draws
            )
        }
    };
    text
}
