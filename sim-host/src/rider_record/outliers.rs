//! Samples that no ride reaches: error values of a logger, flipped bits.

use crate::range::plain;
use crate::replay::Timed;

/// One sample in this many is exceeded by the motion itself.
const RARE: usize = 100;
/// Magnitudes from which a sample is suspected and left out, in units of the magnitude that one sample in [`RARE`]
/// exceeds. The response to the only push of a long record is tens of these.
const SUSPECTED: f64 = 50.0;
const LEFT_OUT: f64 = 1000.0;

/// The magnitude that one value in [`RARE`] exceeds; zero of none.
pub(super) fn high(values: impl Iterator<Item = f64>) -> f64 {
    let mut magnitudes: Vec<f64> = values.map(f64::abs).collect();
    magnitudes.sort_by(f64::total_cmp);
    let place = magnitudes.len().saturating_sub(1 + magnitudes.len() / RARE);
    magnitudes.get(place).copied().unwrap_or(0.0)
}

/// The signal without impossible samples, and a remark about these and the suspected ones.
pub(super) fn without(unit: &str, signal: Timed) -> (Timed, Option<String>) {
    let high = high(signal.iter().map(|(_, value)| *value));
    let beyond = |times: f64, value: f64| high > 0.0 && value.abs() > times * high;
    let suspected: Timed = signal.iter().copied().filter(|(_, value)| beyond(SUSPECTED, *value)).collect();
    let count = signal.len();
    let (impossible, kept): (Timed, Timed) =
        signal.into_iter().partition(|(_, value)| beyond(LEFT_OUT, *value));
    let remark = suspected.first().map(|(t_s, value)| {
        format!(
            "outliers, {} of {count} samples, {} of them left out; the first is {} {unit} at {t_s} s, and 99 % of all are \
             within {high:.2e} {unit}",
            suspected.len(),
            impossible.len(),
            plain(*value)
        )
    });
    (kept, remark)
}
