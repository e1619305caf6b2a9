//! The linear analysis with a delay: characteristic roots of known systems, none missed, none spurious; published
//! roots and stable speeds of riders; modes.

use control::Law;
use nalgebra::{Complex, DMatrix, DVector, RowDVector};
use sim_host::bicycle::Parameters;
use sim_host::eigen::{
    Crossing, DelaySystem, Feedback, Intuitive, LinearActuator, Mode, Model, NEUTRAL_1_S, critical_speeds,
    modes, rightmost, roots, stability,
};
use sim_host::rider::{Fit, Gains, KEYS, Neuromuscular, Outside, Rider, Row, Schedule, catalogue};
use std::f64::consts::{PI, TAU};
use tests::cli::repository;
use tests::published::{Published, entry};
use tests::rides::{all_shipped, shipped};

type C = Complex<f64>;

/// `x' = -a x(t - delay)`.
fn scalar(a: f64, delay_s: f64) -> DelaySystem {
    DelaySystem {
        a: DMatrix::zeros(1, 1),
        b: DVector::from_element(1, -a),
        k: RowDVector::from_element(1, 1.0),
        delay_s,
    }
}

/// Branches of Lambert's W, `w exp(w) = z`, around the real ones, for a negative `z`: by Newton on `w + ln w = ln z +
/// 2 pi i k`; the two real ones above `-1/e` share their `k`.
fn lambert_w(z: f64) -> Vec<C> {
    let branch = |k: i32, start: Option<C>| {
        let target = C::new(z, 0.0).ln() + C::new(0.0, TAU * f64::from(k));
        let mut w = start.unwrap_or(target - target.ln());
        for _ in 0..50 {
            w -= (w + w.ln() - target) / (w.inv() + 1.0);
        }
        w
    };
    let first = if z > -(-1.0_f64).exp() {
        vec![branch(0, Some(C::new(0.5 * z, 0.0))), branch(0, Some(C::new(-3.0, 0.0)))]
    } else {
        let upper = branch(0, Some(C::new(0.3, 1.3)));
        vec![upper, upper.conj()]
    };
    first.into_iter().chain((1..8).flat_map(|k| [branch(k, None), branch(k, None).conj()])).collect()
}

fn rider(of: impl Fn(&str) -> f64, delay_s: f64) -> Rider {
    let gains = Gains(KEYS.map(of));
    Rider { schedule: Schedule::constant(gains), delay_s, neuromuscular: Neuromuscular::SHOULDERS }
}

fn with_rider(bicycle: &str, law: Law, rider: Rider) -> Model {
    Model::new(&shipped(bicycle).parameters, Feedback::Law(law), Some(rider))
}

/// A gain of a row of `keys` and values; 0 for others.
fn gain(published: &Published, row: &str, key: &str) -> f64 {
    const ORDER: [&str; 7] =
        ["K_phi_p", "K_phi_d", "K_phi_dd", "K_delta_p", "K_delta_i", "K_delta_d", "K_delta_dd"];
    ORDER.iter().position(|k| *k == key).map_or(0.0, |i| published.row::<7>(row)[i])
}

/// The rider of Table K.1 with 60 ms.
fn smart(row: &str) -> Rider {
    let table = entry("smart_rider_at_4_3");
    rider(|key| gain(&table, row, key), table.number("delay_s"))
}

/// De Lange's rider without delay.
fn undelayed(fit: Fit) -> Rider {
    let table = catalogue::load("undelayed").unwrap_or_else(|e| panic!("{e}"));
    table.rider(fit, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"))
}

/// Approximate distance of `s` from a root, relative or absolute: the determinant over its derivative, that by
/// central differences.
fn residual(system: &DelaySystem, s: C) -> f64 {
    let determinant = |s: C| system.characteristic(s).determinant();
    let size = s.norm().max(1.0);
    let h = 1e-4 * size;
    let derivative = (determinant(s + h) - determinant(s - h)) / (2.0 * h);
    (determinant(s) / derivative).norm() / size
}

/// Winding number of the characteristic determinant around zero along the border of a rectangle: the number of roots
/// in it.
fn count(system: &DelaySystem, corner: C, opposite: C) -> i32 {
    let determinant = |s: C| system.characteristic(s).determinant();
    let (low, high) = (corner, opposite);
    let corners = [low, C::new(high.re, low.im), high, C::new(low.re, high.im), low];
    let mut turned = 0.0;
    for side in corners.windows(2) {
        let n = 4000;
        let point = |i: usize| side[0] + (side[1] - side[0]) * (i as f64 / n as f64);
        let mut before = determinant(point(0));
        for i in 1..=n {
            let now = determinant(point(i));
            let turn = (now / before).arg();
            assert!(turn.abs() < 1.0, "the contour passes a root: {turn} at {}", point(i));
            turned += turn;
            before = now;
        }
    }
    (turned / TAU).round() as i32
}

/// Situation: the scalar equation whose roots are branches of Lambert's W.
/// Action: compute the twelve rightmost.
/// Must hold: they are those branches, to rounding.
#[test]
fn scalar_roots_are_lamberts() {
    let mut worst: f64 = 0.0;
    for (a, delay) in [(1.0, 1.0), (0.2, 1.0), (PI / 2.0, 1.0), (5.0, 0.06), (300.0, 0.03)] {
        let found = roots(&scalar(a, delay), 12);
        assert!(found.len() >= 12);
        let branches: Vec<C> = lambert_w(-a * delay).into_iter().map(|w| w / delay).collect();
        for root in found {
            let off = branches.iter().map(|w| (w - root).norm()).fold(f64::INFINITY, f64::min);
            worst = worst.max(off / root.norm().max(1.0));
            assert!(off < 1e-11 * root.norm().max(1.0), "a = {a}, delay {delay}: {root} is off by {off:e}");
        }
    }
    println!("largest difference {worst:.1e}");
    // At a = pi/2 the oscillation neither grows nor decays.
    let border = rightmost(&scalar(PI / 2.0, 1.0));
    assert!((border - C::new(0.0, PI / 2.0)).norm() < 1e-12, "{border}");
}

/// Situation: the same rider with ever smaller delays, and without.
/// Action: compare the rightmost roots.
/// Must hold: the differences vanish in proportion to the delay.
#[test]
fn roots_go_to_eigenvalues_with_the_delay() {
    let of = |delay_s| {
        let rider = Rider { delay_s, ..smart("mean") };
        roots(&with_rider("rigid_jason", Law::None, rider).at(4.3), 7)
    };
    let ordinary = of(0.0);
    let apart = |delay| of(delay).iter().zip(&ordinary).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    let (a, b, c) = (apart(1e-5), apart(1e-6), apart(1e-7));
    println!("{a:.2e}, {b:.2e}, {c:.2e}");
    assert!(a < 0.01 && (9.0..11.0).contains(&(a / b)) && (9.0..11.0).contains(&(b / c)), "{a} {b} {c}");
}

/// Situation: riders with all kinds of gains, laws, speeds and delays.
/// Action: compute the rightmost roots, and the winding number of the region right of the last.
/// Must hold: each root solves the characteristic equation, points beside it do not; there are as many as the winding
/// number, so none is missed and none spurious.
#[test]
fn no_root_is_missed_and_none_invented() {
    let everything = |key: &str| match key {
        "K_phi_p" => 12.0,
        "K_phi_i" => -3.0,
        "K_phi_d" => 9.0,
        "K_phi_dd" => 2.0,
        "K_delta_p" => -6.0,
        "K_delta_i" => 2.5,
        "K_delta_d" => -1.5,
        "K_delta_dd" => 0.05,
        "K_psi" => -1.0,
        _ => -0.4,
    };
    let mut worst: f64 = 0.0;
    let mut checked = 0;
    for delay in [0.02, 0.06, 0.2, 0.5] {
        for (name, rider) in [
            ("mean", Rider { delay_s: delay, ..smart("mean") }),
            ("regression", Rider { delay_s: delay, ..smart("regression") }),
            ("undelayed", Rider { delay_s: delay, ..undelayed(Fit::Regression) }),
            ("everything", rider(everything, delay)),
        ] {
            for (law, v) in [(Law::None, 0.5), (Law::None, 4.3), (Law::H { cut: false }, 2.0), (Law::F, 9.0)]
            {
                let system = with_rider("rigid_jason", law, rider.clone()).at(v);
                let found = roots(&system, 12);
                assert!(found.len() >= 12, "{name}, {delay} s: {}", found.len());
                for root in &found {
                    let off = residual(&system, *root);
                    assert!(off < 1e-12, "{name}, {delay} s, {v} m/s: {root} is off by {off:e}");
                    worst = worst.max(off);
                }
                // The border lies between the last root and the next one to its left.
                let more = roots(&system, found.len() + 1);
                let border = 0.5 * (found[found.len() - 1].re + more[found.len()].re);
                let high = 40.0 + 3.0 * found.iter().map(|s| s.norm()).fold(0.0, f64::max);
                let number = count(&system, C::new(border, -high), C::new(high, high));
                assert_eq!(number, found.len() as i32, "{name}, {delay} s, {v} m/s: {found:?}");
                checked += 1;
            }
        }
    }
    println!("{checked} systems, largest distance {worst:.1e}");
    assert_eq!(checked, 64);
    let system = with_rider("rigid_jason", Law::None, smart("mean")).at(4.3);
    let beside = residual(&system, rightmost(&system) + 1e-6);
    assert!((0.9e-6..1.1e-6).contains(&beside), "{beside:e}");
}

/// Situation: a system of ten states: integrals, heading and lateral offset.
/// Action: multiply it out for one mode by hand.
/// Must hold: the signal is the sum of gains times the integrals and derivatives.
#[test]
fn the_signal_is_made_of_the_motion() {
    let ones = rider(|_| 1.0, 0.1);
    let p = shipped("benchmark").parameters;
    let system = Model::new(&p, Feedback::Law(Law::None), Some(ones)).at(3.0);
    // Along exp(s t) roll and steer are free; all else follows from them.
    let s = C::new(0.7, 1.9);
    let (roll, steer, torque) = (C::new(1.0, 0.0), C::new(0.4, -0.3), C::new(0.0, 0.0));
    let heading = (steer * 3.0 + s * steer * p.c) * p.lam.cos() / p.w / s;
    let lateral = (heading * 3.0 + s * heading * p.w - s * steer * p.c * p.lam.cos()) / s;
    let state = [roll, steer, s * roll, s * steer, roll / s, steer / s, heading, lateral, torque, torque];
    let row = |i: usize| (0..10).map(|j| state[j] * system.a[(i, j)]).sum::<C>();
    for kinematic in [0, 1, 4, 5, 6, 7] {
        assert!((row(kinematic) - s * state[kinematic]).norm() < 1e-12, "state {kinematic}");
    }
    let signal: C = (0..10).map(|j| state[j] * system.k[j]).sum();
    let expected = state[..8].iter().sum::<C>() + row(2) + row(3);
    assert!((signal - expected).norm() < 1e-10, "{signal} {expected}");
}

/// Situation: the smart rider at 4.3 m/s with 60 ms, gains as printed.
/// Action: compute the rightmost root.
/// Must hold: the regression's oscillation grows, the mean's does not, nor the regression's with the
/// mean's roll acceleration gain.
#[test]
fn smart_rider_at_4_3_has_the_independent_roots() {
    let table = entry("smart_rider_at_4_3");
    let v = table.number("speed");
    let mean_acceleration = gain(&table, "mean", "K_phi_dd");
    let swapped =
        |key: &str| if key == "K_phi_dd" { mean_acceleration } else { gain(&table, "regression", key) };
    for (key, rider, oscillates) in [
        ("regression_root", smart("regression"), true),
        ("mean_root", smart("mean"), false),
        ("swapped_root", rider(swapped, table.number("delay_s")), false),
    ] {
        let root = rightmost(&with_rider(table.text("bicycle"), Law::None, rider).at(v));
        println!("{key}: {root:.4}, independently {}", table.number(key));
        assert!((root.re - table.number(key)).abs() < table.tolerance(), "{key}: {root}");
        assert_eq!(root.im != 0.0, oscillates);
    }
}

/// Situation: the undelayed rider by each gain schedule.
/// Action: search for stable speeds.
/// Must hold: one range, between the independent speeds; the regression's begins where the steer integral's gain
/// changes sign, a real root, and ends where an oscillation begins to grow.
#[test]
fn undelayed_riders_are_stable_between_the_independent_speeds() {
    let published = entry("undelayed_stable_ranges");
    for fit in Fit::THESIS {
        let rider = undelayed(fit);
        let found =
            stability(&with_rider(published.text("bicycle"), Law::None, rider.clone())).expect("roots");
        let printed: [f64; 2] = published.row(&format!("printed_{}", fit.name()));
        println!("{}: stable {:?}, printed {printed:?}", fit.name(), found.ranges);
        let Some(&(from, to)) = found.ranges.iter().find(|(from, to)| (*from..*to).contains(&5.0)) else {
            panic!("{found:?}")
        };
        let expected: [f64; 2] = published.row(fit.name());
        assert!((from - expected[0]).abs() < published.tolerance(), "{from}");
        assert!((to - expected[1]).abs() < published.tolerance(), "{to}");
        if fit == Fit::Regression {
            let steer_integral = |v: f64| rider.schedule.at(v).0[5];
            assert!(steer_integral(from - 1e-6) * steer_integral(from + 1e-6) < 0.0, "{from}");
            assert_eq!(
                [found.changes[0].crossing, found.changes[1].crossing],
                [Crossing::Real, Crossing::Pair]
            );
            assert!(found.changes[0].stable_above && !found.changes[1].stable_above);
        }
    }
}

/// Situation: bicycles and laws without a rider.
/// Action: compare the general search with the critical speeds.
/// Must hold: the same speeds to the bit; where there is one stable range it is from v_w to v_c.
#[test]
fn without_a_rider_the_stable_range_is_from_weave_to_capsize_speed() {
    let mut ranges = 0;
    for bicycle in all_shipped() {
        for law in [Law::None, Law::H { cut: false }, Law::Cl1] {
            let model = Model::new(&bicycle.parameters, Feedback::Law(law.clone()), None);
            let found = stability(&model).expect("roots");
            let critical = critical_speeds(model.linear(), &law);
            assert_eq!(found.critical, critical, "{}", bicycle.name);
            if let ([(from, to)], Some(v_w), Some(v_c)) = (&found.ranges[..], critical.v_w, critical.v_c) {
                let off = (from - v_w).abs().max((to - v_c).abs());
                assert!(off < 1e-9, "{} {law:?}: {from} to {to}, {v_w} to {v_c}", bicycle.name);
                ranges += 1;
            }
        }
    }
    assert!(ranges >= 40, "{ranges}");
}

/// Situation: the benchmark bicycle under the intuitive controller, its roll rate gain below 40 N m s/rad.
/// Action: search for stable speeds.
/// Must hold: stable from below the bicycle's own weave speed on, and capsize is stable at all speeds.
#[test]
fn the_intuitive_controller_stabilises_weave_and_capsize() {
    let p = shipped("benchmark").parameters;
    let v_max = 5.0;
    let controller = Intuitive { k_v: 39.0 / v_max, v_max, k_c: 10.0 };
    let feedback = Feedback::Intuitive(controller);
    assert!((0..100).all(|i| feedback.at(0.1 * f64::from(i)).roll_rate < 40.0));
    let model = Model::new(&p, feedback, None);
    let (found, alone) = (stability(&model).expect("roots"), critical_speeds(model.linear(), &Law::None));
    println!("{:?} instead of {alone:?}", found.ranges);
    let [(from, to)] = found.ranges[..] else { panic!("{found:?}") };
    assert!(from > 0.3 && from < 0.5 * alone.v_w.unwrap() && to == 20.0 && found.critical.v_c.is_none());
}

/// Situation: bicycles under laws, with balanced state matrices at which the QR iteration without exceptional shifts
/// stagnates, at a speed or at a part of the feedback.
/// Action: compute stability, modes and the roots at every speed.
/// Must hold: all are computed; four roots at every speed, each an eigenvalue.
#[test]
fn roots_are_found_where_the_qr_iteration_stagnates() {
    let with = |name: &str, law: Law, inertia_kg_m2: f64, change: &dyn Fn(&mut Parameters)| {
        let mut parameters = shipped(name).parameters;
        change(&mut parameters);
        let actuator = LinearActuator { inertia_kg_m2, ..LinearActuator::default() };
        Model::new(&parameters, Feedback::Law(law), None).with_actuator(actuator).expect("in range")
    };
    let speeds: Vec<f64> = (0..=1000).map(|i| 0.02 * f64::from(i)).collect();
    for model in [
        with("rigid_jason", Law::H { cut: false }, 0.0, &|p| p.w = 0.5322),
        with("pista_rider", Law::Cl2 { k: 1.0 }, 0.618, &|_| {}),
        with("yellow_rider", Law::Cl1, 0.618, &|p| p.lam = 0.5824),
    ] {
        assert!(stability(&model).is_some());
        assert_eq!(modes(&model, &speeds[..=500], 4).len(), 3);
        for v in &speeds {
            let system = model.at(*v);
            let found = roots(&system, 4);
            assert_eq!(found.len(), 4, "{v} m/s");
            assert!(found.iter().all(|root| residual(&system, *root) < 1e-6), "{v} m/s: {found:?}");
        }
    }
}

fn mode<'a>(modes: &'a [Mode], name: &str) -> &'a Mode {
    modes.iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no {name}"))
}

/// Situation: the benchmark bicycle and the thesis bicycle, without assist and under h and CL1.
/// Action: follow the modes from rest to 10 m/s.
/// Must hold: together they are all eigenvalues; at high speed weave is the pair, caster the most negative; from rest
/// to v_d weave is two growing real roots; caster stays left of capsize, and under CL1 they are a pair in between,
/// and each leaves on its side.
#[test]
fn modes_keep_their_identity_over_speed() {
    let speeds: Vec<f64> = (0..=200).map(|i| 0.05 * f64::from(i)).collect();
    for (name, law) in [
        ("benchmark", Law::None),
        ("rigid_jason", Law::None),
        ("rigid_jason", Law::H { cut: false }),
        ("rigid_jason", Law::Cl1),
    ] {
        let model = Model::new(&shipped(name).parameters, Feedback::Law(law.clone()), None);
        let v_d = critical_speeds(model.linear(), &law).v_d.unwrap();
        let found = modes(&model, &speeds, 4);
        let names: Vec<&str> = found.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["weave", "capsize", "caster"]);
        let (weave, capsize, caster) = (&found[0].roots, &found[1].roots[0], &found[2].roots[0]);
        let mut merged = 0;
        for (i, v) in speeds.iter().enumerate() {
            let mut all: Vec<C> = found.iter().flat_map(|m| &m.roots).map(|r| r[i].unwrap()).collect();
            all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
            assert_eq!(all, roots(&model.at(*v), 4), "{name} {law:?} at {v} m/s");
            let [a, b] = [weave[0][i].unwrap(), weave[1][i].unwrap()];
            assert_eq!(*v < v_d, a.im == 0.0 && b.im == 0.0, "{name} {law:?} at {v} m/s: {a} {b}");
            assert!(a.im == -b.im && (*v > v_d || (a.re > 0.0 && b.re > 0.0)));
            let (capsize, caster) = (capsize[i].unwrap(), caster[i].unwrap());
            merged += usize::from(capsize.im != 0.0);
            assert!(caster.re <= capsize.re && caster.re < 0.0, "{name} {law:?} at {v} m/s");
        }
        // From 0.525 to 1.153 m/s (published 0.5231 and 1.153).
        assert_eq!(merged, if law == Law::Cl1 { 13 } else { 0 }, "{name} {law:?}");
    }
}

/// Situation: a delayed rider.
/// Action: follow the modes in steps, and in others.
/// Must hold: each is a root at every speed, no root is two, and the steps have no effect.
#[test]
fn modes_of_a_delayed_rider_are_roots_whatever_the_steps() {
    let model = with_rider("rigid_jason", Law::H { cut: false }, smart("mean"));
    let speeds: Vec<f64> = (0..=20).map(|i| 0.5 * f64::from(i)).collect();
    let found = modes(&model, &speeds, 8);
    assert!(["weave", "capsize", "rider 1"].iter().all(|name| !mode(&found, name).roots.is_empty()));
    for (i, v) in speeds.iter().enumerate() {
        let system = model.at(*v);
        let here: Vec<C> = found.iter().flat_map(|m| &m.roots).filter_map(|r| r[i]).collect();
        assert!(here.len() >= 6, "{v} m/s: {here:?}");
        for (j, root) in here.iter().enumerate() {
            assert!(residual(&system, *root) < 1e-12, "{v} m/s: {root}");
            assert!(here[..j].iter().all(|other| (other - root).norm() > 1e-6), "{v} m/s: {here:?}");
        }
    }
    let coarse = modes(&model, &speeds[..1], 8);
    for mode in &coarse {
        let fine = found.iter().find(|m| m.name == mode.name).unwrap();
        for (a, b) in mode.roots.iter().zip(&fine.roots) {
            let apart = a[0].zip(b[0]).map_or(0.0, |(a, b)| (a - b).norm());
            assert!(apart < 1e-6, "{}: {apart}", mode.name);
        }
    }
}

/// Situation: every printed set of gains on the bicycle of the runs, at the speed of its run, with its table's delay.
/// Action: compute the rightmost root of the linear model.
/// Must hold: the numbers of stable sets, and the least and the most stable set, are those of docs/riders.md.
#[test]
fn printed_sets_are_as_stable_as_documented() {
    let page = std::fs::read_to_string(repository("docs/riders.md")).expect("the page");
    let bicycle = shipped("rigid_jason").parameters;
    let names = ["young", "smart", "smart6", "undelayed", "undelayed-alt"];
    let reductions = ["young-reduction", "smart-reduction", "undelayed-reduction"];
    let mut missing = 0;
    for name in names.into_iter().chain(reductions) {
        let table = catalogue::load(name).expect("shipped");
        let growth = |row: &Row| {
            let rider = Rider {
                schedule: Schedule::constant(row.gains),
                delay_s: table.delay_s,
                neuromuscular: table.neuromuscular,
            };
            rightmost(&Model::new(&bicycle, Feedback::Law(Law::None), Some(rider)).at(row.speed_m_s)).re
        };
        let signed = |growth: f64| format!("{:+.2}", (100.0 * growth).round() / 100.0 + 0.0);
        let growths: Vec<f64> = table.rows.iter().map(growth).collect();
        if name == "smart" {
            // A negative gain of the steer integral, and nothing else, makes these sets drift.
            let drifts = table.rows.iter().zip(&growths).map(|(r, g)| (*g > NEUTRAL_1_S, r.gains.0[5] < 0.0));
            assert!(drifts.clone().all(|(grows, negative)| grows == negative));
        }
        let stable = growths.iter().filter(|growth| **growth <= NEUTRAL_1_S).count();
        let good = table.rows.iter().zip(&growths).filter(|(row, _)| row.vaf.is_some_and(|vaf| vaf >= 90.0));
        let (good, unstable) =
            good.fold((0, 0), |(n, bad), (_, g)| (n + 1, bad + usize::from(*g > NEUTRAL_1_S)));
        let (low, high) = growths.iter().fold((f64::MAX, f64::MIN), |(a, b), g| (a.min(*g), b.max(*g)));
        let line = format!(
            "| `{name}` | {} | {stable} | {good} | {unstable} | {} to {} |",
            growths.len(),
            signed(low),
            signed(high)
        );
        println!("{line}");
        missing += usize::from(!page.contains(&line));
    }
    assert_eq!(missing, 0, "docs/riders.md should have the lines above");
}
