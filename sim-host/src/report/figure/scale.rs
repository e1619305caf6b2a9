//! Round numbers for axes.

use kuva::render::render_utils::{auto_nice_range, compute_tick_step, generate_ticks};

/// Round numbers in a range, with their texts.
pub(in crate::report) fn ticks(range: (f64, f64), count: usize) -> Vec<(f64, String)> {
    let count = count.clamp(3, 10);
    let step = compute_tick_step(range.0, range.1, count);
    let decimals = (1..6).find(|&d| (step * 10f64.powi(d)).fract() < 1e-9).unwrap_or(6) as usize;
    let decimals = if step.fract() == 0.0 { 0 } else { decimals };
    // + 0.0 turns -0 into 0.
    generate_ticks(range.0, range.1, count)
        .into_iter()
        .map(|v| (v, format!("{:.decimals$}", v + 0.0)))
        .collect()
}

/// A range with round ends around the finite values; 0 to 1 without any.
pub(in crate::report) fn nice(values: impl IntoIterator<Item = f64>, count: usize) -> (f64, f64) {
    let finite = values.into_iter().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low > high { (0.0, 1.0) } else { auto_nice_range(low, high, count) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        let texts = |range, n| ticks(range, n).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(texts((0.0, 10.0), 5), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(texts((-0.5, 0.5), 4), ["-0.50", "-0.25", "0.00", "0.25", "0.50"]);
    }

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(nice([], 5), (0.0, 1.0));
        for values in [vec![0.0], vec![7.0, 7.0], vec![f64::NAN, 2.0]] {
            let (low, high) = nice(values, 5);
            assert!(low < high);
        }
    }
}
