//! Small rides of riders compared with the linear analysis: closed loops without delay with the matrix exponential,
//! growth rates with delay with characteristic roots.

use control::Law;
use nalgebra::{Complex, DMatrix, DVector};
use sim_host::eigen::{Feedback, Model, rightmost};
use sim_host::exponential::exponential;
use sim_host::ride::{Assist, Conditions, Start, TracePoint, traced};
use sim_host::rider::{Fit, Outside, Rider, Schedule, catalogue};
use tests::basins::{H, alone};
use tests::riders::thorough;
use tests::rides::shipped;

/// A shipped rider with the gains of one speed at all speeds.
fn constant(name: &str, fit: Fit, speed: f64) -> Rider {
    let table = catalogue::load(name).unwrap_or_else(|e| panic!("{e}"));
    let rider = table.rider(fit, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"));
    Rider { schedule: Schedule::constant(rider.schedule.at(speed)), ..rider }
}

fn model(law: Law, rider: &Rider) -> Model {
    Model::new(&shipped("rigid_jason").parameters, Feedback::Law(law), Some(rider.clone()))
}

/// A ride after a steer rate so small that the bicycle is linear.
fn small(law: &Law, rider: &Rider, speed: f64, seconds: f64) -> Vec<TracePoint> {
    let assist = if *law == Law::None { Assist::None } else { Assist::Ideal(Box::new(law.clone().into())) };
    let conditions = Conditions { assist, rider: Some(rider.clone()), time_limit_s: seconds, ..alone() };
    let start = Start { speed_m_s: speed, steer_rate_rad_s: SMALL, roll_rate_rad_s: 0.0 };
    let (ride, trace) = traced(&conditions, start);
    assert!(!ride.fell());
    trace
}

const SMALL: f64 = 1e-6;

/// Situation: riders without delay, one with all ten gains, with and without the law h.
/// Action: ride 2 s after a tiny knock.
/// Must hold: roll, steer, their rates and the rider's torque are those of the matrix exponential of the linear
/// closed loop.
#[test]
fn undelayed_closed_loops_are_their_matrix_exponentials() {
    let everything = Rider { schedule: Schedule::constant(thorough(0.0).schedule.at(4.0)), ..thorough(0.0) };
    for (name, rider) in [("undelayed", constant("undelayed", Fit::Mean, 4.0)), ("all gains", everything)] {
        for law in [Law::None, H] {
            let system = model(law.clone(), &rider).at(4.0);
            let trace = small(&law, &rider, 4.0, 2.1);
            let matrix: DMatrix<f64> = system.undelayed();
            let n = matrix.nrows();
            let mut start = DVector::zeros(n);
            start[3] = SMALL;
            for i in [100, 500, 1000, 2000] {
                let expected = exponential(&(&matrix * (1e-3 * i as f64))) * &start;
                let p = &trace[i];
                let got = [p.roll, p.steer, p.roll_rate, p.steer_rate, p.rider_torque];
                let expected = [expected[0], expected[1], expected[2], expected[3], expected[n - 2]];
                let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                let off = got.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
                println!("{name}, {law:?}, {} s: off by {off:.1e}", 1e-3 * i as f64);
                assert!((1e-16..1e-7).contains(&off), "{name} {law:?} {i}: {got:?} {expected:?}");
            }
        }
    }
}

/// The root with the largest real part in a signal from `from` to `to` \[s\]: a linear recurrence of `order` through
/// points 40 ms apart, by least squares (Prony).
fn dominant_root(trace: &[TracePoint], (from, to): (f64, f64), order: usize) -> Complex<f64> {
    let gap = 40;
    let at = |i: usize| trace[i].steer;
    let rows: Vec<usize> = ((from * 1e3) as usize..(to * 1e3) as usize - gap * order).step_by(7).collect();
    let a = DMatrix::from_fn(rows.len(), order, |i, j| at(rows[i] + gap * j));
    let b = DVector::from_fn(rows.len(), |i, _| at(rows[i] + gap * order));
    let c = a.svd(true, true).solve(&b, 1e-14).expect("least squares");
    // Roots of the recurrence: eigenvalues of its companion matrix.
    let companion = DMatrix::from_fn(order, order, |i, j| {
        if i + 1 == order {
            c[j]
        } else if j == i + 1 {
            1.0
        } else {
            0.0
        }
    });
    let step = gap as f64 * 1e-3;
    let roots = companion.complex_eigenvalues();
    let logs = roots.iter().map(|z| z.ln() / step).filter(|s| s.im >= 0.0);
    logs.max_by(|a, b| a.re.total_cmp(&b.re)).expect("roots")
}

/// Situation: delayed riders, growing and decaying, with and without assist.
/// Action: ride after a tiny knock, take the growth rate from the ride's later part.
/// Must hold: it is the rightmost characteristic root to 1e-4 1/s, frequency included.
#[test]
fn growth_rates_of_small_rides_are_characteristic_roots() {
    let cases = [
        ("smart", Fit::Regression, 4.3, None, Law::None),
        ("smart", Fit::Mean, 4.3, None, Law::None),
        ("young", Fit::Mean, 4.0, None, Law::None),
        ("young", Fit::Mean, 4.0, Some(0.05), Law::None),
        ("young", Fit::Mean, 3.0, Some(0.06), Law::None),
        ("smart", Fit::Best, 3.2, None, H),
        ("smart6", Fit::Mean, 6.1, Some(0.1), Law::None),
    ];
    let mut signs = [false; 2];
    for (name, fit, speed, delay, law) in cases {
        let rider = constant(name, fit, speed);
        let rider = Rider { delay_s: delay.unwrap_or(rider.delay_s), ..rider };
        let root = rightmost(&model(law.clone(), &rider).at(speed));
        let trace = small(&law, &rider, speed, 7.1);
        let got = dominant_root(&trace, (1.0, 7.0), 8);
        println!("{name} {} {speed} m/s {law:?}: ride {got:.6}, root {root:.6}", fit.name());
        assert!((got.re - root.re).abs() < 1e-4, "{name} {speed}: {got} {root}");
        assert!((got.im - root.im.abs()).abs() < 1e-4, "{name} {speed}: {got} {root}");
        signs[usize::from(root.re > 0.0)] = true;
    }
    assert_eq!(signs, [true; 2], "growing and decaying ones");
}

/// Situation: the smart rider's regression, constant as at 4.3 m/s, whose root grows.
/// Action: ride 15 s after 0.5 rad/s.
/// Must hold: the ride ends in a limit cycle of some degrees and does not fall; with the gains over speed it falls
/// within 6 s.
#[test]
fn the_regression_at_4_3_is_a_limit_cycle_until_its_gains_follow_the_speed() {
    let frozen = constant("smart", Fit::Regression, 4.3);
    let start = Start { speed_m_s: 4.3, steer_rate_rad_s: 0.5, roll_rate_rad_s: 0.0 };
    let long = Conditions { rider: Some(frozen), time_limit_s: 30.0, ..alone() };
    let (ride, trace) = traced(&long, start);
    let late = trace[25_000..].iter().map(|p| p.roll.abs()).fold(0.0, f64::max).to_degrees();
    println!("{:?}, roll up to {late:.2} deg in the last 5 s", ride.outcome);
    assert!(!ride.fell() && (2.0..20.0).contains(&late), "{late}");
    let table = catalogue::load("smart").unwrap_or_else(|e| panic!("{e}"));
    let following =
        table.rider(Fit::Regression, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"));
    let (ride, _) = traced(&Conditions { rider: Some(following), ..alone() }, start);
    assert!(ride.fell(), "{:?}", ride.outcome);
}
