//! Basins in rounds: coarse first, and with speeds added where the outline bends or jumps.

use sim_host::basin::{
    Basin, Column, Refined, Rounds, SMALLEST_STEP, SearchError, Work, basin, basin_in_rounds, rmse,
};
use std::sync::atomic::{AtomicUsize, Ordering};
use tests::basins::{H, assisted, search};

/// Tolerance of adaptive speeds, a part of the largest height.
const TOLERANCE: f64 = 0.01;

/// `count` speeds from 0, `step` apart \[m/s\].
fn speeds(step: f64, count: u32) -> Vec<f64> {
    (0..count).map(|i| (f64::from(i) * step * 1e9).round() / 1e9).collect()
}

fn adaptive(speeds: &[f64], max_rate: f64, coarse_first: bool) -> Refined {
    let rounds = Rounds { coarse_first, adaptive: Some(TOLERANCE) };
    let search = search(speeds, max_rate);
    basin_in_rounds(&assisted(H), &search, rounds, |_| (), |_| (), || false).expect("a basin")
}

/// Height of an outline between its speeds \[rad/s\].
fn height(outline: &[(f64, f64)], speed: f64) -> f64 {
    let after = outline.partition_point(|(v, _)| *v < speed).clamp(1, outline.len() - 1);
    let ((v, low), (w, high)) = (outline[after - 1], outline[after]);
    low + (high - low) * (speed - v) / (w - v)
}

/// Largest distance of an outline from a finer one \[rad/s\].
fn error(outline: &[(f64, f64)], fine: &[(f64, f64)]) -> f64 {
    fine.iter().map(|&(v, upper)| (height(outline, v) - upper).abs()).fold(0.0, f64::max)
}

/// Situation: the h basin up to 4 m/s, which rises steeply and jumps near 0.85 m/s.
/// Action: 11 speeds and adaptive ones, beside equal steps of 0.1 and 0.0125 m/s.
/// Must hold: no more speeds than of 0.1 m/s, some intervals never halved, others down to the smallest step; the outline
/// within half the tolerance of the fine one, that of 0.1 m/s outside twice the tolerance; the area within 0.1 %.
#[test]
fn adaptive_speeds_follow_a_fine_outline() {
    let whole =
        |speeds: &[f64]| basin(&assisted(H), &search(speeds, 12.0), |_| (), || false).expect("a basin");
    let (fine, equal) = (whole(&speeds(0.0125, 321)), whole(&speeds(0.1, 41)));
    let found = adaptive(&speeds(0.4, 11), 12.0, false);
    assert_eq!(found.speeds, found.basin.columns.iter().map(|c| c.speed).collect::<Vec<_>>());
    assert!((20..=41).contains(&found.speeds.len()), "{:?}", found.speeds);
    let steps: Vec<f64> = found.speeds.windows(2).map(|w| w[1] - w[0]).collect();
    let (least, most) =
        (steps.iter().copied().fold(1.0, f64::min), steps.iter().copied().fold(0.0, f64::max));
    assert!((least - SMALLEST_STEP).abs() < 1e-6 && (most - 0.4).abs() < 1e-6, "{steps:?}");
    let largest = fine.columns.iter().map(|c| c.upper).fold(0.0, f64::max);
    let [adapted, even] =
        [&found.basin, &equal].map(|basin| error(&basin.outline(), &fine.outline()) / largest);
    assert!(adapted < 0.5 * TOLERANCE && adapted > 1e-5, "{adapted}");
    assert!(even > 2.0 * TOLERANCE && even < 0.5, "{even}");
    let area = found.basin.area() / fine.area() - 1.0;
    assert!(area.abs() < 1e-3, "{area}");
}

/// Situation: a basin with adaptive speeds, and one with the given speeds only.
/// Action: compute them in the given order and coarse first, on one thread and on three.
/// Must hold: the same bits; those of a plain list of the same speeds; each column finished once.
#[test]
fn the_order_of_columns_does_not_change_them() {
    let given = speeds(0.1, 31);
    let on = |threads: usize, coarse_first| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| adaptive(&given, 4.0, coarse_first))
    };
    let found = on(1, false);
    assert_eq!((&on(3, false), &on(1, true), &on(3, true)), (&found, &found, &found));
    assert!(found.speeds.len() > given.len() && found.speeds.len() < 3 * given.len(), "{:?}", found.speeds);
    let listed =
        |speeds: &[f64]| basin(&assisted(H), &search(speeds, 4.0), |_| (), || false).expect("a basin");
    assert_eq!(found.basin, listed(&found.speeds));

    let finished = AtomicUsize::new(0);
    let count = |_: &Column| {
        finished.fetch_add(1, Ordering::SeqCst);
    };
    let rounds = Rounds { coarse_first: true, adaptive: None };
    let only = basin_in_rounds(
        &assisted(H),
        &search(&given, 4.0),
        rounds,
        |_| panic!("nothing is added"),
        count,
        || false,
    );
    assert_eq!(only, Ok(Refined { speeds: given.clone(), basin: listed(&given) }));
    assert_eq!(finished.into_inner(), given.len());
}

/// Situation: a basin with adaptive speeds.
/// Action: stop when the first speeds are added.
/// Must hold: the given speeds are kept with their bits; the added ones are named, and missing.
#[test]
fn a_stop_keeps_finished_rounds() {
    let given = speeds(0.4, 6);
    let added = AtomicUsize::new(0);
    let add = |count| {
        added.fetch_add(count, Ordering::SeqCst);
    };
    let rounds = Rounds { coarse_first: false, adaptive: Some(TOLERANCE) };
    let stop = || added.load(Ordering::SeqCst) > 0;
    let found =
        basin_in_rounds(&assisted(H), &search(&given, 4.0), rounds, add, |_| (), stop).expect("a basin");
    let kept = basin(&assisted(H), &search(&given, 4.0), |_| (), || false).expect("a basin");
    assert_eq!(found.basin, kept);
    let added = added.into_inner();
    assert!((1..6).contains(&added));
    assert_eq!(found.speeds.len(), given.len() + added);
    assert!(found.speeds.is_sorted() && given.iter().all(|v| found.speeds.contains(v)), "{:?}", found.speeds);
}

/// Situation: tolerances of adaptive speeds that mean nothing.
/// Action: search.
/// Must hold: an error with the value and the range.
#[test]
fn impossible_tolerances_are_refused() {
    for tolerance in [0.0, -0.1, 1.5, f64::NAN, 1e-5] {
        let rounds = Rounds { coarse_first: false, adaptive: Some(tolerance) };
        let refused = basin_in_rounds(&assisted(H), &search(&[4.0], 4.0), rounds, |_| (), |_| (), || false);
        let Err(SearchError::Range(error)) = refused else { panic!("{tolerance}: {refused:?}") };
        assert!(error.to_string().contains("adaptive speeds"), "{error}");
    }
}

fn outline(points: &[(f64, f64)]) -> Basin {
    let column = |&(speed, upper): &(f64, f64)| Column {
        speed,
        upper,
        capped: false,
        islands: Vec::new(),
        scan: Vec::new(),
        outcome: None,
        border: None,
        beyond: None,
        work: Work::default(),
    };
    Basin { columns: points.iter().map(column).collect() }
}

/// Situation: an outline with a step, at equal speeds and with many speeds at the step.
/// Action: mean height, area and root-mean-square distance from zero.
/// Must hold: at equal steps the plain mean; the added speeds hardly change any of them, where plain means would double.
#[test]
fn means_do_not_prefer_added_speeds() {
    let step = |v: f64| (v, if v < 2.0 { 1.0 } else { 4.0 });
    let added = [0.0, 1.0, 2.0, 2.0625, 2.125, 2.25, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0];
    let equal = outline(&speeds(1.0, 8).into_iter().map(step).collect::<Vec<_>>());
    let unequal = outline(&added.map(step));
    assert_eq!(equal.mean_height(), Some((2.0 + 6.0 * 4.0) / 8.0));
    let mean = unequal.mean_height().expect("a mean");
    assert!((mean - 3.25).abs() < 1e-12, "{mean}");
    assert!((unequal.area() - equal.area()).abs() < 1e-12);
    let zero = outline(&speeds(0.0625, 200).into_iter().map(|v| (v, 0.0)).collect::<Vec<_>>());
    let [even, uneven] = [&equal, &unequal].map(|basin| rmse(basin, &zero).expect("common speeds").mean);
    assert!(
        (even - uneven).abs() < 1e-12 && (even - (98.0_f64 / 8.0).sqrt()).abs() < 1e-12,
        "{even} {uneven}"
    );
    assert_eq!(outline(&[]).mean_height(), None);
    assert_eq!(outline(&[(3.0, 2.0)]).mean_height(), Some(2.0));
}
