//! Critical speeds and matrices: the thesis bicycle, and every bicycle of the derived table.

use control::Law;
use nalgebra::Matrix2;
use sim_host::bicycle::linear::Linear;
use sim_host::eigen::{critical_speeds, eigenvalues};
use tests::derived::{self, Derived};
use tests::published::entry;
use tests::rides::{all_shipped, shipped};

/// Tolerance of the derived table: its own rounding and that of the search.
const DERIVED_TOLERANCE: f64 = 1e-9;

fn matrices(linear: &Linear) -> [(&'static str, Matrix2<f64>); 4] {
    [("M", linear.m), ("C1", linear.c1), ("K0", linear.k0), ("K2", linear.k2)]
}

#[test]
fn thesis_bicycles_have_the_printed_matrices() {
    for name in ["thesis_matrices", "thesis_matrices_2011"] {
        let printed = entry(name);
        let linear = Linear::new(&shipped(printed.text("bicycle")).parameters);
        for (key, computed) in matrices(&linear) {
            let printed_matrix = printed.matrix(key);
            for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let (value, print) = (computed[(row, column)], printed_matrix[row][column]);
                let off = (value - print).abs();
                assert!(
                    off <= printed.tolerance(),
                    "{name} {key}[{row}][{column}]: {value}, printed {print}"
                );
            }
        }
    }
}

/// 10.1449 is printed 10.14, 5.8267 is printed 5.83, 1.0104 is printed 1.01.
#[test]
fn the_modes_of_the_thesis_bicycle_change_at_the_printed_speeds() {
    let printed = entry("thesis_speeds");
    let linear = Linear::new(&shipped(printed.text("bicycle")).parameters);
    let found = critical_speeds(&linear, &Law::None);
    for (key, speed) in [("v_d", found.v_d), ("v_w", found.v_w), ("v_c", found.v_c)] {
        let speed = speed.expect(key);
        println!("{key} = {speed:.4} m/s, printed {}", printed.number(key));
        assert!((speed - printed.number(key)).abs() < printed.tolerance(), "{key} = {speed}");
    }
}

#[test]
fn every_derived_bicycle_has_its_matrices_and_critical_speeds() {
    let bicycles = derived::all();
    let mut worst = [0.0_f64; 2];
    for d in &bicycles {
        let linear = Linear::new(&shipped(&d.name).parameters);
        for ((key, computed), expected) in matrices(&linear).iter().zip(&d.matrices) {
            let off = (computed - Matrix2::from_row_slice(expected)).abs().max();
            worst[0] = worst[0].max(off);
            assert!(off < DERIVED_TOLERANCE, "{} {key} differs by {off:e}", d.name);
        }
        let found = critical_speeds(&linear, &Law::None);
        assert_eq!(found.v_c.is_some(), d.v_c.is_some(), "{}: {found:?}", d.name);
        let off =
            |found: Option<f64>, expected: Option<f64>| expected.map_or(0.0, |w| (found.unwrap() - w).abs());
        let off = off(found.v_d, d.v_d).max(off(found.v_w, Some(d.v_w))).max(off(found.v_c, d.v_c));
        worst[1] = worst[1].max(off);
        assert!(off < DERIVED_TOLERANCE, "{}: {found:?} instead of {d:?}", d.name);
    }
    println!("{} bicycles: matrices {:.1e}, speeds {:.1e} m/s", bicycles.len(), worst[0], worst[1]);
    assert!(bicycles.len() >= 20, "only {} bicycles", bicycles.len());
}

/// Just below v_d two growing real modes, just above a growing oscillation; that one still grows
/// just below v_w and no longer does just above.
#[test]
fn the_modes_of_shipped_bicycles_change_at_their_critical_speeds() {
    const ASIDE: f64 = 1e-6;
    for bicycle in all_shipped() {
        let linear = Linear::new(&bicycle.parameters);
        let found = critical_speeds(&linear, &Law::None);
        let growing = |v: f64, oscillating: bool| {
            let values = eigenvalues(&linear, &Law::None, v);
            values.iter().filter(|e| e.re > 0.0 && (e.im != 0.0) == oscillating).count()
        };
        let (v_d, v_w) = (found.v_d.unwrap(), found.v_w.unwrap());
        let counts = |v: f64| (growing(v, false), growing(v, true));
        assert_eq!((counts(v_d - ASIDE), counts(v_d + ASIDE)), ((2, 0), (0, 2)), "{} v_d", bicycle.name);
        assert_eq!((counts(v_w - ASIDE).1, counts(v_w + ASIDE).1), (2, 0), "{} v_w", bicycle.name);
        if let Some(v_c) = found.v_c {
            let change = growing(v_c + ASIDE, false) - growing(v_c - ASIDE, false);
            assert_eq!(change, 1, "{} v_c", bicycle.name);
        }
    }
}

#[test]
fn derived_eigenvalues_match_from_rest_to_10_m_s() {
    let mut worst: f64 = 0.0;
    let mut count = 0;
    for Derived { name, eigenvalues: table, .. } in derived::all() {
        let linear = Linear::new(&shipped(&name).parameters);
        for (v, expected) in table {
            let values = eigenvalues(&linear, &Law::None, v);
            for (re, im) in expected {
                let off = values.iter().map(|e| (e.re - re).hypot(e.im - im)).fold(9.0, f64::min);
                (worst, count) = (worst.max(off), count + 1);
                assert!(off < DERIVED_TOLERANCE, "{name} at {v} m/s: {re} {im} differs by {off:e}");
            }
        }
    }
    println!("{count} eigenvalues, largest difference {worst:.1e}");
    assert!(count >= 90);
}
