//! Covariance of a measured set of gains.

use super::{CovarianceError, Gains, KEYS};
use crate::range::within;
use nalgebra::{DMatrix, DVector};

/// Largest standard deviation of a gain, in the gain's unit: that of the gains themselves.
const MAX_DEVIATION: f64 = 1e5;
/// Tolerated asymmetry, and tolerated negative eigenvalue per gain, of the correlation matrix: rounding of the
/// numbers of a file.
const ROUNDING: f64 = 1e-6;

/// Covariance matrix of a set of gains, in products of their units: symmetric and positive semidefinite, in
/// the order of [`RiderTable::columns`](super::RiderTable::columns).
#[derive(Clone, Debug, PartialEq)]
pub struct Covariance(DMatrix<f64>);

impl Covariance {
    /// A checked covariance of the gains with the indices `columns` of [`KEYS`]; the mean of the matrix and its
    /// transpose, so that it is symmetric to the bit.
    ///
    /// # Errors
    /// Not a row and a column per gain; a value outside its range; not symmetric; not positive semidefinite.
    pub fn new(matrix: &DMatrix<f64>, columns: &[usize]) -> Result<Self, CovarianceError> {
        let (gains, rows, cells) = (columns.len(), matrix.nrows(), matrix.ncols());
        if (rows, cells) != (gains, gains) {
            return Err(CovarianceError::Shape { gains, rows, columns: cells });
        }
        let pair =
            |i: usize, j: usize| format!("covariance of {} and {}", KEYS[columns[i]], KEYS[columns[j]]);
        for i in 0..gains {
            let name = format!("variance of {}", KEYS[columns[i]]);
            within(&name, matrix[(i, i)], 0.0, MAX_DEVIATION * MAX_DEVIATION)?;
        }
        for i in 0..gains {
            for j in 0..gains {
                let most = (matrix[(i, i)] * matrix[(j, j)]).sqrt();
                let rounding = ROUNDING * most;
                within(&pair(i, j), matrix[(i, j)], -most - rounding, most + rounding)?;
                if (matrix[(i, j)] - matrix[(j, i)]).abs() > rounding {
                    let (above, below) = (matrix[(i, j)], matrix[(j, i)]);
                    return Err(CovarianceError::Asymmetric { pair: pair(i, j), above, below });
                }
            }
        }
        let covariance = Self((matrix + matrix.transpose()) / 2.0);
        let smallest = covariance.correlation().symmetric_eigenvalues().min();
        let name = "smallest eigenvalue of the correlation matrix";
        within(name, smallest, -ROUNDING * gains as f64, gains as f64)?;
        Ok(covariance)
    }

    /// The matrix.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.0
    }

    /// The matrix as lists, row by row.
    pub fn rows(&self) -> Vec<Vec<f64>> {
        self.0.row_iter().map(|row| row.iter().copied().collect()).collect()
    }

    /// Standard error of each gain, in the gain's unit.
    pub fn standard_errors(&self) -> Vec<f64> {
        self.0.diagonal().iter().map(|variance| variance.sqrt()).collect()
    }

    /// Gains drawn from the normal distribution with this covariance about `mean`, from a standard normal
    /// number per column.
    pub fn draw(&self, mean: &Gains, columns: &[usize], normal: &DVector<f64>) -> Gains {
        let eigen = self.correlation().symmetric_eigen();
        let scales = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
        let unit = &eigen.eigenvectors * scales.component_mul(normal);
        let mut gains = *mean;
        for ((&i, error), z) in columns.iter().zip(self.standard_errors()).zip(unit.iter()) {
            gains.0[i] += error * z;
        }
        gains
    }

    /// The covariance divided by the standard errors; zero for a gain without error.
    fn correlation(&self) -> DMatrix<f64> {
        let errors = self.standard_errors();
        DMatrix::from_fn(self.0.nrows(), self.0.ncols(), |i, j| {
            let product = errors[i] * errors[j];
            if product > 0.0 { self.0[(i, j)] / product } else { 0.0 }
        })
    }
}
