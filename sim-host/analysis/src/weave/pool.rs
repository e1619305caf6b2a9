//! Combines repeats: the random-effects model of DerSimonian and Laird (1986), with the interval of Hartung
//! and Knapp (2001) in the form that is never narrower than the repeats' own errors allow (Röver et al.
//! 2015).
//!
//! The usual interval of 1.96 standard errors assumes a known scatter between repeats. With three repeats
//! that scatter it contains the true value in 80 to 90 %, that of Hartung and Knapp in 95 % and more.

use super::Estimate;
use super::student::quantile;

/// Combined repeats.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Pooled {
    /// Their mean.
    pub mean: Estimate,
    /// Standard deviation between repeats in excess of their errors; null for a single one.
    pub between: Option<f64>,
}

/// Mean of repeats. A single one keeps its interval; `None` if there is none.
pub fn pool(repeats: &[Estimate]) -> Option<Pooled> {
    let (first, k) = (repeats.first()?, repeats.len() as f64);
    if repeats.len() == 1 {
        return Some(Pooled { mean: *first, between: None });
    }
    let weighed = |between: f64| {
        let weights: Vec<f64> = repeats.iter().map(|e| 1.0 / (e.standard_error.powi(2) + between)).collect();
        let sum: f64 = weights.iter().sum();
        let mean = weights.iter().zip(repeats).map(|(w, e)| w * e.value).sum::<f64>() / sum;
        let off: f64 = weights.iter().zip(repeats).map(|(w, e)| w * (e.value - mean).powi(2)).sum();
        let squares: f64 = weights.iter().map(|w| w * w).sum();
        (mean, sum, off, squares)
    };
    let (_, sum, off, squares) = weighed(0.0);
    let between = ((off - (k - 1.0)) / (sum - squares / sum)).max(0.0);
    let (mean, sum, off, _) = weighed(between);
    let error = ((off / (k - 1.0)).max(1.0) / sum).sqrt();
    Some(Pooled { mean: Estimate::new(mean, error, quantile(k - 1.0)), between: Some(between.sqrt()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scatter_between_repeats_is_found() {
        let of = |value, error| Estimate::new(value, error, 2.0);
        let alike = pool(&[of(1.0, 0.1), of(1.01, 0.1), of(0.99, 0.2)]).unwrap();
        assert!((alike.mean.value - 1.003).abs() < 2e-3 && alike.between == Some(0.0));
        assert!((alike.mean.standard_error - (1.0_f64 / 225.0).sqrt()).abs() < 1e-12);
        // DerSimonian and Laird by hand: with equal errors, the sample variance minus the error's.
        let apart = pool(&[of(1.0, 0.1), of(2.0, 0.1), of(3.0, 0.1)]).unwrap();
        assert!((apart.between.unwrap().powi(2) - 0.99).abs() < 1e-9);
        assert!((apart.mean.high - 2.0 - 4.3027 / 3.0_f64.sqrt()).abs() < 1e-3);
        assert_eq!(pool(&[of(1.0, 0.1)]).unwrap().mean, of(1.0, 0.1));
        assert_eq!(pool(&[]), None);
    }
}
