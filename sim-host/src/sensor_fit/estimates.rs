//! Estimates with intervals: means, shares, quantiles.

use crate::weave::Estimate;
use crate::weave::pool::pool;
use crate::weave::student::quantile;

/// Rounds to four digits, more than the accuracy of any of these numbers; rounding residues become zero.
pub(super) fn digits(x: f64) -> f64 {
    if x.abs() < 1e-12 {
        return 0.0;
    }
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// Mean of independent values with its interval by Student's t; none for fewer than two.
pub(super) fn mean(values: &[f64]) -> Option<Estimate> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (values.len() > 1).then(|| Estimate::new(mean, (square / n).sqrt(), quantile(n - 1.0)))
}

/// Combined mean of the recordings; scatter between them widens the interval.
pub(super) fn pooled(recordings: &[Vec<f64>]) -> Option<Estimate> {
    let means: Vec<Estimate> = recordings.iter().filter_map(|values| mean(values)).collect();
    // Equal values have no error to weigh by.
    if means.iter().any(|mean| mean.standard_error == 0.0) {
        return mean(&recordings.concat());
    }
    pool(&means).map(|pooled| pooled.mean)
}

/// Square root of a power that can't be negative.
pub(super) fn root(power: Estimate) -> Estimate {
    let root = |x: f64| x.max(0.0).sqrt();
    let value = root(power.value);
    let standard_error = if value > 0.0 { 0.5 * power.standard_error / value } else { 0.0 };
    Estimate { value, standard_error, low: root(power.low), high: root(power.high) }
}

/// Share of `n` events, with Wilson's interval.
pub(super) fn share(events: usize, n: usize) -> Estimate {
    let (n, z) = (n.max(1) as f64, quantile(1e9));
    let p = events as f64 / n;
    let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    Estimate {
        value: p,
        standard_error: half / z,
        low: (middle - half).max(0.0),
        high: (middle + half).min(1.0),
    }
}

/// Quantile of sorted values, with its interval by order statistics.
pub(super) fn part_of(sorted: &[f64], part: f64) -> Estimate {
    let n = sorted.len() as f64;
    let at = |share: f64| sorted[((n - 1.0) * share.clamp(0.0, 1.0)).round() as usize];
    let half = quantile(1e9) * (part * (1.0 - part) / n).sqrt();
    let (value, low, high) = (at(part), at(part - half), at(part + half));
    Estimate { value, standard_error: 0.25 * (high - low), low, high }
}

/// An observed number, without an interval.
pub(super) const fn observed(value: f64) -> Estimate {
    Estimate { value, standard_error: 0.0, low: value, high: value }
}
