//! The matrix exponential: scaled by a power of two, a Padé approximant, squared.

use nalgebra::{DMatrix, SMatrix};

/// Degree of numerator and denominator. With the norm of [`LARGEST`] the relative error is below 4e-16 (Golub and Van Loan,
/// Matrix Computations, 2013, section 9.3.1).
const DEGREE: u32 = 6;
/// Norm from which the matrix is scaled.
const LARGEST: f64 = 0.5;

/// Exponential of a square matrix of finite numbers. Each doubling of the norm beyond a half doubles the rounding error.
///
/// nalgebra's own needs its feature `std`, by which products of matrices depend on the processor.
pub fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let norm = matrix.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
    let squarings = (libm::ceil(libm::log2(norm / LARGEST)) as i32).clamp(0, 1000);
    let scaled = matrix * libm::ldexp(1.0, -squarings);
    let identity = DMatrix::<f64>::identity(matrix.nrows(), matrix.ncols());
    let (mut power, mut coefficient) = (identity.clone(), 1.0);
    let [mut numerator, mut denominator] = [identity.clone(), identity];
    for k in 1..=DEGREE {
        coefficient *= f64::from(DEGREE - k + 1) / f64::from(k * (2 * DEGREE - k + 1));
        power = &scaled * power;
        numerator += &power * coefficient;
        denominator += &power * if k % 2 == 0 { coefficient } else { -coefficient };
    }
    // A norm of a half leaves the denominator regular.
    let mut result = denominator.lu().solve(&numerator).unwrap_or(numerator);
    for _ in 0..squarings {
        result = &result * &result;
    }
    result
}

/// [`exponential`] of a matrix whose size is known to the compiler.
pub(crate) fn exponential_of<const N: usize>(matrix: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    SMatrix::from_column_slice(exponential(&DMatrix::from_column_slice(N, N, matrix.as_slice())).as_slice())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Situation: a rotation by an angle, alone, of several turns, and of nothing. Must hold: cosine and sine of the angle.
    #[test]
    fn a_rotation_has_cosine_and_sine() {
        for angle in [0.0_f64, 1e-9, 0.3, 2.0, 40.0] {
            let found = exponential_of(&SMatrix::<f64, 2, 2>::new(0.0, -angle, angle, 0.0));
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let error = (found - SMatrix::<f64, 2, 2>::new(cosine, -sine, sine, cosine)).amax();
            assert!(error < 1e-15 * (4.0 + 20.0 * angle), "{angle}: {error:e}");
        }
    }

    /// Situation: a nilpotent matrix, a decay, and entries of very different size. Must hold: the series that ends, and the
    /// exponentials on the diagonal.
    #[test]
    fn closed_forms_hold() {
        let nilpotent = SMatrix::<f64, 3, 3>::new(0.0, 3.0, 5.0, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0);
        let series = SMatrix::identity() + nilpotent + nilpotent * nilpotent / 2.0;
        assert!((exponential_of(&nilpotent) - series).amax() < 1e-13);
        let triangle = SMatrix::<f64, 2, 2>::new(-1e3, 1e4, 0.0, -1e-3);
        let found = exponential_of(&triangle);
        let (fast, slow) = (libm::exp(-1e3), libm::exp(-1e-3));
        assert!((found[(0, 0)] - fast).abs() < 1e-300_f64.max(1e-10 * fast));
        // The norm is scaled by 2^-15.
        assert!((found[(1, 1)] - slow).abs() < 32_768.0 * 2e-16, "{:e}", found[(1, 1)] - slow);
        // The divided difference of the exponential.
        let beside = 1e4 * (slow - fast) / (-1e-3 + 1e3);
        assert!((found[(0, 1)] - beside).abs() < 1e-11 * beside, "{} {beside}", found[(0, 1)]);
    }
}
