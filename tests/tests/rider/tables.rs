//! The shipped riders: the published regressions and R^2, and the properties of every table.

use nalgebra::{DMatrix, SMatrix};
use proptest::collection::vec;
use proptest::prelude::*;
use sim_host::bicycle::linear::Linear;
use sim_host::rider::{Fit, Gains, KEYS, Neuromuscular, Outside, RiderTable, catalogue};
use std::path::Path;
use tests::cli::repository;
use tests::draws::runner;
use tests::published::{Published, entry};
use tests::rides::shipped;

fn rider(name: &str) -> RiderTable {
    catalogue::load(name).unwrap_or_else(|e| panic!("{e}"))
}

fn place(key: &str) -> usize {
    KEYS.iter().position(|k| *k == key).expect("a gain")
}

/// The values listed as missed: `[column, printed, computed]`.
fn missed(published: &Published, key: &str) -> Vec<[f64; 3]> {
    let key = format!("missed_{key}");
    if published.has(&key) { published.rows(&key) } else { vec![] }
}

/// Situation: the published regression and R^2 of each delayed rider.
/// Action: compute them from the rows.
/// Must hold: every printed value, except those listed as missed, which have the listed values and differ from the
/// printed ones by more than the tolerance.
#[test]
fn regressions_and_r_squared_are_the_published_ones() {
    for (name, gains) in [("young_fits", 5), ("smart_fits", 7), ("smart6_fits", 6)] {
        let published = entry(name);
        let table = rider(published.text("rider"));
        assert_eq!(table.columns.len(), gains, "{name}");
        // The regression of the rows, whatever regression the file contains.
        let table = RiderTable { regression: None, ..table };
        let line = table.least_squares();
        let r_squared = Fit::THESIS.map(|fit| {
            table.r_squared(&table.schedule(fit, Outside::Extrapolate).expect("every fit is possible"))
        });
        for key in table.columns.iter().map(|&i| KEYS[i]) {
            let [slope, slope_unit, intercept, intercept_unit, r_lr, r_mean, r_best] = published.row(key);
            let i = place(key);
            let r = r_squared.map(|r| r[i].expect("gains differ"));
            let cells = [
                (slope, line.slope.0[i], slope_unit),
                (intercept, line.intercept.0[i], intercept_unit),
                (r_lr, r[0], published.tolerance()),
                (r_mean, r[1], published.tolerance()),
                (r_best, r[2], published.tolerance()),
            ];
            let missed = missed(&published, key);
            for (column, (printed, computed, tolerance)) in cells.into_iter().enumerate() {
                let off = (printed - computed).abs();
                match missed.iter().find(|m| m[0] == column as f64) {
                    None => assert!(off <= tolerance, "{name} {key} {column}: {printed} {computed}"),
                    Some([_, output, found]) => {
                        assert_eq!(*output, printed, "{name} {key} {column}");
                        assert!(off > tolerance, "{name} {key} {column} is not missed: {computed}");
                        let near = (computed - found).abs() <= 1e-3 * found.abs().max(0.1);
                        assert!(near, "{name} {key} {column}: {computed} is not {found}");
                    }
                }
            }
        }
    }
}

/// Situation: the files with the published regression.
/// Action: compare it with the published lines and with least squares.
/// Must hold: it is as printed, except for the one typing error; `regression` selects it; and least squares over the
/// rows are close, but not the same.
#[test]
fn regressions_are_the_printed_ones() {
    for name in ["young_fits", "smart_fits", "smart6_fits"] {
        let published = entry(name);
        let table = rider(published.text("rider"));
        let line = table.regression.expect("the file carries it");
        let schedule = table.schedule(Fit::Regression, Outside::Extrapolate).expect("two points");
        for &i in &table.columns {
            let [slope, _, intercept, ..] = published.row::<7>(KEYS[i]);
            let typo = (name, KEYS[i]) == ("smart6_fits", "K_delta_d");
            let expected = if typo { 10.0 * intercept } else { intercept };
            assert!((line.slope.0[i], line.intercept.0[i]) == (slope, expected), "{name} {}", KEYS[i]);
            let at_5 = schedule.at(5.0).0[i];
            assert!((at_5 - (5.0 * slope + expected)).abs() < 1e-9, "{name} {}: {at_5}", KEYS[i]);
        }
        assert_ne!(line, table.least_squares());
    }
}

/// Situation: eq. J.5, the rider without delay.
/// Action: compute the regression.
/// Must hold: to one unit of the last digit.
#[test]
fn the_undelayed_regression_is_the_published_one() {
    let published = entry("undelayed_line");
    let table = rider(published.text("rider"));
    assert_eq!(table.columns.len(), 4);
    for key in table.columns.iter().map(|&i| KEYS[i]) {
        let [slope, slope_unit, intercept, intercept_unit] = published.row(key);
        let line = table.least_squares();
        assert!((line.slope.0[place(key)] - slope).abs() <= slope_unit, "{key}");
        assert!((line.intercept.0[place(key)] - intercept).abs() <= intercept_unit, "{key}");
    }
}

/// Situation: Table K.1, the smart rider's gains at 4.3 m/s by two schedules.
/// Action: evaluate the schedules.
/// Must hold: to the printed digits.
#[test]
fn the_smart_riders_gains_at_4_3_are_the_published_ones() {
    let published = entry("smart_rider_at_4_3");
    let table = rider(published.text("rider"));
    let table = RiderTable { regression: None, ..table };
    for fit in [Fit::Mean, Fit::Regression] {
        let at = table.schedule(fit, Outside::Extrapolate).unwrap().at(4.3);
        for (&i, printed) in table.columns.iter().zip(published.row::<7>(fit.name())) {
            assert!(
                (at.0[i] - printed).abs() <= published.number("gains_tolerance"),
                "{} {}: {}",
                fit.name(),
                KEYS[i],
                at.0[i]
            );
        }
    }
}

/// Situation: eq. 2.21 as it is printed.
/// Action: compute it for the regression of the young rider.
/// Must hold: it is far from Table F.1, so the other form is the right one.
#[test]
fn r_squared_as_printed_does_not_give_the_published_values() {
    let (published, table) = (entry("young_fits"), rider("young"));
    let schedule = table.schedule(Fit::Regression, Outside::Extrapolate).unwrap();
    for key in table.columns.iter().map(|&i| KEYS[i]) {
        let i = place(key);
        let mean = table.rows.iter().map(|r| r.gains.0[i]).sum::<f64>() / 15.0;
        let sum = |f: &dyn Fn(&sim_host::rider::Row) -> f64| -> f64 {
            table.rows.iter().map(|r| (f(r) - mean).powi(2)).sum()
        };
        let as_printed = 1.0 - sum(&|r| r.gains.0[i]) / sum(&|r| schedule.at(r.speed_m_s).0[i]);
        let [.., r_lr, _, _] = published.row::<7>(key);
        assert!(as_printed < -0.1 && r_lr > 0.0, "{key}: {as_printed}");
    }
}

/// Situation: every shipped rider and the example.
/// Action: load it, count its sets.
/// Must hold: the number of sets of its table, and the sum of its gains as added up from the text; every possible
/// gain schedule is there; gains without a column are zero.
#[test]
fn every_shipped_table_loads_completely() {
    for (name, rows, delay_ms, sum) in [
        ("young", 15, 30.0, 7203.746),
        ("smart", 11, 60.0, 630.408),
        ("smart6", 12, 60.0, 1558.747),
        ("undelayed", 15, 0.0, 4430.236),
        ("undelayed-alt", 15, 0.0, 558.24),
        ("hess", 15, 0.0, -256.279504118296),
        ("hess-benchmark", 8, 0.0, -81.31197732016098),
        ("young-reduction", 41, 30.0, 12747.918),
        ("smart-reduction", 31, 60.0, 3052.332),
        ("undelayed-reduction", 32, 0.0, 7689.29),
    ] {
        let table = rider(name);
        assert_eq!((table.rows.len(), (table.delay_s * 1e3).round()), (rows, delay_ms), "{name}");
        let total: f64 = table.rows.iter().flat_map(|r| r.gains.0).sum();
        assert!((total - sum).abs() < 1e-6, "{name}: {total}");
        for i in (0..KEYS.len()).filter(|i| !table.columns.contains(i)) {
            assert!(table.rows.iter().all(|r| r.gains.0[i] == 0.0), "{name} {}", KEYS[i]);
        }
        for fit in Fit::ALL {
            assert!(table.rider(fit, Outside::Hold, None).is_ok(), "{name} {}", fit.name());
        }
        let shoulders = !name.starts_with("hess");
        assert_eq!(table.neuromuscular == Neuromuscular::SHOULDERS, shoulders, "{name}");
    }
    assert_eq!(catalogue::shipped_names().count(), 10);
    let example = repository("data/riders/example.toml");
    let table = rider(example.to_str().unwrap());
    assert_eq!((table.rows.len(), table.groups().count()), (10, 5));
}

/// Situation: the shipped riders. Action: look for each in its folder, in docs/riders.md and in the README.
/// Must hold: a file for each, and for no other but the example; a row for each; the README's number.
#[test]
fn every_shipped_rider_is_documented() {
    let text = |path: &str| std::fs::read_to_string(repository(path)).unwrap();
    let mut files: Vec<String> = std::fs::read_dir(repository("data/riders"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "example.toml")
        .collect();
    let mut shipped: Vec<String> = catalogue::shipped_names().map(|name| format!("{name}.toml")).collect();
    files.sort();
    shipped.sort();
    assert_eq!(files, shipped);
    let page = text("docs/riders.md");
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
    for name in catalogue::shipped_names() {
        let named =
            |row: &&str| row.split(" | ").next().is_some_and(|cell| cell.contains(&format!("`{name}`")));
        assert!(rows.iter().any(named), "docs/riders.md has no row for {name}");
    }
    assert!(text("README.md").contains(&format!("{} tables of rider gains", shipped.len())));
}

/// The state matrix of roll, steer, their rates, heading, lateral offset of the front contact, torque
/// and its rate: the linear bicycle at `v` under gains of these, without delay.
fn closed_loop(bicycle: &str, v: f64, gains: &Gains, neuromuscular: &Neuromuscular) -> SMatrix<f64, 8, 8> {
    let p = shipped(bicycle).parameters;
    let linear = Linear::new(&p);
    let free = linear.state_matrix(v, 0.0);
    let m = linear.m.try_inverse().expect("masses");
    let mut a = SMatrix::<f64, 8, 8>::zeros();
    a.fixed_view_mut::<4, 4>(0, 0).copy_from(&free);
    (a[(2, 6)], a[(3, 6)]) = (m[(0, 1)], m[(1, 1)]);
    // Heading rate (v steer + c steer rate) cos(lam) / w; the front contact is w ahead and moves back by its trail.
    let cos = p.lam.cos();
    (a[(4, 1)], a[(4, 3)]) = (v * cos / p.w, p.c * cos / p.w);
    (a[(5, 4)], a[(5, 1)], a[(5, 3)]) = (v, v * cos, 0.0);
    a[(6, 7)] = 1.0;
    let omega2 = neuromuscular.omega_rad_s.powi(2);
    let signals =
        [("K_phi_p", 0), ("K_delta_p", 1), ("K_phi_d", 2), ("K_delta_d", 3), ("K_psi", 4), ("K_y", 5)];
    for (key, state) in signals {
        a[(7, state)] = omega2 * gains.get(key).expect("a gain");
    }
    a[(7, 6)] = -omega2;
    a[(7, 7)] = -2.0 * neuromuscular.zeta * neuromuscular.omega_rad_s;
    a
}

/// Situation: the riders of nested loops on their own bicycles and at their own speeds; and with one sign wrong.
/// Action: close the loop on the linear bicycle, heading and lateral offset included.
/// Must hold: all eigenvalues decay, the slowest within bounds; with a wrong sign some grow.
#[test]
fn nested_gains_multiplied_out_stabilise_their_bicycle() {
    for (name, bicycle) in [("hess", "rigid_jason"), ("hess-benchmark", "benchmark")] {
        let table = rider(name);
        for row in &table.rows {
            let growth = |gains: &Gains| {
                let a = closed_loop(bicycle, row.speed_m_s, gains, &table.neuromuscular);
                let values = DMatrix::from_column_slice(8, 8, a.as_slice()).complex_eigenvalues();
                values.iter().map(|e| e.re).fold(f64::NEG_INFINITY, f64::max)
            };
            let slowest = growth(&row.gains);
            assert!((-1.0..-0.1).contains(&slowest), "{name} {}: {slowest}", row.speed_m_s);
            for i in [0, 2, 8, 9] {
                let mut wrong = row.gains;
                wrong.0[i] = -wrong.0[i];
                let grows = growth(&wrong) > 0.0;
                // The roll rate's gain is small: it costs damping only.
                assert!(grows || i == 2, "{name} {} {}", row.speed_m_s, KEYS[i]);
            }
        }
    }
}

/// Situation: the first set of the nested gains, by hand: 20.1532, -0.0346, 62.0767, 0.0491, 0.2143.
/// Action: multiply out.
/// Must hold: the products.
#[test]
fn nested_gains_are_products() {
    let gains = rider("hess").rows[0].gains;
    for (key, expected) in [
        ("K_delta_p", -20.1532),
        ("K_phi_d", 20.1532 * 0.0346),
        ("K_phi_p", 20.1532 * 0.0346 * 62.0767),
        ("K_psi", 20.1532 * 0.0346 * 62.0767 * 0.0491),
        ("K_y", 20.1532 * 0.0346 * 62.0767 * 0.0491 * 0.2143),
        ("K_delta_d", 0.0),
    ] {
        assert!((gains.get(key).unwrap() - expected).abs() < 1e-12, "{key}");
    }
}

/// Situation: any text, and the example with characters changed.
/// Action: parse it as a rider.
/// Must hold: no panic; a reason names the file.
#[test]
fn no_text_makes_the_parser_panic() {
    let example: Vec<char> =
        std::fs::read_to_string(repository("data/riders/example.toml")).unwrap().chars().collect();
    // From the first key on, so that changes are seldom in a comment.
    let body = example.iter().collect::<String>().find("delay_ms = ").unwrap();
    let places = vec(
        (
            body..example.len(),
            prop_oneof![any::<char>(), "[-0-9.,\\[\\]ne]".prop_map(|s| s.chars().next().unwrap())],
        ),
        0..5,
    );
    runner(3000)
        .run(&(places, any::<String>()), |(places, noise)| {
            let mut changed = example.clone();
            for (at, c) in places {
                changed[at] = c;
            }
            for text in [changed.into_iter().collect::<String>(), noise] {
                match RiderTable::from_text("my", &text, Path::new("my.toml")) {
                    Ok(table) => prop_assert!(table.schedule(Fit::Mean, Outside::Hold).is_ok()),
                    Err(e) => prop_assert!(e.to_string().contains("my.toml"), "{e}"),
                }
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: tables of any sets at rising speeds.
/// Action: parse them, write the result, parse that.
/// Must hold: the given numbers; the same table again; means within the sets.
#[test]
fn a_valid_table_is_read_as_given_and_round_trips() {
    let row = (0.001..3.0_f64, -1e5..1e5_f64, -20.0..20.0_f64, 0.0..100.0_f64);
    runner(500)
        .run(&(vec(row, 1..9), 0..1000_u32, any::<bool>()), |(steps, delay_ms, vaf)| {
            let (mut speed, mut rows, mut given) = (0.0, String::new(), vec![]);
            for (step, a, b, v) in steps {
                speed += step;
                given.push((speed, a, b, v));
                rows += &if vaf {
                    format!("[{b:?}, {speed:?}, {v:?}, {a:?}],")
                } else {
                    format!("[{b:?}, {speed:?}, {a:?}],")
                };
            }
            let columns =
                if vaf { "'K_y', 'speed_m_s', 'vaf', 'K_phi_i'" } else { "'K_y', 'speed_m_s', 'K_phi_i'" };
            let text = format!(
                "schema = 1\nnote = 'a \"b\"'\ndelay_ms = {delay_ms}\ncolumns = [{columns}]\nrows = [{rows}]"
            );
            let parse = |text: &str| RiderTable::from_text("my", text, Path::new("my.toml"));
            let table = parse(&text).unwrap_or_else(|e| panic!("{e}"));
            prop_assert_eq!(table.rows.len(), given.len());
            for (row, (speed, a, b, v)) in table.rows.iter().zip(&given) {
                prop_assert_eq!((row.speed_m_s, row.gains.0[1], row.gains.0[9]), (*speed, *a, *b));
                prop_assert_eq!(row.vaf, vaf.then_some(*v));
            }
            prop_assert!((table.delay_s * 1e3 - f64::from(delay_ms)).abs() < 1e-9);
            let mut again = parse(&table.to_toml()).unwrap_or_else(|e| panic!("{e}\n{}", table.to_toml()));
            prop_assert!((again.delay_s - table.delay_s).abs() < 1e-12);
            again.delay_s = table.delay_s;
            prop_assert_eq!(again, table.clone());
            let line = table.least_squares();
            let residual: f64 = table
                .rows
                .iter()
                .map(|r| r.gains.0[1] - line.slope.0[1] * r.speed_m_s - line.intercept.0[1])
                .sum();
            prop_assert!(residual.abs() < 1e-6, "{residual}");
            Ok(())
        })
        .unwrap();
}

/// Situation: the reductions of one run per speed (Tables F.3, J.1) and the sets of all runs (F.2, J.2, J.3).
/// Action: find the smallest sets that describe each run, and the sets that two tables have in common.
/// Must hold: what sections F.1.1 and J.1 say of them: three and two gains suffice for runs 248 and 249, the five of
/// F.1 for half of the runs; nearly all sets of J.2 describe their run, and few of the alternative; where F.3 or J.1 has
/// a set of F.2, J.2 or eq. J.3 it is the same.
#[test]
fn reductions_end_as_the_text_says() {
    let used = |gains: &Gains| (0..KEYS.len()).filter(|&i| gains.0[i] != 0.0).collect::<Vec<_>>();
    let good = |row: &sim_host::rider::Row| row.vaf.is_some_and(|vaf| vaf >= 90.0);
    let smallest = |name: &str| -> Vec<(u32, Vec<usize>)> {
        let table = rider(name);
        let of = |group: &[sim_host::rider::Row]| {
            let sets = group.iter().filter(|row| good(row));
            let least = sets.min_by_key(|row| used(&row.gains).len()).expect("every run has a good set");
            (least.run.expect("a run"), used(&least.gains))
        };
        table.groups().map(of).collect()
    };
    let reduced = smallest("young-reduction");
    let counts: Vec<(u32, usize)> = reduced.iter().map(|(run, gains)| (*run, gains.len())).collect();
    assert_eq!(counts, [(248, 3), (249, 2), (184, 5), (252, 5), (190, 5), (256, 6)]);
    let young = rider("young");
    assert_eq!(reduced.iter().filter(|(_, gains)| *gains == young.columns).count(), 3);

    let good_of = |name: &str| rider(name).rows.iter().filter(|row| good(row)).count();
    assert_eq!(["young", "undelayed", "undelayed-alt"].map(good_of), [14, 12, 3]);

    for (reduction, of_all, common) in [
        ("young-reduction", "young", &[184, 252, 190, 256][..]),
        ("undelayed-reduction", "undelayed", &[249]),
    ] {
        let (reduction, of_all) = (rider(reduction), rider(of_all));
        let same = |run: u32| {
            let all = of_all.rows.iter().find(|row| row.run == Some(run)).expect("all runs");
            let of_run = reduction.rows.iter().filter(|row| row.run == Some(run));
            of_run.filter(|row| used(&row.gains) == of_all.columns).any(|row| row.gains == all.gains)
        };
        for &run in common {
            assert!(same(run), "{run}");
        }
    }
}
