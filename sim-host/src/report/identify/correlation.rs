//! Correlation of residuals with themselves and with the perturbation (Ljung 1999, section 16.6). A residual that is
//! correlated with a past perturbation is a part of the response that the model lacks; a residual that is correlated with
//! itself only is coloured noise, such as the rider's own motion.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// 97.5 % quantile of the normal distribution: the half width of a 95 % interval in standard deviations.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Cross-correlation coefficient of `a[k]` and `b[k + lag]` at the lags from `-reach` to `reach`, from -1 to 1: mean product
/// over the samples that both have, in standard deviations. Samples that are not finite are missing; zero without any.
pub fn cross_correlation(a: &[f64], b: &[f64], reach: usize) -> Vec<f64> {
    let count = a.len().min(b.len());
    let ([a, has_a], [b, has_b]) = (centred(&a[..count]), centred(&b[..count]));
    let power = |x: &[f64], has: &[f64]| x.iter().map(|x| x * x).sum::<f64>() / has.iter().sum::<f64>();
    let scale = (power(&a, &has_a) * power(&b, &has_b)).sqrt();
    let pairs = products(&has_a, &has_b, reach);
    let mean = |(sum, pairs): (f64, f64)| match pairs.round() {
        pairs if pairs > 0.0 && scale > 0.0 => sum / pairs / scale,
        _ => 0.0,
    };
    products(&a, &b, reach).into_iter().zip(pairs).map(mean).collect()
}

/// Autocorrelation coefficient at the lags from 0 to `reach`.
pub fn autocorrelation(values: &[f64], reach: usize) -> Vec<f64> {
    cross_correlation(values, values, reach).split_off(reach)
}

/// Half width of the 95 % band of the autocorrelation of white noise with as many samples as `values` has.
pub fn white_band(values: &[f64]) -> f64 {
    NORMAL_95 / (values.iter().filter(|x| x.is_finite()).count().max(1) as f64).sqrt()
}

/// Half width of the 95 % band of the cross-correlation of sequences that are independent of each other and coloured like `a`
/// and `b`: its variance is the sum of the product of both autocorrelations over the number of samples, here up to `reach`
/// lags with Bartlett's window.
pub fn independent_band(a: &[f64], b: &[f64], reach: usize) -> f64 {
    let (of_a, of_b) = (autocorrelation(a, reach), autocorrelation(b, reach));
    let window = |lag: usize| 1.0 - lag as f64 / (reach + 1) as f64;
    let sum: f64 = (1..=reach).map(|lag| window(lag) * of_a[lag] * of_b[lag]).sum();
    let both = a.iter().zip(b).filter(|(a, b)| a.is_finite() && b.is_finite()).count();
    NORMAL_95 * ((1.0 + 2.0 * sum).max(0.0) / both.max(1) as f64).sqrt()
}

/// The values less their mean, zero where missing; and 1 for each value, 0 where missing.
fn centred(values: &[f64]) -> [Vec<f64>; 2] {
    let (sum, count) =
        values.iter().filter(|x| x.is_finite()).fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    let mean = sum / f64::max(count, 1.0);
    let less_mean = |x: &f64| if x.is_finite() { x - mean } else { 0.0 };
    let present = |x: &f64| f64::from(u8::from(x.is_finite()));
    [values.iter().map(less_mean).collect(), values.iter().map(present).collect()]
}

/// `sum a[k] b[k + lag]` at the lags from `-reach` to `reach`.
fn products(a: &[f64], b: &[f64], reach: usize) -> Vec<f64> {
    let length = (a.len() + reach).next_power_of_two();
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
    let spectrum = |values: &[f64]| {
        let mut padded = values.to_vec();
        padded.resize(length, 0.0);
        let mut spectrum = forward.make_output_vec();
        // The lengths are those of the plan: there is no other error.
        let _ = forward.process(&mut padded, &mut spectrum);
        spectrum
    };
    let mut product: Vec<Complex<f64>> =
        spectrum(a).iter().zip(spectrum(b)).map(|(a, b)| a.conj() * b).collect();
    let mut sums = inverse.make_output_vec();
    let _ = inverse.process(&mut product, &mut sums);
    let scaled = |at: usize| sums[at] / length as f64;
    (length - reach..length).chain(0..=reach).map(scaled).collect()
}
