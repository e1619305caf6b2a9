//! Smoothing splines of gains over speed.

use nalgebra::{DMatrix, DVector};
use sim_host::num::RandomStream;
use sim_host::rider::{Fit, Outside, Point, Schedule, Spline, Variances, catalogue, mean};

/// Values about a wave of one period over 0 to 10, three near each of `places` places, with errors of standard
/// deviation `error`, from the given seed.
fn measured(seed: u64, places: usize, error: f64) -> Vec<Point> {
    let mut random = RandomStream::new(seed, [0.0; 3], 0);
    let at = |i: usize| 10.0 * (i / 3) as f64 / (places - 1) as f64 + 0.1 * (i % 3) as f64;
    let value = |x: f64| 3.0 * (0.628 * x).sin() + x;
    let mut point = |x: f64| Point { x, value: value(x) + error * random.normal(), variance: 1.0 };
    (0..3 * places).map(|i| point(at(i))).collect()
}

/// A smoothing spline as Reinsch and Green & Silverman (1994, section 2.3.3) compute it, at the distinct places of
/// single points: `(W + lambda Q R^-1 Q^T)^-1 W y`.
fn reinsch(points: &[Point], lambda: f64) -> (DVector<f64>, DMatrix<f64>) {
    let n = points.len();
    let h = |i: usize| points[i + 1].x - points[i].x;
    let q = DMatrix::from_fn(n, n - 2, |i, j| match i as i64 - j as i64 {
        0 => 1.0 / h(j),
        1 => -1.0 / h(j) - 1.0 / h(j + 1),
        2 => 1.0 / h(j + 1),
        _ => 0.0,
    });
    let r = DMatrix::from_fn(n - 2, n - 2, |i, j| match i.abs_diff(j) {
        0 => (h(i) + h(i + 1)) / 3.0,
        1 => h(i.max(j)) / 6.0,
        _ => 0.0,
    });
    let penalty = &q * r.try_inverse().expect("diagonally dominant") * q.transpose();
    let weights = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| 1.0 / points[i].variance));
    let smoother = (&weights + lambda * penalty).try_inverse().expect("positive definite");
    let values = DVector::from_fn(n, |i, _| points[i].value);
    (&smoother * weights * values, smoother)
}

/// Restricted likelihood of `lambda`, times -2: the textbook's determinants instead of a spectrum.
fn cost(points: &[Point], lambda: f64) -> (f64, f64) {
    let n = points.len();
    let first = points[0].x;
    let at = |i: usize| points[i].x - first;
    let covariance = DMatrix::from_fn(n, n, |i, j| {
        let (low, high) = (at(i).min(at(j)), at(i).max(at(j)));
        let process = low * low * (3.0 * high - low) / 6.0 / lambda;
        process + if i == j { points[i].variance } else { 0.0 }
    });
    let basis = DMatrix::from_fn(n, 2, |i, j| at(i).powi(j as i32));
    let y = DVector::from_fn(n, |i, _| points[i].value);
    let inverse = covariance.clone().try_inverse().expect("positive definite");
    let information = basis.transpose() * &inverse * &basis;
    let line = information.clone().try_inverse().expect("two places") * basis.transpose() * &inverse * &y;
    let rest = &y - &basis * line;
    let quadratic = rest.dot(&(&inverse * &rest));
    let free = (n - 2) as f64;
    (free * quadratic.ln() + covariance.determinant().ln() + information.determinant().ln(), quadratic / free)
}

/// Situation: a noisy wave, equal and unequal variances.
/// Action: compute the spline, and by the textbook's formulas the penalised fit with the likeliest penalty of a grid.
/// Must hold: the same values, standard errors and degrees of freedom, to the resolution of the grid.
#[test]
fn the_spline_is_the_textbooks_smoothing_spline() {
    for (seed, slope) in [(1, 0.0), (2, 0.0), (3, 0.3)] {
        let vary = |p: Point| Point { variance: 1.0 + slope * p.x, ..p };
        let points: Vec<Point> = measured(seed, 8, 0.8).into_iter().map(vary).collect();
        let spline = Spline::new(&points, Variances::Relative);
        let (mut best, mut at) = ((f64::INFINITY, 0.0), 0.0);
        for step in [0.1, 1e-3] {
            let middle: f64 = at;
            for i in -100..=100 {
                let log = middle + step * f64::from(i);
                let found = cost(&points, 10.0_f64.powf(log));
                if found.0 < best.0 {
                    (best, at) = (found, log);
                }
            }
        }
        let (values, smoother) = reinsch(&points, 10.0_f64.powf(at));
        for (i, p) in points.iter().enumerate() {
            let error = (best.1 * smoother[(i, i)]).sqrt();
            let (value, own) = (spline.at(p.x), spline.standard_error(p.x).expect("degrees of freedom"));
            assert!((value - values[i]).abs() < 1e-3 * error, "{seed} {}: {value} {}", p.x, values[i]);
            assert!((own / error - 1.0).abs() < 1e-3, "{seed} {}: {own} {error}", p.x);
        }
        let trace: f64 = (0..points.len()).map(|i| smoother[(i, i)] / points[i].variance).sum();
        assert!((spline.degrees_of_freedom - trace).abs() < 2e-3, "{} {trace}", spline.degrees_of_freedom);
        assert!((3.5..12.0).contains(&trace), "{trace}");
    }
}

/// Situation: the same wave with 200 seeds.
/// Action: count the places at which the wave is within two standard errors.
/// Must hold: 90 to 98 % of them; between the measured places too.
#[test]
fn standard_errors_cover_the_truth() {
    let (mut inside, mut all) = (0.0, 0.0);
    for seed in 0..200 {
        let spline = Spline::new(&measured(seed, 8, 0.8), Variances::Relative);
        for i in 0..=40 {
            let x = 0.25 * f64::from(i);
            let error = spline.standard_error(x).expect("degrees of freedom");
            let off = (spline.at(x) - 3.0 * (0.628 * x).sin() - x).abs();
            inside += f64::from(u8::from(off < 2.0 * error));
            all += 1.0;
        }
    }
    println!("{:.3} within two standard errors", inside / all);
    assert!((0.90..0.98).contains(&(inside / all)), "{}", inside / all);
}

/// Situation: sets at one speed, at two, at three with one each, and on a line.
/// Action: compute the spline.
/// Must hold: the weighted mean with its error; the line of weighted least squares; no error without degrees of
/// freedom; beyond the ends a straight line.
#[test]
fn few_speeds_give_a_constant_or_a_line() {
    let points = |list: &[(f64, f64, f64)]| -> Vec<Point> {
        list.iter().map(|&(x, value, variance)| Point { x, value, variance }).collect()
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
    let one = points(&[(4.0, 1.0, 1.0), (4.0, 5.0, 3.0)]);
    let constant = Spline::new(&one, Variances::Relative);
    assert_eq!((constant.at(4.0), constant.at(9.0), constant.degrees_of_freedom), (2.0, 2.0, 1.0));
    // Sum of squares 1 + 9/3 with one degree of freedom, weight 4/3.
    near(constant.standard_error(4.0).expect("one degree"), 3.0_f64.sqrt());
    // Known variances: 3/4 of the scale 4; a smaller scatter than known counts as chance.
    let close = points(&[(4.0, 1.0, 1.0), (4.0, 1.1, 3.0)]);
    near(Spline::new(&close, Variances::Known).standard_error(4.0).expect("known"), 0.75_f64.sqrt());
    near(Spline::new(&one[..1], Variances::Known).standard_error(4.0).expect("known"), 1.0);
    assert_eq!(Spline::new(&one[..1], Variances::Relative).standard_error(4.0), None);

    let line = Spline::new(&points(&[(2.0, 1.0, 1.0), (4.0, 5.0, 3.0)]), Variances::Relative);
    for (x, y) in [(2.0, 1.0), (3.0, 3.0), (4.0, 5.0), (0.0, -3.0), (7.0, 11.0)] {
        near(line.at(x), y);
    }
    assert_eq!((line.standard_error(3.0), line.degrees_of_freedom), (None, 2.0));
    let three =
        Spline::new(&points(&[(2.0, 1.0, 1.0), (3.0, 9.0, 1.0), (4.0, 5.0, 1.0)]), Variances::Relative);
    near(three.at(3.0), 5.0);
    near(three.at(5.0), 9.0);
    let straight: Vec<Point> =
        (0..9).map(|i| Point { x: f64::from(i), value: 0.1 * f64::from(i), variance: 1.0 }).collect();
    near(Spline::new(&straight, Variances::Relative).degrees_of_freedom, 2.0);

    let curve = Spline::new(&measured(1, 8, 0.8), Variances::Relative);
    for (from, step) in [(0.0, -1.0), (10.2, 1.0)] {
        let (a, b, c) = (curve.at(from), curve.at(from + step), curve.at(from + 3.0 * step));
        near(c - a, 3.0 * (b - a));
    }
}

/// Situation: the slowest and the fastest group of the young rider, whose sets differ by 0.1 m/s and by much of a gain.
/// Action: schedule it by splines.
/// Must hold: lines, from the mean of one group to near that of the other: no curve from slopes inside the groups.
#[test]
fn speeds_inside_a_group_make_no_slope() {
    let mut table = catalogue::load("young").expect("shipped");
    let [slowest, fastest] = [&table.rows[0], &table.rows[table.rows.len() - 1]].map(|row| row.group);
    table.rows.retain(|row| [slowest, fastest].contains(&row.group));
    assert!(table.splines().iter().all(|spline| (spline.degrees_of_freedom - 2.0).abs() < 1e-6));
    let schedule = table.schedule(Fit::Spline, Outside::Hold).expect("two groups");
    let means: Vec<_> = table.groups().map(mean).collect();
    for (speed, gains) in means {
        for &i in &table.columns {
            assert!((schedule.at(speed).0[i] - gains.0[i]).abs() < 1e-6 * gains.0[i].abs(), "{speed} {i}");
        }
    }
}

/// Situation: the published riders' gains.
/// Action: schedule them by splines.
/// Must hold: sampled to 0.1 % of each gain's range; explained variance no less than that of a line less 0.05,
/// as weights differ, and no more than that of one mean per speed.
#[test]
fn splines_of_the_published_riders() {
    for name in ["young", "smart", "smart6", "undelayed", "undelayed-alt", "hess", "hess-benchmark"] {
        let table = catalogue::load(name).expect("shipped");
        let of = |fit| table.schedule(fit, Outside::Extrapolate).expect("every fit is possible");
        let (line, spline) = (of(Fit::Regression), of(Fit::Spline));
        let splines = table.splines();
        let r = |schedule: &Schedule| table.r_squared(schedule);
        for (&i, exact) in table.columns.iter().zip(&splines) {
            let gains = || table.rows.iter().map(|row| row.gains.0[i]);
            let range = gains().fold(f64::MIN, f64::max) - gains().fold(f64::MAX, f64::min);
            let points = spline.points();
            let (first, last) = (points[0].0, points[points.len() - 1].0);
            let at = |k: u32| first + (last - first) * f64::from(k) / 999.0;
            let off = (0..1000).map(|k| (spline.at(at(k)).0[i] - exact.at(at(k))).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-3 * range, "{name} {i}: {off} of {range}");
            let (line, spline) = (r(&line)[i].expect("differ"), r(&spline)[i].expect("differ"));
            println!(
                "{name} {i}: line {line:.3} spline {spline:.3} dof {:.2} {off:.2e}",
                exact.degrees_of_freedom
            );
            assert!(spline > line - 0.05 && spline <= 1.0 + 1e-9, "{name} {i}: {line} {spline}");
        }
    }
}
