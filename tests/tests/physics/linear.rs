//! The linear model: published matrices and eigenvalues, and the linearisation of the nonlinear equations.

use control::Law;
use nalgebra::{Complex, Matrix2};
use sim_host::bicycle::Geometry;
use sim_host::bicycle::linear::Linear;
use sim_host::eigen::eigenvalues;
use tests::linearised::linearise;
use tests::published::entry;
use tests::rides::{all_shipped, shipped};

fn difference(a: &Matrix2<f64>, b: &Matrix2<f64>) -> f64 {
    (a - b).abs().max()
}

fn matrix([a, b]: [[f64; 2]; 2]) -> Matrix2<f64> {
    Matrix2::new(a[0], a[1], b[0], b[1])
}

#[test]
fn benchmark_matrices_match_every_published_digit() {
    let published = entry("meijaard_matrices");
    let linear = Linear::new(&shipped(published.text("bicycle")).parameters);
    for (key, computed) in [("M", linear.m), ("C1", linear.c1), ("K0", linear.k0), ("K2", linear.k2)] {
        let off = difference(&computed, &matrix(published.matrix(key)));
        println!("{key}: {off:.1e}");
        assert!(off < published.tolerance(), "{key} differs by {off:e}");
    }
}

#[test]
fn benchmark_eigenvalues_match_the_published_table() {
    let table = entry("meijaard_eigenvalues");
    let linear = Linear::new(&shipped(table.text("bicycle")).parameters);
    let rows = table.rows::<3>("eigenvalues");
    let mut worst: f64 = 0.0;
    for [v, re, im] in &rows {
        let values = eigenvalues(&linear, &Law::None, *v);
        let nearest =
            |expected: Complex<f64>| values.iter().map(|e| (e - expected).norm()).fold(9.0, f64::min);
        worst = worst.max(nearest(Complex::new(*re, *im))).max(nearest(Complex::new(*re, -*im)));
    }
    println!("{} eigenvalues, largest difference {worst:.1e}", rows.len());
    assert!(rows.len() == 19 && worst < table.tolerance(), "{worst:e}");
}

#[test]
fn benchmark_state_matrix_matches_sympy_at_any_speed() {
    let published = entry("sympy_benchmark_state_matrix");
    let linear = Linear::new(&shipped(published.text("bicycle")).parameters);
    for v in [0.0, 1.0, 2.5, 5.0] {
        let a = linear.state_matrix(v, 0.0);
        for (row, key) in [(2, "roll"), (3, "steer")] {
            let terms = published.rows::<4>(key);
            for column in 0..4 {
                let expected = terms[0][column] + v * terms[1][column] + v * v * terms[2][column];
                let off = (a[(row, column)] - expected).abs();
                assert!(off < published.tolerance(), "{key} {column} at {v} m/s differs by {off:e}");
            }
        }
    }
}

/// Every shipped bicycle, ridden upright backwards, at rest and forwards: the exact derivatives of
/// the nonlinear accelerations are the canonical matrices.
#[test]
fn nonlinear_equations_linearise_to_the_canonical_matrices() {
    let mut worst = [0.0_f64; 3];
    let bicycles = all_shipped();
    assert!(bicycles.len() >= 20, "only {} bicycles", bicycles.len());
    for bicycle in &bicycles {
        let linear = Linear::new(&bicycle.parameters);
        let b = Geometry::new(&bicycle.parameters);
        for v in [-2.0, 0.0, 0.5, 3.0, 5.0, 10.0] {
            let found = linearise(&b, v);
            let off = [
                difference(&found.m, &linear.m),
                difference(&found.damping, &(linear.c1 * v)),
                difference(&found.stiffness, &(linear.k0 * linear.g + linear.k2 * (v * v))),
            ];
            for (w, o) in worst.iter_mut().zip(off) {
                *w = w.max(o);
            }
            assert!(off.iter().all(|o| *o < 1e-9), "{} at {v} m/s: {off:?}", bicycle.name);
            assert_eq!(found.speed, [0.0; 6], "{} at {v} m/s", bicycle.name);
        }
    }
    println!(
        "{} bicycles: M {:.1e}, v C1 {:.1e}, g K0 + v^2 K2 {:.1e}",
        bicycles.len(),
        worst[0],
        worst[1],
        worst[2]
    );
}
