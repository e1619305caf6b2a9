//! The fast search of basins against the plain one, and quick rides against exact ones.

use control::{Config, DeadBand, Law};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use sim_host::basin::{Axis, Column, Method, PlaneSearch, Search, basin, border, borders, plane, together};
use sim_host::plant::Supply;
use sim_host::ride::{
    Conditions, FallCriterion, Foreseen, Imu, LaidFlat, Outcome, Quick, Start, rides, side_by_side,
};
use sim_host::rider::Rider;
use tests::basins::{H, alone, assisted, configured, ideal, search};
use tests::fault_reactions::{product, rider};

/// Difference of a time of fall that counts \[s\].
const TIME_S: f64 = 1e-3;

/// The conditions with a rider.
fn ridden(name: &str, conditions: Conditions) -> Conditions {
    Conditions { rider: Some(rider(name)), ..conditions }
}

/// Both searches of a basin.
fn both(conditions: &Conditions, fast: &Search) -> [Vec<Column>; 2] {
    let plain = Search { method: Method::Plain, ..fast.clone() };
    [fast, &plain].map(|search| basin(conditions, search, |_| (), || false).expect("a basin").columns)
}

/// The control crate with cl2:4 behind a dead band, around which a bicycle goes on swaying.
fn banded() -> Config {
    let dead_band = DeadBand { roll_rate_rad_s: 0.05 };
    Config { dead_band, ..Config::thesis(Law::Cl2 { k: 4.0 }) }
}

/// Compares all but the computing effort: bit for bit, the times of falls of the scan within [`TIME_S`]; and the fast search without
/// the efforts of the rides at the borders. Returns the number of falls, and of those that differ by more or in their cause.
fn compared(conditions: &Conditions, fast: &Search) -> (usize, usize) {
    let without = Search { efforts: false, ..fast.clone() };
    let without = basin(conditions, &without, |_| (), || false).expect("a basin").columns;
    let [fast, plain] = both(conditions, fast);
    for (fast, without) in fast.iter().zip(without) {
        assert_eq!(Column { border: None, work: without.work, ..fast.clone() }, without);
    }
    assert_eq!(fast.len(), plain.len());
    let (mut falls, mut apart) = (0, 0);
    for (fast, plain) in fast.iter().zip(&plain) {
        let at = fast.speed;
        assert_eq!((fast.upper, fast.capped), (plain.upper, plain.capped), "height at {at} m/s");
        assert_eq!(fast.islands, plain.islands, "islands at {at} m/s");
        assert_eq!(
            (fast.outcome, fast.border, fast.beyond),
            (plain.outcome, plain.border, plain.beyond),
            "border at {at} m/s"
        );
        for (fast, plain) in fast.scan.iter().zip(&plain.scan) {
            assert_eq!(fast.rate, plain.rate);
            match (fast.outcome.time_to_fall_s(), plain.outcome.time_to_fall_s()) {
                (Some(one), Some(other)) => {
                    falls += 1;
                    let same = fast.outcome.fall() == plain.outcome.fall() && (one - other).abs() <= TIME_S;
                    apart += usize::from(!same);
                }
                _ => assert_eq!(fast.outcome, plain.outcome, "{at} m/s, {} rad/s", fast.rate),
            }
        }
    }
    (falls, apart)
}

/// Situation: basins of h in the control crate, with islands, undecided borders and a height without a fall; of no assist;
/// of cl2:4, also behind a dead band, and of h in continuous time, there with roll rate as the disturbance; of riders alone, with and
/// without neural delay, and beside h. Action: search them fast and plainly.
/// Must hold: heights, islands, border rides and outcomes have the same bits; of the falls at most one in fifty
/// differs by more than 1 ms or in its cause (bicycles that turn over first), and some differ in their last digits.
#[test]
fn fast_and_plain_searches_agree() {
    let roll = Search { axis: Axis::RollRate, ..search(&[3.0, 6.0], 6.0) };
    let cases = [
        (assisted(H), search(&[0.0, 0.8, 2.0, 4.0, 5.8, 7.5, 9.0], 20.0)),
        (assisted(H), search(&[5.0], 3.0)),
        (alone(), search(&[2.0, 4.6, 6.5], 8.0)),
        (assisted("cl2:4".parse().expect("a law")), search(&[1.0, 4.0], 12.0)),
        (ideal(H), roll),
        (ridden("young", alone()), search(&[2.0, 4.6, 7.2], 14.0)),
        (ridden("smart", assisted(H)), search(&[2.0, 4.3, 6.5], 14.0)),
        (ridden("hess", alone()), search(&[3.0], 6.0)),
        (configured(banded()), search(&[4.6, 4.9, 5.0], 20.0)),
    ];
    let (mut falls, mut apart) = (0, 0);
    for (conditions, search) in &cases {
        assert!(Quick::new(conditions).is_some());
        let (more, further) = compared(conditions, search);
        (falls, apart) = (falls + more, apart + further);
    }
    assert!(falls > 300 && 50 * apart <= falls, "{apart} of {falls} times of falls differ by more than 1 ms");
}

/// Situation: as above, every speed of the default basin under h, g and cl2:4, without assist, and in continuous time.
/// Action and what must hold: as above.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn fast_and_plain_default_basins_agree() {
    let speeds: Vec<f64> = (0..=100).map(|i| f64::from(i) / 10.0).collect();
    let cl2: Law = "cl2:4".parse().expect("a law");
    for conditions in [assisted(H), assisted(Law::G), assisted(cl2), alone(), ideal(H)] {
        let (falls, apart) = compared(&conditions, &search(&speeds, 30.0));
        println!("{apart} of {falls} falls differ by more than 1 ms or in their cause");
        assert!(falls > 5000 && 100 * apart <= falls, "{apart} of {falls}");
    }
}

/// Situation: as above, every speed of the riders' default basin: the young rider alone, the smart one alone and beside h.
/// Action and what must hold: as above.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn fast_and_plain_basins_with_riders_agree() {
    let speeds: Vec<f64> = (20..=75).map(|i| f64::from(i) / 10.0).collect();
    for conditions in [ridden("young", alone()), ridden("smart", alone()), ridden("smart", assisted(H))] {
        let (falls, apart) = compared(&conditions, &search(&speeds, 30.0));
        println!("{apart} of {falls} falls differ by more than 1 ms or in their cause");
        assert!(falls > 4000 && 80 * apart <= falls, "{apart} of {falls}");
    }
}

/// Situation: bicycles under any law, and under the product, with any small or large disturbance. Action: ride quickly and
/// exactly.
/// Must hold: every quick outcome is the exact one, but for at most one in 500 chaotic rides; few are left open; and quick
/// rides take at most a third of the steps.
fn random_rides(cases: u32) {
    let laws = [Law::None, H, Law::H { cut: true }, Law::F, Law::G, "cl1".parse().expect("a law")];
    let all: Vec<Conditions> = laws.into_iter().map(assisted).chain([configured(product())]).collect();
    let starts = (0..all.len(), 0.0..10.0, -20.0..20.0, -3.0..3.0, any::<bool>());
    let mut runner = TestRunner::default();
    let mut rides_of: Vec<Vec<Start>> = vec![Vec::new(); all.len()];
    for _ in 0..cases {
        let (assist, speed_m_s, steer_rate_rad_s, roll_rate_rad_s, small) =
            starts.new_tree(&mut runner).expect("a start").current();
        let scale = if small { 0.1 } else { 1.0 };
        let (steer_rate_rad_s, roll_rate_rad_s) = (scale * steer_rate_rad_s, scale * roll_rate_rad_s);
        rides_of[assist].push(Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s });
    }
    let (mut other, mut open, mut quick_steps, mut steps) = (Vec::new(), 0, 0, 0);
    for (assist, (conditions, starts)) in all.iter().zip(&rides_of).enumerate() {
        let quick = Quick::new(conditions).expect("quick rides").rides(starts);
        for (quick, exact) in quick.iter().zip(rides(conditions, starts)) {
            (quick_steps, steps) = (quick_steps + quick.steps, steps + exact.steps);
            let same = |outcome: Outcome| match (outcome.fall(), exact.outcome.fall()) {
                (None, None) => outcome == exact.outcome,
                (one, other) => one == other,
            };
            match quick.outcome {
                Some(outcome) if !same(outcome) => other.push((assist, exact.start, outcome, exact.outcome)),
                Some(_) => {}
                None => open += 1,
            }
        }
    }
    assert!(500 * other.len() <= cases as usize, "{other:?}");
    assert!((0..=cases / 50).contains(&open), "{open} open");
    assert!(quick_steps > 0 && 3 * quick_steps < steps, "{quick_steps} of {steps} steps");
}

/// Situation, action and what must hold: see [`random_rides`].
#[test]
fn quick_rides_end_as_exact_ones() {
    random_rides(500);
}

/// Situation, action and what must hold: see [`random_rides`].
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn many_quick_rides_end_as_exact_ones() {
    random_rides(20_000);
}

/// Situation: small disturbances at speeds on both sides of weave and capsize speed, and ride times from 2 to 30 s; without
/// riders, and with riders with and without neural delay.
/// Action: ride quickly, where the linear model decides most, and exactly.
/// Must hold: recovered and undecided are the same, and both occur.
#[test]
fn the_linear_model_decides_as_the_nonlinear() {
    let speeds = (0..40).map(|i| 0.25 * f64::from(i));
    let starts: Vec<Start> =
        speeds.flat_map(|speed| [0.1, 1.0, 2.0].map(|rate| Axis::SteerRate.start(speed, rate))).collect();
    let mut counts = [0; 2];
    for time_limit_s in [2.0, 6.0, 30.0] {
        let with_riders =
            [ridden("young", alone()), ridden("smart", assisted(H)), ridden("hess-benchmark", alone())];
        for conditions in [alone(), assisted(H)].into_iter().chain(with_riders) {
            let conditions = Conditions { time_limit_s, ..conditions };
            let quick = Quick::new(&conditions).expect("quick rides").rides(&starts);
            for (quick, exact) in quick.iter().zip(rides(&conditions, &starts)) {
                let Some(outcome) = quick.outcome.filter(|outcome| outcome.fall().is_none()) else {
                    continue;
                };
                assert_eq!(outcome, exact.outcome, "{:?} in {time_limit_s} s", exact.start);
                counts[usize::from(outcome == Outcome::Recovered)] += 1;
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
}

/// Situation: a controller with more than a law: the product with all its checks, alone and with a rider, and h with a limit
/// only. Action and what must hold: as above.
#[test]
fn fast_and_plain_searches_with_a_controller_agree() {
    let mut limited = Config::thesis(H);
    limited.limits.max_torque_nm = Some(5.0);
    let cases = [
        (configured(product()), search(&[2.0, 5.0, 7.0], 12.0)),
        (ridden("smart", configured(product())), search(&[4.5], 12.0)),
        (configured(limited), search(&[4.0], 10.0)),
    ];
    for (conditions, search) in &cases {
        assert!(Quick::new(conditions).is_some());
        let (falls, apart) = compared(conditions, search);
        assert!(
            falls > 5 && 50 * apart <= falls,
            "{apart} of {falls} times of falls differ by more than 1 ms"
        );
    }
}

/// Situation: as above, every speed of the product's default basin, and of the smart rider's beside it.
/// Action and what must hold: as above.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn fast_and_plain_basins_of_the_product_agree() {
    let speeds: Vec<f64> = (0..=100).map(|i| f64::from(i) / 10.0).collect();
    for (conditions, speeds) in
        [(configured(product()), &speeds[..]), (ridden("smart", configured(product())), &speeds[20..=75])]
    {
        let (falls, apart) = compared(&conditions, &search(speeds, 30.0));
        println!("{apart} of {falls} falls differ by more than 1 ms or in their cause");
        assert!(falls > 4000 && 100 * apart <= falls, "{apart} of {falls}");
    }
}

/// The control crate with h under limits of the torque \[N m\] and of its change \[N m/s\], with sensors delayed by `delay_ticks`
/// control periods.
fn limited(max_torque_nm: Option<f32>, rate_nm_s: Option<f32>, delay_ticks: u16) -> Conditions {
    let mut config = Config::thesis(H);
    config.limits.max_torque_nm = max_torque_nm;
    (config.limits.rise_nm_s, config.limits.fall_nm_s) = (rate_nm_s, rate_nm_s);
    Conditions { sensor_delay_ticks: delay_ticks, ..configured(config) }
}

/// The same conditions with a motor that responds with this time constant \[s\].
fn lagging(time_constant_s: f64, mut conditions: Conditions) -> Conditions {
    conditions.plant.actuator.time_constant_s = time_constant_s;
    conditions
}

/// Situation: h behind limits of the torque and of its change, late sensors, or a motor that is late, weak, has a wrong torque
/// constant or a lag, without a rider and with one; steer or roll rate disturbed. With a disturbed roll rate the late torque begins
/// with a jump. Action: search fast and plainly.
/// Must hold: heights, islands, border rides and outcomes have the same bits; of the falls at most one in 25 differs by more than
/// 1 ms.
#[test]
fn fast_and_plain_searches_agree_behind_limits_and_delays() {
    let roll = |speeds: &[f64]| Search { axis: Axis::RollRate, ..search(speeds, 8.0) };
    let mut motor = limited(None, None, 0);
    motor.plant.actuator.delay_ticks = 10;
    motor.plant.actuator.scale = 0.8;
    motor.plant.actuator.limit_nm = Some(6.0);
    let mut unequal = Config::thesis(H);
    (unequal.limits.rise_nm_s, unequal.limits.fall_nm_s) = (Some(40.0), Some(100.0));
    let cases = [
        (limited(Some(2.0), None, 0), search(&[2.0, 5.0], 14.0)),
        (limited(None, Some(30.0), 0), search(&[3.0, 5.5], 14.0)),
        (configured(unequal), search(&[4.0], 14.0)),
        (limited(None, None, 5), search(&[3.0, 6.0], 14.0)),
        (limited(Some(5.0), Some(50.0), 60), search(&[4.0], 14.0)),
        (limited(None, None, 10), roll(&[3.0, 5.0])),
        (limited(Some(7.0), Some(50.0), 20), roll(&[4.0])),
        (limited(None, None, 1), search(&[3.0, 6.0], 14.0)),
        (limited(None, Some(50.0), 2), roll(&[4.0])),
        (lagging(20e-3, limited(None, None, 0)), search(&[3.0, 6.0], 14.0)),
        (lagging(2e-3, limited(None, None, 3)), roll(&[3.0, 5.0])),
        (lagging(50e-3, motor.clone()), search(&[4.5], 14.0)),
        (motor, search(&[4.5], 14.0)),
        (ridden("smart", limited(None, None, 2)), roll(&[4.0])),
        (ridden("smart", lagging(10e-3, limited(None, None, 2))), roll(&[4.0])),
        (ridden("young", lagging(20e-3, limited(Some(5.0), None, 0))), search(&[3.0, 6.0], 14.0)),
        (ridden("smart", limited(Some(5.0), Some(50.0), 40)), search(&[3.0, 6.0], 14.0)),
        (ridden("smart", limited(None, None, 20)), roll(&[4.0])),
        (ridden("hess", limited(Some(5.0), None, 10)), search(&[3.0], 6.0)),
    ];
    let (mut falls, mut apart) = (0, 0);
    for (conditions, search) in &cases {
        assert!(Quick::new(conditions).is_some());
        let (more, further) = compared(conditions, search);
        (falls, apart) = (falls + more, apart + further);
    }
    assert!(falls > 300 && 25 * apart <= falls, "{apart} of {falls} times of falls differ by more than 1 ms");
}

/// Situation: as above, every speed of the default basin, and of the smart rider's. Action and what must hold: as above.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn fast_and_plain_basins_agree_behind_limits_and_delays() {
    let speeds: Vec<f64> = (0..=100).map(|i| f64::from(i) / 10.0).collect();
    let bare = [
        limited(Some(5.0), None, 0),
        limited(None, Some(50.0), 0),
        limited(None, None, 20),
        limited(Some(7.0), Some(100.0), 10),
        limited(None, None, 2),
        lagging(20e-3, limited(None, None, 0)),
        lagging(10e-3, limited(Some(7.0), Some(100.0), 3)),
    ];
    let with_rider = [
        limited(Some(5.0), None, 0),
        limited(None, None, 20),
        limited(Some(7.0), Some(100.0), 40),
        limited(None, None, 2),
        lagging(20e-3, limited(None, None, 0)),
    ];
    let all = bare.into_iter().map(|conditions| (conditions, &speeds[..]));
    let with_rider = with_rider.map(|conditions| (ridden("smart", conditions), &speeds[20..=75]));
    for (conditions, speeds) in all.chain(with_rider) {
        let (falls, apart) = compared(&conditions, &search(speeds, 30.0));
        println!("{apart} of {falls} falls differ by more than 1 ms or in their cause");
        assert!(falls > 4000 && 25 * apart <= falls, "{apart} of {falls}");
    }
}

/// Situation: heights of several speeds, under a fast search and a plain one, searched together and one by one. Action: compare.
/// Must hold: the same bits; a fast search gives every thread some, at most twice as many as rides are side by side, a plain one
/// single speeds.
#[test]
fn heights_are_the_same_together_and_alone() {
    let conditions = limited(Some(5.0), None, 20);
    let fast = search(&[2.0, 3.0, 4.0, 5.0, 6.0], 14.0);
    let alone =
        |search: &Search| search.speeds.iter().map(|&v| border(&conditions, search, v)).collect::<Vec<_>>();
    let plain = Search { method: Method::Plain, ..fast.clone() };
    for search in [&fast, &plain] {
        let some = borders(&conditions, search, &search.speeds);
        for (one, other) in some.iter().zip(alone(search)) {
            assert_eq!(
                (one.upper, one.outcome, one.border, one.beyond),
                (other.upper, other.outcome, other.border, other.beyond)
            );
            assert_eq!(one.scan, other.scan, "{} m/s", one.speed);
        }
        assert_eq!(some.len(), 5);
    }
    let left = 3 * rayon::current_num_threads();
    assert_eq!(together(&conditions, &fast, left), 3.min(2 * side_by_side()));
    assert_eq!(together(&conditions, &fast, 1000 * left), 2 * side_by_side());
    assert_eq!(together(&conditions, &plain, left), 1);
}

/// Situation: random disturbances under laws, one with a dead band, and beside riders, also where a bicycle lies flat at 10 degrees.
/// Action: decide their outcomes, exact for a second. Must hold: the outcomes of exact rides; most end before the time limit, and some of those that later
/// leave the settled motion fall, at the same time.
#[test]
fn settled_rides_end_as_exact_ones() {
    let flat = LaidFlat { roll_rad: 10_f64.to_radians(), lasting_s: 2.5 };
    let lying = FallCriterion { flat: Some(flat), ..FallCriterion::PUBLISHED };
    let cases = [
        assisted(H),
        assisted(Law::Cl2 { k: 4.0 }),
        ideal(H),
        ridden("young", alone()),
        ridden("smart", assisted(H)),
        alone(),
        Conditions { fall: lying, ..ideal(H) },
        configured(banded()),
    ];
    let mut runner = TestRunner::deterministic();
    let (mut early, mut all, mut fallen) = (0, 0, 0);
    for conditions in &cases {
        let strategy = (2.0..8.0, -9.0..9.0, -1.0..1.0);
        let mut start = || {
            let (speed_m_s, steer_rate_rad_s, roll_rate_rad_s) =
                strategy.new_tree(&mut runner).expect("a value").current();
            Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s }
        };
        let starts: Vec<Start> = (0..150).map(|_| start()).collect();
        let quick = Quick::new(conditions).expect("quick rides");
        let foreseen = |&start: &Start| Foreseen { start, lasts_s: conditions.time_limit_s, exact_s: 1.0 };
        let decided = quick.decided(&starts.iter().map(foreseen).collect::<Vec<_>>());
        for (decided, exact) in decided.iter().zip(rides(conditions, &starts)) {
            assert_eq!((decided.start, decided.outcome), (exact.start, exact.outcome), "{:?}", exact.start);
            let later = exact.outcome.time_to_fall_s().is_some_and(|time_s| time_s > 1.5);
            fallen += usize::from(later);
            all += usize::from(!exact.fell());
            early += usize::from(decided.end.t < conditions.time_limit_s && !exact.fell());
        }
    }
    assert!(all > 300 && 4 * early > 3 * all && fallen > 5, "{early} of {all} early, {fallen} late falls");
}

/// Situation: a plane of disturbances, and the height alone at one speed. Action: search both fast and plainly.
/// Must hold: the rays' borders and the height have the same bits.
#[test]
fn fast_and_plain_planes_and_heights_agree() {
    let fast = PlaneSearch { speed: 4.0, rays: 10, points: 40, tolerance: 0.002, ..PlaneSearch::default() };
    let plain = PlaneSearch { method: Method::Plain, ..fast };
    let conditions = assisted(H);
    let [fast, plain] =
        [fast, plain].map(|search| plane(&conditions, &search, |_| (), || false).expect("a plane"));
    assert_eq!(fast.rays.len(), 10);
    for (fast, plain) in fast.rays.iter().zip(&plain.rays) {
        assert_eq!((fast.column.upper, fast.column.outcome), (plain.column.upper, plain.column.outcome));
    }
    assert!(fast.work().steps < plain.work().steps);
    let fast = search(&[4.0], 30.0);
    let plain = Search { method: Method::Plain, ..fast.clone() };
    let [fast, plain] = [&fast, &plain].map(|search| border(&conditions, search, 4.0));
    assert_eq!((fast.upper, fast.border, fast.beyond), (plain.upper, plain.border, plain.beyond));
    assert!((8.0..9.0).contains(&fast.upper), "{}", fast.upper);
    assert!(2 * fast.work.steps < plain.work.steps, "{:?} {:?}", fast.work, plain.work);
}

/// Situation: conditions under which more acts than controller, constant delays, a motor's lag and rider: a motor with a voltage,
/// friction; the product with late sensors; and a rider's neural delay of two control periods, which would limit the steps to it.
/// Action: search.
/// Must hold: there are no quick rides, and both searches are one. A dead band, the gyro's own axis and the speed of the
/// rear wheel are part of the law.
#[test]
fn quick_rides_exist_for_controller_and_rider_alone() {
    let mut friction = assisted(H);
    friction.plant.actuator.friction.coulomb_nm = 0.1;
    let mut supplied = assisted(H);
    supplied.plant.actuator.supply =
        Some(Supply { voltage_v: 24.0, resistance_ohm: 0.2, constant_nm_a: 1.0 });
    let others = [
        friction,
        supplied,
        Conditions { sensor_delay_ticks: 20, ..configured(product()) },
        Conditions { rider: Some(Rider { delay_s: 2e-3, ..rider("young") }), ..alone() },
    ];
    for conditions in &others {
        assert!(Quick::new(conditions).is_none());
    }
    let [fast, plain] = both(&others[0], &search(&[4.0], 10.0));
    assert_eq!(fast, plain);
    let band = DeadBand { roll_rate_rad_s: 0.05 };
    let law = configured(Config { dead_band: band, ..Config::thesis(H) });
    let body = Conditions { imu: Imu::Body, ..law };
    let (falls, apart) = compared(&body, &search(&[3.0, 5.0], 12.0));
    assert!(falls > 20 && apart <= 1, "{apart} of {falls}");
}
