//! The table of docs/safety.md with the times until the bridge is open on the board's image.

use std::path::Path;

/// Times that depend on the fault's phase in the PWM period \[us\], and their tolerance.
const PHASED_US: f64 = 5.0;
const PERIOD_US: f64 = 50.0;

/// The page's line of a fault must have the measured time until the bridge is open \[us\], to a tenth and 1 us, or a
/// PWM period where an interrupt has to come first, and the text that reports the reason.
pub(crate) fn check(fault: &str, open_us: f64, reason: &str) {
    let fresh = format!("| {fault} | {} | {reason} |", time(open_us));
    println!("{fresh}");
    let page = page();
    let line = page.lines().find(|line| line.starts_with(&format!("| {fault} |")));
    let line = line.unwrap_or_else(|| panic!("docs/safety.md has no line\n{fresh}"));
    let cells: Vec<_> = line.split('|').map(str::trim).collect();
    assert_eq!(cells.get(3), Some(&reason), "docs/safety.md: {line}");
    let page_us =
        cells.get(2).and_then(|cell| microseconds(cell)).unwrap_or_else(|| panic!("no time in {line}"));
    let phase_us = if page_us > PHASED_US { PERIOD_US } else { 1.0 };
    assert!(
        (page_us - open_us).abs() <= phase_us + 0.1 * open_us,
        "docs/safety.md log_has\n{line}, here\n{fresh}"
    );
}

/// The time in milliseconds that the page states after this text.
pub(crate) fn guaranteed_ms(text: &str) -> f64 {
    let page = page();
    let (_, rest) = page.split_once(text).unwrap_or_else(|| panic!("docs/safety.md has no {text:?}"));
    let number = rest.split_once(" ms").and_then(|(number, _)| number.parse().ok());
    number.unwrap_or_else(|| panic!("docs/safety.md: no time in ms after {text:?}"))
}

fn page() -> String {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/safety.md");
    std::fs::read_to_string(page).expect("the page")
}

fn time(us: f64) -> String {
    if us < 1000.0 { format!("{us:.1} us") } else { format!("{:.1} ms", us * 1e-3) }
}

fn microseconds(cell: &str) -> Option<f64> {
    let (number, unit) = cell.split_once(' ')?;
    let scale = match unit {
        "us" => 1.0,
        "ms" => 1e3,
        _ => return None,
    };
    Some(number.parse::<f64>().ok()? * scale)
}
