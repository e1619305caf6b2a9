//! Discretised infinitesimal generator of a delay system: a matrix whose rightmost eigenvalues approximate
//! the system's characteristic roots (Breda, Maset, Vermiglio 2005, SIAM J. Sci. Comput. 27, 482-495).

use super::qr::spectrum;
use super::system::DelaySystem;
use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix};

/// The generator, with the history of the signal at `nodes` Chebyshev points.
///
/// Only one signal is delayed, so only its history is discretised. `u(theta) = z(t + theta)` is transported
/// by `du/dt = du/dtheta` from `u(0) = k x` to `u(-delay)`, which acts on `x`.
pub(super) fn generator(system: &DelaySystem, nodes: usize) -> DMatrix<f64> {
    let n = system.a.nrows();
    let d = differentiation(nodes) * (2.0 / system.delay_s);
    let mut g = DMatrix::zeros(n + nodes, n + nodes);
    g.view_mut((0, 0), (n, n)).copy_from(&system.a);
    g.view_mut((0, n + nodes - 1), (n, 1)).copy_from(&system.b);
    let below = d.column(0).rows(1, nodes).into_owned() * &system.k;
    g.view_mut((n, 0), (nodes, n)).copy_from(&below);
    g.view_mut((n, n), (nodes, nodes)).copy_from(&d.view((1, 1), (nodes, nodes)));
    g
}

/// Differentiation matrix for values at `cos(j pi / n)`, j = 0 to `n` (Trefethen 2000, Spectral Methods in
/// MATLAB, chapter 6).
fn differentiation(n: usize) -> DMatrix<f64> {
    let x: Vec<f64> = (0..=n).map(|j| libm::cos(std::f64::consts::PI * j as f64 / n as f64)).collect();
    let weight = |j: usize| {
        let end = if j == 0 || j == n { 2.0 } else { 1.0 };
        if j.is_multiple_of(2) { end } else { -end }
    };
    let mut d =
        DMatrix::from_fn(
            n + 1,
            n + 1,
            |i, j| {
                if i == j { 0.0 } else { weight(i) / weight(j) / (x[i] - x[j]) }
            },
        );
    for i in 0..=n {
        d[(i, i)] = -d.row(i).sum();
    }
    d
}

/// All eigenvalues of a matrix, balanced before; `None` as of [`spectrum`].
pub(super) fn eigenvalues(mut matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    balance_parlett_reinsch(&mut matrix);
    spectrum(&matrix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_differentiated_exactly() {
        let n = 9;
        let x =
            nalgebra::DVector::from_fn(n + 1, |j, _| libm::cos(std::f64::consts::PI * j as f64 / n as f64));
        let derivative = differentiation(n) * x.map(|x| x.powi(7));
        let off = (derivative - x.map(|x| 7.0 * x.powi(6))).amax();
        assert!(off < 1e-12, "{off:e}");
    }
}
