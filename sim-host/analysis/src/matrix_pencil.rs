//! Eigenvalues from a response: the matrix pencil (Hua and Sarkar 1990) of several signals with the same modes.

use crate::eigen::spectrum;
use nalgebra::{Complex, ComplexField, DMatrix};

/// The `order` eigenvalues \[1/s\] of equally long `signals`, sampled every `dt` seconds; largest real part first.
/// `None` if there are too few samples or a mode cannot be separated from the others.
pub fn eigenvalues(signals: &[Vec<f64>], dt: f64, order: usize) -> Option<Vec<Complex<f64>>> {
    let n = signals.first()?.len();
    let rows = n / 2;
    let columns = n.checked_sub(rows)?;
    if rows * signals.len() < order || columns < order {
        return None;
    }
    // Each signal is scaled to norm one, for equal weight.
    let scaled: Vec<Vec<f64>> = signals
        .iter()
        .map(|s| {
            let size = s.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
            s.iter().map(|x| x / size).collect()
        })
        .collect();
    let hankel = |shift: usize| {
        DMatrix::from_fn(rows * scaled.len(), columns - 1, |i, k| scaled[i / rows][i % rows + k + shift])
    };
    let svd = hankel(0).svd(true, true);
    let mut by_size: Vec<usize> = (0..svd.singular_values.len()).collect();
    by_size.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
    let (u, v_t, selected) = (svd.u.as_ref()?, svd.v_t.as_ref()?, by_size.get(..order)?);
    let (u, v_t) = (u.select_columns(selected), v_t.select_rows(selected));
    let mut pencil = u.transpose() * hankel(1) * v_t.transpose();
    for (column, &k) in selected.iter().enumerate() {
        let size = svd.singular_values[k];
        if size <= 0.0 {
            return None;
        }
        pencil.column_mut(column).scale_mut(1.0 / size);
    }
    let mut found: Vec<_> = spectrum(&pencil)?.into_iter().map(|z| ComplexField::ln(z) / dt).collect();
    found.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    found.iter().all(|e| e.re.is_finite() && e.im.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_that_were_put_in_come_out() {
        let t = |k: usize| 0.02 * k as f64;
        let pair = |k: usize| libm::exp(0.4 * t(k)) * libm::cos(3.0 * t(k));
        let fast = |k: usize| libm::exp(-14.0 * t(k));
        let a: Vec<f64> = (0..75).map(|k| pair(k) + 0.5 * fast(k)).collect();
        let b: Vec<f64> = (0..75).map(|k| pair(k) - 2.0 * fast(k)).collect();
        let found = eigenvalues(&[a, b], 0.02, 3).unwrap();
        for (e, (re, im)) in found.iter().zip([(0.4, 3.0), (0.4, -3.0), (-14.0, 0.0)]) {
            assert!((e - Complex::new(re, im)).modulus() < 1e-8, "{found:?}");
        }
        assert_eq!(eigenvalues(&[vec![1.0, 2.0]], 0.02, 3), None);
        assert_eq!(eigenvalues(&[], 0.02, 1), None);
    }
}
