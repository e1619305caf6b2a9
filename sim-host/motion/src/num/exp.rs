//! The exponential function of several numbers side by side: sums and products only.

use super::Scalar;

/// e to the power of `x`. The relative error is below 5e-11 from -40 to 10, the range of the laws' formulas within 30 m/s; far below,
/// the result is nearly zero.
#[inline(always)]
pub(super) fn exp<S: Scalar>(x: S) -> S {
    /// Repeated squarings: the series is that of the 64th part of the exponent.
    const SQUARINGS: u32 = 6;
    /// The series' coefficients, 1/n!.
    const SERIES: [f64; 13] = {
        let mut series = [1.0; 13];
        let mut n = 1;
        while n < series.len() {
            series[n] = series[n - 1] / n as f64;
            n += 1;
        }
        series
    };
    // Of the opposite exponent: its terms then have one sign where the exponent is large.
    let y = x * (-1.0 / (1 << SQUARINGS) as f64);
    let mut power = S::constant(SERIES[SERIES.len() - 1]);
    for n in (0..SERIES.len() - 1).rev() {
        power = power * y + SERIES[n];
    }
    for _ in 0..SQUARINGS {
        power = power * power;
    }
    S::constant(1.0) / power
}

#[cfg(test)]
mod tests {
    use super::exp;

    #[test]
    fn agrees_with_libm() {
        let mut largest = 0.0_f64;
        for i in -40_000..=10_000 {
            let x = f64::from(i) * 1e-3;
            largest = largest.max((exp(x) / libm::exp(x) - 1.0).abs());
        }
        assert!((1e-16..5e-11).contains(&largest), "{largest:e}");
        assert!(
            (0.0..1e-17).contains(&exp(-60.0)) && (0.0..1e-60).contains(&exp(-1e3)),
            "nearly zero far below"
        );
    }
}
