//! The progress bar of long computations.

use super::outputs::complain;
use crate::sweep::Wait;
use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar with the remaining time, on standard error if it is a terminal.
pub(super) fn progress(shown: bool, command: &str, count: usize, what: &str) -> ProgressBar {
    if !shown {
        return ProgressBar::hidden();
    }
    // The message is above the bar, and is empty unless it is set.
    let template =
        format!("{{msg}}{command} {{bar:40}} {{pos}}/{{len}} {what}, {{elapsed}} gone, {{eta}} left");
    let style = ProgressStyle::with_template(&template);
    ProgressBar::new(count as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Prints on standard error, above the bar, for which other processes this one waits; nothing unless `shown`.
pub(super) fn print_wait(shown: bool, bar: &ProgressBar, wait: &Wait) {
    if shown {
        bar.suspend(|| complain(&wait.to_string()));
    }
}
