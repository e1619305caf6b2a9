//! Benefit and risk of the torque that limp mode leaves.

use control::{Config, GainSchedule, Law};
use rayon::prelude::*;
use sim_host::basin::{Axis, Method, Search, border};
use sim_host::plant::Plant;
use sim_host::ride::Conditions;
use tests::fault_reactions::{product, smart};
use tests::sets::every;

/// Forward speeds \[m/s\].
const SPEEDS: [f64; 5] = [2.0, 3.0, 4.3, 6.0, 7.3];

/// h cut at 7.5 m/s, times a factor.
fn h_times(factor: f32) -> Law {
    let speeds = (0..=15).map(|i| 0.5 * i as f32);
    let points: Vec<(f32, f32)> = speeds.map(|v| (v, factor * Law::H { cut: true }.gain(v))).collect();
    Law::Table(GainSchedule::new(&points).unwrap())
}

/// Mean height over [`SPEEDS`] \[rad/s\] of the smart old rider with this law, this sensor lost with the blow, and
/// this part of the torque left in limp mode.
fn mean_height(law: &Law, lost: &str, part: f32) -> f64 {
    let mut config = Config { law: law.clone(), ..product() };
    config.limits.limp_fraction = Some(part);
    let plant = Plant { faults: vec![lost.parse().unwrap()], ..Plant::default() };
    let conditions = Conditions { time_limit_s: 4.0, ..smart(config, plant) };
    let axis = Axis::SteerRate;
    let height = |speed: &f64| {
        let search = Search {
            speeds: vec![*speed],
            axis,
            max_rate: 20.0,
            scan_step: 0.5,
            tolerance: 0.05,
            method: Method::Fast,
            efforts: false,
        };
        border(&conditions, &search, *speed).upper
    };
    let sum: f64 = SPEEDS.par_iter().map(height).sum();
    sum / SPEEDS.len() as f64
}

/// The mean heights with none, half and all of the torque left.
fn heights(factor: f32, lost: &str) -> [f64; 3] {
    let heights = [0.0, 0.5, 1.0].map(|part| mean_height(&h_times(factor), lost, part));
    let [none, half, all] = heights;
    println!("{lost}, {factor} times h: none {none:.2}, half {half:.2}, all {all:.2} rad/s");
    heights
}

/// Situation: limp mode, the steer angle or the front wheel's speed lost; the gain right, twice and half the right
/// one.
/// Action: leave none, half and all of the torque.
/// Must hold: more torque is no less height; half gives most of the benefit of all of it. By default with the right
/// gain only.
#[test]
fn half_the_torque_leaves_most_of_the_benefit() {
    let cases = [
        (1.0, "steer:missing", 0.6, 0.75),
        (2.0, "steer:missing", 0.55, 0.75),
        (0.5, "steer:missing", 0.75, 0.95),
        (1.0, "front-wheel:missing", 0.85, 0.98),
    ];
    for (factor, lost, least, most) in every(3, cases) {
        let [none, half, all] = heights(factor, lost);
        assert!(none < half && half < all, "{lost}, {factor} times h");
        let worth = (half - none) / (all - none);
        assert!((least..most).contains(&worth), "{lost}, {factor} times h: {worth}");
    }
}

/// Situation: limp mode, and the gain has the wrong sign.
/// Action: the same.
/// Must hold: half the torque is no help: the blows that cause a fall need less torque than that.
#[test]
fn half_the_torque_is_no_remedy_for_a_wrong_sign() {
    let [none, half, all] = heights(-1.0, "steer:missing");
    assert!((half - all).abs() < 0.1 && half < none + 0.1, "{none} {half} {all}");
}
