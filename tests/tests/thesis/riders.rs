//! The published riders of appendices I and K, their gains held constant.

use control::Law;
use sim_host::basin::border;
use sim_host::eigen::{Feedback, Model, rightmost};
use sim_host::ride::Conditions;
use sim_host::rider::{Fit, Gains, KEYS, Neuromuscular, Outside, Rider, Schedule, catalogue};
use sim_host::thesis::published::published;
use tests::basins::{alone, search};
use tests::rides::shipped;

fn constant(gains: Gains, delay_ms: f64) -> Rider {
    Rider {
        schedule: Schedule::constant(gains),
        delay_s: delay_ms * 1e-3,
        neuromuscular: Neuromuscular::SHOULDERS,
    }
}

/// The height as Tables I.1 and I.2 print it: the first multiple of 0.1 rad/s that falls; and the printed one.
fn heights(table: &str, run: u32, set: usize) -> (f64, f64) {
    let of = published().height.iter().find(|h| h.table == table && h.run == run).expect("a run");
    let row = &of.rows[set - 1];
    let conditions =
        Conditions { rider: Some(constant(Gains::of_states(&row.gains), of.delay_ms)), ..alone() };
    let upper = border(&conditions, &search(&[of.speed], 15.0), of.speed).upper;
    ((10.0 * upper + 1e-9).floor() / 10.0 + 0.1, row.height)
}

/// Situation: sets of gains of Tables I.1 and I.2, strong and weak ones, held constant at the speed of their run.
/// Action: find the height of the basin.
/// Must hold: the first disturbance on the tables' grid that falls is the printed one; for the two sets known not to
/// be met it is 0.8 rad/s lower.
#[test]
fn heights_of_reduced_gain_sets() {
    for (table, run, set) in
        [("I.1", 248, 2), ("I.1", 249, 5), ("I.1", 184, 4), ("I.2", 249, 5), ("I.2", 190, 5), ("I.2", 256, 1)]
    {
        let (computed, printed) = heights(table, run, set);
        println!("{table}, run {run}, set {set}: computed {computed:.1}, printed {printed}");
        assert!((computed - printed).abs() < 0.11, "{table}, run {run}, set {set}: {computed}");
    }
    for (run, set) in [(252, 1), (190, 2)] {
        let (computed, printed) = heights("I.2", run, set);
        assert!((0.6..1.0).contains(&(printed - computed)), "run {run}, set {set}: {computed}");
    }
}

/// Situation: the old cyclist at 4.3 m/s, gains held constant.
/// Action: find the rightmost root of the regression's gains, of the mean's, and of the regression's with the mean's
/// gain of the roll acceleration.
/// Must hold: as appendix K states, the first is unstable and the other two are stable; the mean only just.
#[test]
fn the_regression_is_unstable_and_one_gain_makes_it_stable() {
    let table = catalogue::load("smart").unwrap_or_else(|e| panic!("{e}"));
    let gains = |fit| table.schedule(fit, Outside::Extrapolate).expect("a schedule").at(4.3);
    let (regression, mean) = (gains(Fit::Regression), gains(Fit::Mean));
    let mut mixed = regression;
    let roll_acceleration = KEYS.iter().position(|k| *k == "K_phi_dd").expect("a gain");
    mixed.0[roll_acceleration] = mean.0[roll_acceleration];
    let growth = |gains: Gains| {
        let rider = Some(constant(gains, 60.0));
        let model = Model::new(&shipped("rigid_jason").parameters, Feedback::Law(Law::None), rider);
        rightmost(&model.at(4.3)).re
    };
    let [of_regression, of_mean, of_mixed] = [regression, mean, mixed].map(growth);
    println!("regression {of_regression:+.3}, mean {of_mean:+.3}, mixed {of_mixed:+.3} 1/s");
    assert!((0.5..0.62).contains(&of_regression), "{of_regression}");
    assert!((-0.06..-0.01).contains(&of_mean), "{of_mean}");
    assert!((-0.07..-0.01).contains(&of_mixed), "{of_mixed}");
}
