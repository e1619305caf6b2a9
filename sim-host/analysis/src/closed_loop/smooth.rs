//! Values and derivatives by a local parabola (Savitzky and Golay 1964).

/// Value (`derivative` 0), first or second derivative of samples of one period, by a parabola through each sample and
/// `half` to either side. NaN where the window leaves the samples, contains a NaN or crosses one of the `breaks`.
pub(super) fn smooth(
    values: &[f64],
    period_s: f64,
    half: usize,
    derivative: i32,
    breaks: &[usize],
) -> Vec<f64> {
    let offsets = || (0..=2 * half).map(|i| i as f64 - half as f64);
    let power = |k: i32| offsets().map(|j| j.powi(k)).sum::<f64>();
    let (s0, s2, s4) = (power(0), power(2), power(4));
    let determinant = s0 * s4 - s2 * s2;
    let weight = |j: f64| match derivative {
        0 => (s4 - s2 * j * j) / determinant,
        1 => j / s2,
        _ => 2.0 * (s0 * j * j - s2) / determinant,
    };
    let weights: Vec<f64> = offsets().map(|j| weight(j) / period_s.powi(derivative)).collect();
    let mut smoothed = vec![f64::NAN; values.len()];
    for run in breaks.windows(2).map(|ends| ends[0]..ends[1]) {
        for (i, window) in values[run.clone()].windows(weights.len()).enumerate() {
            smoothed[run.start + half + i] = weights.iter().zip(window).map(|(w, x)| w * x).sum();
        }
    }
    smoothed
}
