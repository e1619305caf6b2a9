//! Properties of a basin search.

use control::{Config, Law};
use sim_host::basin::{Axis, Column, Method, Search, basin, column, rmse, together};
use sim_host::ride::rides;
use tests::basins::{H, alone, assisted, configured, ideal, search};
use tests::sets::every;

/// Situation: law h, in the control crate, at 4 m/s.
/// Action: find the border.
/// Must hold: the ride at the border does not fall and one just beyond does.
#[test]
fn the_border_is_a_border() {
    let conditions = assisted(H);
    let search = search(&[4.0], 15.0);
    let found = column(&conditions, &search, 4.0);
    let at = |rate: f64| rides(&conditions, &[Axis::SteerRate.start(4.0, rate)])[0];
    assert!((8.0..9.0).contains(&found.upper), "{}", found.upper);
    assert!(!at(found.upper).fell() && at(found.upper + search.tolerance).fell());
    assert_eq!(found.border, Some(at(found.upper)));
    assert!(!found.capped && found.islands.is_empty());
}

/// Situation: a search limited to 5 rad/s, and a higher basin.
/// Action: search.
/// Must hold: it reports that it reached the limit, at exactly 5, also when the step does not divide it.
#[test]
fn the_cap_is_reported() {
    let search = Search { scan_step: 0.23, ..search(&[4.0], 5.0) };
    let found = column(&assisted(H), &search, 4.0);
    assert!(found.capped && found.upper == 5.0, "{found:?}");
    assert_eq!(found.scan.last().map(|p| p.rate), Some(5.0));
}

/// Situation: the bicycle without assist at 4.6 m/s, where some knocks beyond the first fall do not fall.
/// Action: search.
/// Must hold: these islands are reported, are true, and leave `upper` unchanged.
#[test]
fn islands_are_reported_not_merged() {
    let conditions = alone();
    let found = column(&conditions, &search(&[4.6], 10.0), 4.6);
    assert!(!found.islands.is_empty());
    for island in &found.islands {
        assert!(island.from > found.upper && island.to >= island.from);
        let start = |rate| Axis::SteerRate.start(4.6, rate);
        let edges = rides(&conditions, &[start(island.from), start(island.to)]);
        assert!(edges.iter().all(|r| !r.fell()), "{island:?}");
        let outside = rides(&conditions, &[start(island.from - 0.01), start(island.to + 0.01)]);
        assert!(outside.iter().all(|r| r.fell()), "{island:?}");
    }
}

/// Situation: a bicycle at rest.
/// Action: search.
/// Must hold: every knock falls, without an error.
#[test]
fn a_bicycle_at_rest_has_no_basin() {
    let found = column(&assisted(H), &search(&[0.0], 5.0), 0.0);
    assert!(found.upper < 0.01 && !found.capped && found.scan.iter().all(|p| p.outcome.name() == "fallen"));
}

/// Situation: eleven speeds, by default six.
/// Action: search on one thread and on three.
/// Must hold: every bit agrees.
#[test]
fn the_number_of_threads_does_not_matter() {
    let speeds: Vec<f64> = every(2, 0..=10).map(f64::from).collect();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| basin(&alone(), &search(&speeds, 10.0), |_| (), || false)).expect("a basin")
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one, three);
    assert!(one.area() > 10.0);
}

/// Situation: an interruption after the first column.
/// Action: search plainly, column by column, and fast, in groups of columns.
/// Must hold: completed columns are preserved, and no further ones are begun.
#[test]
fn an_interruption_preserves_completed_columns() {
    let speeds: Vec<f64> = (0..50).map(|i| 2.0 + 0.1 * f64::from(i)).collect();
    for method in [Method::Plain, Method::Fast] {
        let search = Search { method, ..search(&speeds, 2.0) };
        let done = std::sync::atomic::AtomicUsize::new(0);
        let count = || done.load(std::sync::atomic::Ordering::SeqCst);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let partial = pool.install(|| {
            let finished = |_: &Column| {
                done.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
            };
            basin(&alone(), &search, finished, || count() >= 1)
        });
        let partial = partial.expect("a basin");
        // On one thread a group at either end is the first; the last has what is left.
        let group = pool.install(|| together(&alone(), &search, speeds.len()));
        assert!(group < speeds.len(), "{group}");
        let last_group = (speeds.len() - 1) % group + 1;
        let found = partial.columns.len();
        let first = partial.columns[0].speed;
        let begun = (found == group && first == 2.0)
            || (found == last_group && first == speeds[speeds.len() - last_group]);
        assert!(begun, "{method:?}: {found} from {first} m/s");
    }
}

/// Situation: the roll rate is disturbed instead.
/// Action: search.
/// Must hold: there is a basin, a smaller one in rad/s than for the light steering assembly.
#[test]
fn roll_rate_disturbances_have_a_basin_too() {
    let steer = column(&assisted(H), &search(&[5.0], 15.0), 5.0);
    let roll = column(&assisted(H), &Search { axis: Axis::RollRate, ..search(&[5.0], 15.0) }, 5.0);
    assert!((0.1..3.0).contains(&roll.upper), "{}", roll.upper);
    assert!(roll.upper < 0.5 * steer.upper);
}

/// Situation: the law sampled at 1 kHz in f32, and the continuous one.
/// Action: compare outlines.
/// Must hold: they are close, but not the same.
#[test]
fn sampling_costs_little() {
    let search = search(&[2.0, 4.0, 6.0, 8.0], 12.0);
    let of = |c| basin(&c, &search, |_| (), || false).expect("a basin");
    let (flashed, continuous) = (of(assisted(H)), of(ideal(H)));
    let distance = rmse(&flashed, &continuous).expect("shared speeds");
    println!("rmse {} rad/s (as printed {})", distance.mean, distance.as_printed);
    assert!((1e-4..0.06).contains(&distance.mean), "{distance:?}");
    assert!((distance.as_printed - distance.mean * 2.0).abs() < 1e-12, "four columns: root 4 times");
}

/// Situation: the product's limits and h cut at 7.5 m/s.
/// Action: compare with the bare law.
/// Must hold: the limits cost basin where the bare law requests more torque than they permit, and the cut adds basin
/// where h steers out of the fall.
#[test]
fn the_product_limits_reduce_the_basin() {
    let speeds = [1.0, 3.0, 9.0];
    let of = |c| basin(&c, &search(&speeds, 15.0), |_| (), || false).expect("a basin");
    let (bare, product) = (of(assisted(H)), of(configured(Config::product())));
    for (a, b) in bare.columns.iter().zip(&product.columns) {
        println!("{} m/s: bare {:.3}, product {:.3} rad/s", a.speed, a.upper, b.upper);
    }
    assert!(product.columns[0].upper < bare.columns[0].upper - 0.2);
    assert!(product.columns[1].upper < bare.columns[1].upper - 0.2);
    assert!(product.columns[2].upper > bare.columns[2].upper + 0.2);
}

/// Situation: a law of zero.
/// Action: compare with no assist.
/// Must hold: the outlines agree to the bit.
#[test]
fn a_law_of_zero_is_no_assist() {
    let none = configured(Config::thesis(Law::None));
    let (a, b) = (column(&none, &search(&[6.0], 8.0), 6.0), column(&alone(), &search(&[6.0], 8.0), 6.0));
    assert_eq!(a, b);
    assert!(a.upper > 4.0);
}
