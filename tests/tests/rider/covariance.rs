//! Covariances of measured gains: their file, draws from them, and tables merged.

use nalgebra::{DMatrix, DVector};
use proptest::collection::vec;
use proptest::prelude::*;
use sim_host::rider::{Covariance, CovarianceError, Gains, MergeError, RiderTable, catalogue, merge};
use std::path::Path;
use tests::draws::runner;

/// Steer rate, roll and lateral offset, listed in the file in another order than in the table.
const COLUMNS: [usize; 3] = [0, 6, 9];

fn parse(text: &str) -> RiderTable {
    RiderTable::from_text("my", text, Path::new("my.toml")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Situation: tables with covariances of any rank, some rows without, columns in the file not in the table's order.
/// Action: parse them, write the result, parse that.
/// Must hold: each covariance belongs to its gains; the same table again, to the bit.
#[test]
fn covariances_round_trip() {
    let factor = vec(-10.0..10.0_f64, 9);
    let row = (factor, 1..4_usize, any::<bool>());
    runner(300)
        .run(&vec(row, 1..6), |rows| {
            let (mut cells, mut covariances, mut expected) = (String::new(), String::new(), vec![]);
            for (n, (factor, rank, known)) in rows.iter().enumerate() {
                cells += &format!("[{}.5, 3, 1, 2],", n + 1);
                let f = DMatrix::from_fn(3, *rank, |i, j| factor[3 * i + j] * 10.0_f64.powi(i as i32));
                // In the order of the file's columns: lateral offset, roll, steer rate.
                let m = &f * f.transpose();
                let lists: Vec<Vec<f64>> =
                    if *known { m.row_iter().map(|r| r.iter().copied().collect()).collect() } else { vec![] };
                covariances += &format!("{lists:?},");
                expected.push(known.then(|| DMatrix::from_fn(3, 3, |i, j| m[([1, 2, 0][i], [1, 2, 0][j])])));
            }
            let columns = "'speed_m_s', 'K_y', 'K_phi_p', 'K_delta_d'";
            let table = parse(&format!(
                "schema = 1\ndelay_ms = 30\ncolumns = [{columns}]\nrows = [{cells}]\ncovariances = [{covariances}]"
            ));
            prop_assert_eq!(&table.columns, &COLUMNS);
            for (row, expected) in table.rows.iter().zip(&expected) {
                let read = row.covariance.as_ref().map(Covariance::matrix);
                prop_assert_eq!(read.is_some(), expected.is_some());
                if let (Some(read), Some(expected)) = (read, expected) {
                    prop_assert!((read - expected).amax() <= 1e-12 * expected.amax());
                    prop_assert_eq!(read, &read.transpose());
                }
            }
            prop_assert_eq!(parse(&table.to_toml()), table);
            Ok(())
        })
        .unwrap();
}

/// Situation: matrices that are no covariance of two gains, and one that is, of rank one.
/// Action: make a covariance of them.
/// Must hold: rejected with the reason; accepted.
#[test]
fn only_covariances_are_accepted() {
    let of = |cells: [f64; 4]| Covariance::new(&DMatrix::from_row_slice(2, 2, &cells), &[0, 6]);
    assert!(of([4.0, -6.0, -6.0, 9.0]).is_ok());
    assert!(matches!(of([4.0, 1.0, 2.0, 9.0]), Err(CovarianceError::Asymmetric { .. })));
    for (cells, named) in [
        ([-4.0, 0.0, 0.0, 9.0], "variance of K_phi_p = -4 is outside 0 to"),
        ([4.0, 0.0, 0.0, f64::NAN], "variance of K_delta_d = NaN"),
        ([4.0, 7.0, 7.0, 9.0], "covariance of K_phi_p and K_delta_d = 7 is outside -6"),
        ([0.0, 1.0, 1.0, 9.0], "covariance of K_phi_p and K_delta_d = 1 is outside"),
    ] {
        let error = of(cells).expect_err(named).to_string();
        assert!(error.contains(named), "{error}");
    }
    // Each pair is possible, the three together are not.
    let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 0.9, -0.9, 0.9, 1.0, 0.9, -0.9, 0.9, 1.0]);
    let error = Covariance::new(&matrix, &COLUMNS).expect_err("not semidefinite").to_string();
    assert!(error.contains("smallest eigenvalue") && error.contains("-0.8"), "{error}");
    let shape = Covariance::new(&matrix, &[0, 6]).expect_err("three for two");
    assert_eq!(shape, CovarianceError::Shape { gains: 2, rows: 3, columns: 3 });
}

/// Situation: a covariance with a gain that is known exactly and a strong correlation.
/// Action: draw with standard normal numbers along each axis.
/// Must hold: the sum of the products of the deviations is the covariance, to rounding; the exact gain stays.
#[test]
fn draws_have_the_covariance() {
    let matrix = DMatrix::from_row_slice(3, 3, &[4.0, -5.9, 0.0, -5.9, 9.0, 0.0, 0.0, 0.0, 0.0]);
    let covariance = Covariance::new(&matrix, &COLUMNS).expect("semidefinite");
    let mean = Gains([7.0; 10]);
    let mut sum = DMatrix::zeros(3, 3);
    for axis in 0..3 {
        let mut normal = DVector::zeros(3);
        normal[axis] = 1.0;
        let drawn = covariance.draw(&mean, &COLUMNS, &normal);
        let deviation = DVector::from_fn(3, |i, _| drawn.0[COLUMNS[i]] - 7.0);
        assert_eq!((drawn.0[9], drawn.0[1]), (7.0, 7.0));
        sum += &deviation * deviation.transpose();
    }
    assert!((sum - matrix).amax() < 1e-13);
    assert_eq!(covariance.standard_errors(), [2.0, 3.0, 0.0]);
}

/// Situation: the young rider's fifteen sets as tables of one row, in reverse order; then tables that differ.
/// Action: merge them.
/// Must hold: the young rider's rows and groups again; a difference is named with both values.
#[test]
fn tables_of_one_row_merge_into_one() {
    let young = catalogue::load("young").expect("shipped");
    let single = |i: usize| RiderTable {
        name: format!("run{i}"),
        rows: vec![young.rows[i].clone()],
        best_runs: None,
        ..young.clone()
    };
    let all: Vec<RiderTable> = (0..15).rev().map(single).collect();
    let merged = merge("all", &all, 0.3).expect("of one kind");
    let keys = |t: &RiderTable| {
        let mut keys: Vec<_> = t.rows.iter().map(|r| (r.group, r.run, r.gains.0.map(f64::to_bits))).collect();
        keys.sort_unstable();
        keys
    };
    assert_eq!(keys(&merged), keys(&young));
    assert_eq!(merged.regression, None);
    assert_eq!(merge("all", &all, 0.05).expect("of one kind").groups().count(), 9);
    assert_eq!(parse(&merged.to_toml()).rows, merged.rows);

    assert_eq!(merge("all", &[], 0.3), Err(MergeError::None));
    let smart = catalogue::load("smart").expect("shipped");
    let late = RiderTable { name: "late".into(), delay_s: 0.06, ..young.clone() };
    for (other, named) in [(&smart, ["gains", "K_phi_dd"]), (&late, ["delay", "30 ms and 60 ms"])] {
        let error = merge("all", &[young.clone(), other.clone()], 0.3).expect_err("differ").to_string();
        assert!(named.iter().all(|n| error.contains(n)) && error.contains(&other.name), "{error}");
    }
    let error = merge("all", &all, 0.0).expect_err("no tolerance").to_string();
    assert!(error.contains("tolerance (m/s) = 0 is outside"), "{error}");
}
