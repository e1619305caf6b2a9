//! Eigenvalues of real matrices by the QR iteration.

use nalgebra::allocator::Allocator;
use nalgebra::linalg::Schur;
use nalgebra::{Complex, DefaultAllocator, DimDiff, DimSub, OMatrix, OVector, U1};

/// Iterations per row before the iteration counts as stagnated; it usually takes two or three.
const ITERATIONS_PER_ROW: usize = 100;
/// Largest number of similar matrices that are tried.
const ATTEMPTS: usize = 8;

/// All eigenvalues of a square matrix, in no order; `None` if it has entries that are not finite, or if no attempt converges.
///
/// The double-shift QR iteration of nalgebra has no exceptional shifts, so a matrix can stagnate: its shifts repeat. Then
/// it is repeated on the matrix reflected from both sides, which has the same eigenvalues and another sequence of shifts.
pub fn spectrum<D>(matrix: &OMatrix<f64, D, D>) -> Option<Vec<Complex<f64>>>
where
    D: DimSub<U1>,
    DefaultAllocator:
        Allocator<D, DimDiff<D, U1>> + Allocator<DimDiff<D, U1>> + Allocator<D, D> + Allocator<D>,
{
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let iterations = ITERATIONS_PER_ROW * matrix.nrows();
    let schur = |attempt| Schur::try_new(similar(matrix, attempt), f64::EPSILON, iterations);
    let found = (0..ATTEMPTS).find_map(schur)?;
    Some(found.complex_eigenvalues().iter().copied().collect())
}

/// The matrix itself at first, then its reflections `(I - 2 v v') A (I - 2 v v')` with different unit vectors `v`.
fn similar<D>(matrix: &OMatrix<f64, D, D>, attempt: usize) -> OMatrix<f64, D, D>
where
    D: DimSub<U1>,
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    let mut reflected = matrix.clone_owned();
    if attempt == 0 {
        return reflected;
    }
    let size = matrix.shape_generic().0;
    let v = OVector::<f64, D>::from_fn_generic(size, U1, |i, _| libm::cos((attempt * (i + 1)) as f64));
    let factor = -2.0 / v.norm_squared();
    let column = matrix * &v;
    reflected.ger(factor, &column, &v, 1.0);
    let row = reflected.tr_mul(&v);
    reflected.ger(factor, &v, &row, 1.0);
    reflected
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, Matrix4};

    #[test]
    fn every_reflection_has_the_same_eigenvalues() {
        let a = DMatrix::from_row_slice(3, 3, &[1.0, 7.0, -2.0, 0.0, 2.0, 5.0, 0.0, 0.0, 3.0]);
        for attempt in 0..ATTEMPTS {
            let mut real: Vec<f64> =
                similar(&a, attempt).complex_eigenvalues().iter().map(|e| e.re).collect();
            real.sort_by(f64::total_cmp);
            assert!(real.iter().zip([1.0, 2.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{real:?}");
        }
    }

    #[test]
    fn what_is_not_finite_has_none() {
        assert_eq!(spectrum(&DMatrix::from_element(3, 3, f64::NAN)), None);
        assert_eq!(spectrum(&Matrix4::from_element(f64::INFINITY)), None);
    }
}
