//! Riders drawn from covariances of gains, or from the sets of each group.

use nalgebra::{DMatrix, DVector};
use sim_host::eigen::{Feedback, Model, unstable};
use sim_host::rider::{Covariance, Drawing, Fit, Outside, RiderTable, Row, catalogue};
use tests::rides::shipped;

/// The young rider with a covariance of every set: errors of 5 % of each gain, half correlated.
fn identified() -> RiderTable {
    let table = catalogue::load("young").expect("shipped");
    let with = |row: Row| {
        let errors = DVector::from_iterator(5, table.columns.iter().map(|&i| 0.05 * row.gains.0[i].abs()));
        let matrix = DMatrix::from_fn(5, 5, |i, j| errors[i] * errors[j] * if i == j { 1.0 } else { 0.5 });
        Row { covariance: Some(Covariance::new(&matrix, &table.columns).expect("definite")), ..row }
    };
    RiderTable { rows: table.rows.iter().cloned().map(with).collect(), ..table.clone() }
}

/// Situation: the young rider with covariances.
/// Action: draw 4000 tables.
/// Must hold: mean and covariance of a set are those given, within four standard errors of 4000 draws; two sets are
/// independent; the same number of a draw gives the same table.
#[test]
fn posterior_draws_have_the_covariance_of_each_row() {
    const N: u64 = 4000;
    let table = identified();
    assert_eq!(table.drawing(), Ok(Drawing::Posterior));
    let drawn: Vec<RiderTable> = (0..N).map(|i| table.drawn(Drawing::Posterior, 7, i)).collect();
    let gains = |t: &RiderTable, row: usize| {
        DVector::from_iterator(5, table.columns.iter().map(|&i| t.rows[row].gains.0[i]))
    };
    let (a, b) = (gains(&table, 3), gains(&table, 9));
    let (mut mean, mut own, mut cross) = (DVector::zeros(5), DMatrix::zeros(5, 5), DMatrix::zeros(5, 5));
    for t in &drawn {
        let (da, db) = (gains(t, 3) - &a, gains(t, 9) - &b);
        mean += &da / N as f64;
        own += &da * da.transpose() / N as f64;
        cross += &da * db.transpose() / N as f64;
    }
    let given = table.rows[3].covariance.as_ref().expect("given");
    let (errors, others) =
        (given.standard_errors(), table.rows[9].covariance.as_ref().expect("given").standard_errors());
    let of_mean = 4.0 / (N as f64).sqrt();
    for i in 0..5 {
        assert!(mean[i].abs() < of_mean * errors[i], "{i}: {}", mean[i] / errors[i]);
        for j in 0..5 {
            let off = (own[(i, j)] - given.matrix()[(i, j)]) / (errors[i] * errors[j]);
            assert!(off.abs() < 1.5 * of_mean, "{i} {j}: {off}");
            let off = cross[(i, j)] / (errors[i] * others[j]);
            assert!(off.abs() < of_mean, "{i} {j}: {off}");
        }
    }
    assert_eq!(table.drawn(Drawing::Posterior, 7, 5), drawn[5]);
    assert_ne!(table.drawn(Drawing::Posterior, 8, 5), drawn[5]);
    assert_ne!(drawn[4], drawn[5]);
    assert!(drawn.iter().all(|t| t.regression.is_none() && t.columns == table.columns));
}

/// Situation: the young rider, without covariances.
/// Action: draw 300 tables.
/// Must hold: groups of three sets of their own group, each set about once on average; schedules of every kind.
#[test]
fn bootstrap_draws_sets_of_their_group() {
    let table = catalogue::load("young").expect("shipped");
    assert_eq!(table.drawing(), Ok(Drawing::Bootstrap));
    let mut counts = vec![0; table.rows.len()];
    for i in 0..300 {
        let drawn = table.drawn(Drawing::Bootstrap, 7, i);
        assert_eq!(drawn.groups().map(<[Row]>::len).collect::<Vec<_>>(), [3; 5]);
        for row in &drawn.rows {
            let at = table.rows.iter().position(|own| own == row).expect("a row of the table, in its group");
            counts[at] += 1;
        }
        for fit in Fit::ALL {
            assert!(drawn.schedule(fit, Outside::Extrapolate).is_ok(), "{i} {}", fit.name());
        }
    }
    // Binomial, 900 draws of a third: 300 and a deviation of 14.
    assert!(counts.iter().all(|n| (240..360).contains(n)), "{counts:?}");
}

/// Situation: a table with one covariance missing and all sets in groups, and with a set alone in its group.
/// Action: ask what can be drawn.
/// Must hold: the sets; nothing, with the row named.
#[test]
fn a_row_without_covariance_needs_a_group() {
    let mut table = identified();
    table.rows[4].covariance = None;
    assert_eq!(table.drawing(), Ok(Drawing::Bootstrap));
    table.rows.truncate(13);
    let error = table.drawing().expect_err("run 255 is alone").to_string();
    for named in ["`young`", "row 5", "3.2 m/s", "7.3 m/s", "covariances"] {
        assert!(error.contains(named), "{error}");
    }
}

/// Situation: the undelayed and the naive old rider, at speeds where the eigenvalues say stable and unstable.
/// Action: count the unstable ones.
/// Must hold: the number of models whose rightmost root grows.
#[test]
fn unstable_riders_are_counted() {
    let bicycle = shipped("rigid_jason").parameters;
    let model = |delay_s| {
        let table = catalogue::load("young").expect("shipped");
        let rider = table.rider(Fit::Mean, Outside::Extrapolate, Some(delay_s)).expect("a schedule");
        Model::new(&bicycle, Feedback::new(control::Law::None, Default::default()), Some(rider))
    };
    let models = [model(0.03), model(0.5)];
    assert_eq!(unstable(&models, &[4.0, 6.0]), [1, 1]);
    assert_eq!(unstable(&models[..1], &[4.0, 6.0]), [0, 0]);
}
