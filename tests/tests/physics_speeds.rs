//! Critical speeds and matrices: the thesis's bicycle, and every bicycle of the derived table.

use control::Law;
use nalgebra::Matrix2;
use sim_host::bicycle::linear::Linear;
use sim_host::eigen::{CriticalSpeeds, critical_speeds, eigenvalues};
use tests::derived::{self, Derived};
use tests::published::entry;
use tests::rides::shipped;

/// What the derived table is compared to: its own rounding and that of the search.
const DERIVED_TOLERANCE: f64 = 1e-9;

fn matrices(linear: &Linear) -> [(&'static str, Matrix2<f64>); 4] {
    [("M", linear.m), ("C1", linear.c1), ("K0", linear.k0), ("K2", linear.k2)]
}

fn speeds(s: &CriticalSpeeds) -> [Option<f64>; 3] {
    [s.v_d, s.v_w, s.v_c]
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
fn thesis_bicycle_changes_its_nature_at_the_printed_speeds() {
    let printed = entry("thesis_speeds");
    let linear = Linear::new(&shipped(printed.text("bicycle")).parameters);
    let found = critical_speeds(&linear, &Law::None);
    for (key, speed) in ["v_d", "v_w", "v_c"].into_iter().zip(speeds(&found)) {
        let speed = speed.expect(key);
        println!("{key} = {speed:.4} m/s, printed {}", printed.number(key));
        assert!((speed - printed.number(key)).abs() < printed.tolerance(), "{key} = {speed}");
    }
}

#[test]
fn every_derived_bicycle_has_its_matrices_and_critical_speeds() {
    let bicycles = derived::all();
    let mut worst = [0.0_f64; 2];
    for Derived { name, matrices: wanted, speeds: wanted_speeds, .. } in &bicycles {
        let linear = Linear::new(&shipped(name).parameters);
        for ((key, computed), wanted) in matrices(&linear).iter().zip(wanted) {
            let off = (computed - Matrix2::from_row_slice(wanted)).abs().max();
            worst[0] = worst[0].max(off);
            assert!(off < DERIVED_TOLERANCE, "{name} {key} differs by {off:e}");
        }
        let found = speeds(&critical_speeds(&linear, &Law::None));
        for (found, wanted) in found.iter().zip(wanted_speeds) {
            assert_eq!(found.is_some(), wanted.is_some(), "{name}: {found:?} instead of {wanted:?}");
            let off = found.zip(*wanted).map_or(0.0, |(f, w)| (f - w).abs());
            worst[1] = worst[1].max(off);
            assert!(off < DERIVED_TOLERANCE, "{name}: {found:?} instead of {wanted:?}");
        }
    }
    println!("{} bicycles: matrices {:.1e}, speeds {:.1e} m/s", bicycles.len(), worst[0], worst[1]);
    assert!(bicycles.len() >= 18, "only {} bicycles", bicycles.len());
}

#[test]
fn derived_eigenvalues_match_from_rest_to_10_m_s() {
    let mut worst: f64 = 0.0;
    let mut count = 0;
    for Derived { name, eigenvalues: table, .. } in derived::all() {
        let linear = Linear::new(&shipped(&name).parameters);
        for (v, wanted) in table {
            let values = eigenvalues(&linear, &Law::None, v);
            for (re, im) in wanted {
                let off = values.iter().map(|e| (e.re - re).hypot(e.im - im)).fold(9.0, f64::min);
                (worst, count) = (worst.max(off), count + 1);
                assert!(off < DERIVED_TOLERANCE, "{name} at {v} m/s: {re} {im} differs by {off:e}");
            }
        }
    }
    println!("{count} eigenvalues, largest difference {worst:.1e}");
    assert!(count >= 90);
}
