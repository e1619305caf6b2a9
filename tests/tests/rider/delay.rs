//! A delayed rider's ride compared with an independent solver of delay differential equations on the other
//! formulation of the bicycle; order of convergence; meaning of the delay.

use control::Law;
use differential_equations::prelude::*;
use newton_euler::{self, Solution};
use sim_host::bicycle::{Parameters, State, Torques};
use sim_host::ride::{Assist, Conditions, Start, TracePoint, traced};
use sim_host::rider::{Gains, Neuromuscular, Outside, Rider, Schedule};
use tests::basins::{H, alone, ideal};
use tests::riders::thorough;
use tests::rides::shipped;

const START: Start = Start { speed_m_s: 4.4, steer_rate_rad_s: 2.5, roll_rate_rad_s: 0.1 };

fn ridden(assist: &Conditions, rider: Rider, step_s: f64, seconds: f64) -> Vec<TracePoint> {
    let conditions = Conditions { rider: Some(rider), step_s, time_limit_s: seconds, ..assist.clone() };
    conditions.check().expect("in range");
    let (ride, trace) = traced(&conditions, START);
    assert!(!ride.fell(), "{ride:?}");
    trace
}

/// Newton's and Euler's equations, a law and a rider, with the rider's delay. The state: roll, steer, roll rate,
/// steer rate, rear wheel rate, integrals of roll and steer, heading, lateral position of the rear axle,
/// neuromuscular torque and its rate. NaN before t = 0.
struct Reference {
    parameters: Parameters,
    law: Law,
    rider: Rider,
}

type Entries = [f64; 11];

impl Reference {
    /// All quantities of the bicycle in a state, and its front wheel's speed.
    fn instant(&self, y: &Entries) -> (Solution, f64) {
        let state = State {
            roll: y[0],
            steer: y[1],
            roll_rate: y[2],
            steer_rate: y[3],
            rear_wheel_rate: y[4],
            pitch: f64::NAN,
        };
        let p = &self.parameters;
        let speed = |s: &Solution| -p.rF * s.front_wheel_rate;
        // The speed does not depend on the torque, so the first solution needs none.
        let free = newton_euler::solve(p, &state, &Torques { roll: 0.0, steer: 0.0 });
        let v = speed(&free.expect("wheels on the ground"));
        let torque = self.law.gain(v) * y[2] + y[9];
        let solution = newton_euler::solve(p, &state, &Torques { roll: 0.0, steer: torque });
        (solution.expect("wheels on the ground"), v)
    }

    /// The neural signal of a state.
    fn neural_signal(&self, y: &Entries) -> f64 {
        if y[0].is_nan() {
            return 0.0;
        }
        let (s, v) = self.instant(y);
        let (sin, cos) = y[7].sin_cos();
        let to_front = s.front_contact_place - s.rear_axle;
        let front = y[8] + sin * to_front.x + cos * to_front.y;
        let (roll_acc, steer_acc) = (s.roll_acceleration, s.steer_acceleration);
        let signals = [y[0], y[5], y[2], roll_acc, y[1], y[6], y[3], steer_acc, y[7], front];
        let Gains(gains) = self.rider.schedule.at(v);
        gains.iter().zip(signals).map(|(k, x)| k * x).sum()
    }

    fn rate(&self, y: &Entries, alpha: f64) -> Entries {
        let (s, _) = self.instant(y);
        let (sin, cos) = y[7].sin_cos();
        let sideways = sin * s.rear_axle_velocity.x + cos * s.rear_axle_velocity.y;
        let Neuromuscular { omega_rad_s: w, zeta } = self.rider.neuromuscular;
        let (roll_acc, steer_acc, wheel_acc) =
            (s.roll_acceleration, s.steer_acceleration, s.rear_wheel_acceleration);
        let muscle = w * w * (alpha - y[9]) - 2.0 * zeta * w * y[10];
        [y[2], y[3], roll_acc, steer_acc, wheel_acc, y[0], y[1], s.yaw_rate, sideways, y[10], muscle]
    }
}

impl DDE<1, f64, Entries> for Reference {
    fn diff(&self, _: f64, y: &Entries, delayed: &[Entries; 1], rate: &mut Entries) {
        *rate = self.rate(y, self.neural_signal(&delayed[0]));
    }
    fn lags(&self, _: f64, _: &Entries, lags: &mut [f64; 1]) {
        lags[0] = self.rider.delay_s;
    }
}

/// Roll, steer, their rates, rear wheel rate and the rider's torque at whole multiples of 50 ms.
fn reference(law: Law, rider: Rider, seconds: f64) -> Vec<[f64; 6]> {
    let parameters = shipped("rigid_jason").parameters;
    let start = [
        0.0,
        0.0,
        START.roll_rate_rad_s,
        START.steer_rate_rad_s,
        -START.speed_m_s / parameters.rR,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ];
    let delay = rider.delay_s;
    let reference = Reference { parameters, law, rider };
    // Steps of a small part of the delay, so that few of them contain the kinks at its multiples.
    let method =
        ExplicitRungeKutta::dopri5().rtol(1e-10).atol(1e-10).h_max(delay / 20.0).max_delay(2.0 * delay);
    let before = |_: f64| [f64::NAN; 11];
    let problem = IVP::dde(&reference, 0.0, seconds, start, before).even(0.05).method(method);
    let solution = problem.solve().expect("a solution");
    solution.y.iter().map(|y| [y[0], y[1], y[2], y[3], y[4], y[9]]).collect()
}

fn entries(p: &TracePoint) -> [f64; 6] {
    [p.roll, p.steer, p.roll_rate, p.steer_rate, p.rear_wheel_rate, p.rider_torque]
}

fn compare(assist: &Conditions, law: Law, delay_s: f64) {
    let seconds = 1.5;
    let expected = reference(law, thorough(delay_s), seconds);
    let trace = ridden(assist, thorough(delay_s), 1e-3, seconds + 2e-3);
    let got: Vec<_> = trace.iter().step_by(50).map(entries).collect();
    assert_eq!(got.len(), expected.len());
    let mut largest = [0.0_f64; 6];
    for (a, b) in got.iter().zip(&expected) {
        for (l, (x, y)) in largest.iter_mut().zip(a.iter().zip(b)) {
            *l = l.max((x - y).abs());
        }
    }
    println!("delay {delay_s} s: largest differences {largest:?}");
    let peak = got.iter().map(|e| e[5].abs()).fold(0.0, f64::max);
    assert!(peak > 1.5, "the rider worked: {peak} N m");
    assert!(largest.iter().all(|&d| (1e-13..2e-6).contains(&d)), "{largest:?}");
}

/// Situation: all ten gains, scheduled by front wheel speed, 60 ms late, no assist.
/// Action: ride 1.5 s.
/// Must hold: the ride is that of a library's solver for delay equations on Newton's and Euler's.
#[test]
fn a_delayed_ride_is_the_other_solvers() {
    compare(&alone(), Law::None, 0.06);
}

/// Situation: the same rider 30 ms late beside the continuous law h.
/// Action: ride.
/// Must hold: the same; rider and assist act in parallel.
#[test]
fn rider_and_assist_push_in_parallel() {
    compare(&ideal(H), H, 0.03);
}

/// Situation: one ride at several steps, the gains on one line over speed (where lines meet, the signal has a kink
/// that the speed may pass inside a step).
/// Action: compare with a step four times as fine.
/// Must hold: the order is four.
#[test]
fn the_order_is_four() {
    for (name, assist, delay) in
        [("60 ms, alone", alone(), 0.06), ("60 ms, h", ideal(H), 0.06), ("none", alone(), 0.0)]
    {
        let points: Vec<_> = thorough(delay).schedule.points()[..2].to_vec();
        let schedule = Schedule::new(points, Outside::Extrapolate).expect("two points");
        let rider = Rider { schedule, ..thorough(delay) };
        let end = |step: f64| {
            let trace = ridden(&assist, rider.clone(), step, 1.6);
            entries(&trace[(1.5 / step).round() as usize])
        };
        let finest = end(2.5e-4);
        let errors = [4e-3, 2e-3, 1e-3]
            .map(|step| end(step).iter().zip(finest).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
        let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
        println!("{name}: errors {errors:?} at 4, 2, 1 ms, orders {orders:.3?}");
        assert!((1e-11..1e-6).contains(&errors[2]), "{errors:?}");
        assert!(orders.iter().all(|o| (3.7..4.4).contains(o)), "{orders:?}");
    }
}

/// Situation: a knock at t = 0, a rider with 60 ms delay.
/// Action: record the rider's torque.
/// Must hold: exactly zero until 60 ms have passed, then the beginning of the neuromuscular response to the jump.
#[test]
fn the_torque_is_zero_before_the_delay() {
    let trace = ridden(&alone(), thorough(0.06), 1e-3, 0.2);
    assert!(trace[..=60].iter().all(|p| p.rider_torque == 0.0));
    // The signal at t = 0 arrives at 60 ms; from there T = alpha (omega t)^2 / 2 at first.
    let free = ridden(&alone(), thorough(0.0), 1e-3, 0.2);
    let early = trace[62].rider_torque / free[2].rider_torque;
    assert!((0.8..1.2).contains(&early), "{early}");
}

/// Situation: a rider whose gains are all zero.
/// Action: ride.
/// Must hold: the bits of no rider.
#[test]
fn a_rider_without_gains_is_no_rider() {
    let numb = Rider {
        schedule: Schedule::constant(Gains::default()),
        delay_s: 0.03,
        neuromuscular: Neuromuscular::SHOULDERS,
    };
    let with = ridden(&ideal(H), numb, 1e-3, 1.0);
    let (_, without) = traced(&Conditions { time_limit_s: 1.0, ..ideal(H) }, START);
    assert_eq!(with, without);
}

/// Situation: eight riders in the lanes, ended and followed by others.
/// Action: ride each alone too.
/// Must hold: every bit agrees, falls near singular states included.
#[test]
fn a_ride_has_the_same_bits_in_any_lane() {
    for delay in [0.0, 0.06] {
        for assist in [alone(), ideal(H)] {
            let conditions = Conditions { rider: Some(thorough(delay)), time_limit_s: 3.0, ..assist };
            let start = |i: u32| Start {
                speed_m_s: 3.0 + 0.1 * f64::from(i),
                steer_rate_rad_s: 0.9 * f64::from(i),
                roll_rate_rad_s: 0.0,
            };
            let starts: Vec<_> = (1..=20).map(start).collect();
            let batch = sim_host::ride::rides(&conditions, &starts);
            assert!(batch.iter().any(sim_host::ride::Ride::fell) && !batch[0].fell());
            for (together, start) in batch.iter().zip(&starts) {
                assert_eq!(*together, traced(&conditions, *start).0);
            }
        }
    }
}

/// Situation: the assist as flashed and as the continuous law, beside the same rider.
/// Action: ride.
/// Must hold: the rides are close, but not the same.
#[test]
fn the_flashed_assist_beside_a_rider() {
    let flashed = ridden(&tests::basins::assisted(H), thorough(0.06), 1e-3, 1.5);
    let continuous = ridden(&ideal(H), thorough(0.06), 1e-3, 1.5);
    assert!(matches!(tests::basins::assisted(H).assist, Assist::Firmware(_)));
    let apart = flashed.iter().zip(&continuous).map(|(a, b)| (a.roll - b.roll).abs()).fold(0.0, f64::max);
    println!("roll differs by up to {apart:.1e} rad");
    assert!((1e-7..2e-3).contains(&apart), "{apart}");
}
