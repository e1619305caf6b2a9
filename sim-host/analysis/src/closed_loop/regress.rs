//! Linear regression with standard errors that hold for correlated residuals.
//!
//! The errors are those of Newey and West (1987), "A simple, positive semi-definite, heteroskedasticity and
//! autocorrelation consistent covariance matrix": residuals of a ride stay correlated for about a second, and errors for
//! white residuals would be too small by several times. Robust weights are Tukey's biweight, started from the least
//! absolute deviations (Huber and Ronchetti 2009, chapter 7): a law that holds for most samples is found exactly,
//! whatever the other samples follow.

use crate::weave::Estimate;
use crate::weave::student::quantile;
use nalgebra::{DMatrix, DVector};

/// Weights of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// All the same: least squares.
    Equal,
    /// Small for samples far off.
    Robust,
}

/// Iterations of the least absolute deviations and of the biweight.
const ROUNDS: [usize; 2] = [40, 60];
/// Residual below which a sample counts as met exactly, relative to the observations.
const EXACT: [f64; 2] = [1e-6, 1e-9];
/// Width of the biweight in standard deviations: 95 % efficiency for normal residuals.
const WIDTH: f64 = 4.685;
/// Median of the absolute value of a normal number in standard deviations.
const MEDIAN: f64 = 0.6745;
/// Least degrees of freedom of an interval.
const LEAST_FREEDOM: f64 = 3.0;

/// Result of a regression.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Coefficients, one for each column.
    pub coefficients: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Degrees of freedom of the intervals: independent stretches less coefficients.
    pub freedom: f64,
    /// Fraction of samples that follow the fit; 1 for equal weights.
    pub followed: f64,
    /// Explained fraction of the variance.
    pub vaf: f64,
    /// Explained fraction of the variance of the samples that follow.
    pub vaf_followed: f64,
    /// Standard deviation of the residual, of robust weights by its median.
    pub deviation: f64,
}

impl Fit {
    /// A coefficient.
    pub fn estimate(&self, i: usize) -> Estimate {
        Estimate::new(self.coefficients[i], self.covariance[(i, i)].max(0.0).sqrt(), quantile(self.freedom))
    }

    /// Coefficient `i` over coefficient `j`, with its error to first order.
    pub fn ratio(&self, i: usize, j: usize) -> Estimate {
        let (b, v) = (&self.coefficients, &self.covariance);
        let ratio = b[i] / b[j];
        let variance = (v[(i, i)] - 2.0 * ratio * v[(i, j)] + ratio * ratio * v[(j, j)]) / (b[j] * b[j]);
        Estimate::new(ratio, variance.max(0.0).sqrt(), quantile(self.freedom))
    }
}

/// Regresses `y` on the columns of `x`; residuals may be correlated over `memory` samples. `None` if the columns are
/// linearly dependent.
pub fn regress(x: &DMatrix<f64>, y: &DVector<f64>, weights: Weights, memory: usize) -> Option<Fit> {
    let rms = |column: &[f64]| (column.iter().map(|v| v * v).sum::<f64>() / column.len() as f64).sqrt();
    let scales: Vec<f64> = x.column_iter().map(|column| rms(column.as_slice())).collect();
    if scales.iter().any(|scale| !scale.is_normal()) {
        return None;
    }
    let z = DMatrix::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)] / scales[j]);
    let mut b = DVector::zeros(z.ncols());
    let mut weight = vec![1.0; y.len()];
    // The second step removes the rounding of the first.
    for _ in 0..2 {
        b += step(&z, &weight, &(y - &z * &b))?;
    }
    let size = rms(y.as_slice());
    let mut slope = weight.clone();
    let mut deviation = rms((y - &z * &b).as_slice());
    if weights == Weights::Robust {
        for _ in 0..ROUNDS[0] {
            let rest = y - &z * &b;
            let least = EXACT[0] * size;
            weight.iter_mut().zip(&rest).for_each(|(w, r)| *w = least / r.abs().max(least));
            b += step(&z, &weight, &rest)?;
        }
        deviation = (median((y - &z * &b).iter().map(|r| r.abs()).collect()) / MEDIAN).max(EXACT[1] * size);
        for _ in 0..ROUNDS[1] {
            let rest = y - &z * &b;
            biweight(&rest, deviation, &mut weight, &mut slope);
            let change = step(&z, &weight, &rest)?;
            b += &change;
            if change.norm() <= 1e-13 * b.norm() {
                break;
            }
        }
        biweight(&(y - &z * &b), deviation, &mut weight, &mut slope);
    }
    let rest = y - &z * &b;
    let followed: Vec<bool> = weight.iter().map(|w| *w > 0.5).collect();
    let count = followed.iter().filter(|follows| **follows).count() as f64;
    let inverse = gram(&z, &slope).cholesky()?.inverse();
    let scores = DMatrix::from_fn(z.nrows(), z.ncols(), |i, j| z[(i, j)] * weight[i] * rest[i]);
    let mut covariance = &inverse * long_run(&scores, memory) * &inverse;
    for i in 0..scales.len() {
        b[i] /= scales[i];
        for j in 0..scales.len() {
            covariance[(i, j)] /= scales[i] * scales[j];
        }
    }
    let all = vec![true; y.len()];
    Some(Fit {
        covariance,
        freedom: (count / memory.max(1) as f64 - b.len() as f64).max(LEAST_FREEDOM),
        followed: count / y.len() as f64,
        vaf: explained(y.as_slice(), rest.as_slice(), &all),
        vaf_followed: explained(y.as_slice(), rest.as_slice(), &followed),
        deviation,
        coefficients: b,
    })
}

/// Explained fraction of the variance of the marked samples.
pub(super) fn explained(y: &[f64], rest: &[f64], marked: &[bool]) -> f64 {
    let variance = |values: &[f64]| {
        let of = || values.iter().zip(marked).filter(|(_, mark)| **mark).map(|(value, _)| *value);
        let n = of().count().max(1) as f64;
        let mean = of().sum::<f64>() / n;
        of().map(|value| (value - mean).powi(2)).sum::<f64>() / n
    };
    1.0 - variance(rest) / variance(y).max(f64::MIN_POSITIVE)
}

/// Sum of the outer products of scores with Bartlett's weights up to `memory` samples apart, as the mean over windows of
/// that length.
pub(super) fn long_run(scores: &DMatrix<f64>, memory: usize) -> DMatrix<f64> {
    let (n, p) = scores.shape();
    let length = memory.clamp(1, n);
    let mut sum = DVector::<f64>::zeros(p);
    let mut total = DMatrix::zeros(p, p);
    for end in 0..n + length - 1 {
        for j in 0..p {
            sum[j] += if end < n { scores[(end, j)] } else { 0.0 };
            sum[j] -= if end >= length { scores[(end - length, j)] } else { 0.0 };
        }
        total.ger(1.0, &sum, &sum, 1.0);
    }
    total / length as f64
}

fn gram(z: &DMatrix<f64>, weight: &[f64]) -> DMatrix<f64> {
    let weighted = DMatrix::from_fn(z.nrows(), z.ncols(), |i, j| z[(i, j)] * weight[i]);
    z.tr_mul(&weighted)
}

/// Change of the coefficients that minimises the weighted squares of what is left.
fn step(z: &DMatrix<f64>, weight: &[f64], rest: &DVector<f64>) -> Option<DVector<f64>> {
    let right = DVector::from_iterator(rest.len(), rest.iter().zip(weight).map(|(r, w)| r * w));
    Some(gram(z, weight).cholesky()?.solve(&z.tr_mul(&right)))
}

/// Weights of the biweight, and the slope of its score.
fn biweight(rest: &DVector<f64>, deviation: f64, weight: &mut [f64], slope: &mut [f64]) {
    for ((r, w), s) in rest.iter().zip(weight).zip(slope) {
        let square = (r / (WIDTH * deviation)).powi(2);
        let inside = (1.0 - square).max(0.0);
        *w = inside * inside;
        *s = if square < 1.0 { inside * (1.0 - 5.0 * square) } else { 0.0 };
    }
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
