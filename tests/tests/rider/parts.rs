//! The parts of a rider compared with closed forms.

use sim_host::bicycle::{Geometry, Motion, State};
use sim_host::integrate::{STAGES, Stages};
use sim_host::rider::{DelayLine, Instant, Neuromuscular, RiderState, SignalHistory};
use tests::rides::shipped;

/// Situation: neuromuscular dynamics at rest, the neural signal jumps to 1 N m.
/// Action: integrate for a second in steps of 0.1 ms.
/// Must hold: torque and rate are the closed step response to 1e-12.
#[test]
fn step_response_of_the_neuromuscular_dynamics() {
    let b = Geometry::new(&shipped("rigid_jason").parameters);
    let state = State::upright(&b, 5.0);
    let motion = Motion::new(&b, &state);
    let now =
        Instant { angles: [0.0; 2], accelerations: [0.0; 2], pose: &motion.pose, velocities: &motion.actual };
    for dynamics in [Neuromuscular::SHOULDERS, Neuromuscular { omega_rad_s: 30.0, zeta: 0.707 }] {
        let Neuromuscular { omega_rad_s: w, zeta } = dynamics;
        let damped = w * (1.0 - zeta * zeta).sqrt();
        let h = 1e-4;
        let mut body = RiderState::<f64>::fresh();
        let (mut largest, mut overshoot) = (0.0_f64, 0.0_f64);
        for n in 0..10_000 {
            let t = f64::from(n) * h;
            let (sin, cos) = (damped * t).sin_cos();
            let fade = (-zeta * w * t).exp();
            let torque = 1.0 - fade * (cos + zeta * w / damped * sin);
            let rate = fade * w * w / damped * sin;
            largest = largest.max((body.torque - torque).abs()).max((body.torque_rate - rate).abs() / w);
            overshoot = overshoot.max(body.torque - 1.0);
            let mut stages = Stages::new(body);
            for stage in 0..STAGES.len() {
                let k = stages.at.rate(&b, &now, &dynamics, 1.0);
                stages.next(stage, h, &k);
            }
            body = stages.end;
        }
        println!("{dynamics:?}: largest error {largest:e}, overshoot {overshoot:.6}");
        assert!((1e-16..1e-12).contains(&largest), "{largest:e}");
        let closed = (-std::f64::consts::PI * zeta / (1.0 - zeta * zeta).sqrt()).exp();
        assert!((overshoot - closed).abs() < 1e-5, "{overshoot} {closed}");
    }
}

/// Situation: a sine sampled every millisecond.
/// Action: delay it by 30, 60 or 7 steps.
/// Must hold: at whole steps the sine to the bit, between them to 1e-12, and zero before.
#[test]
fn pure_delay() {
    let sine = |n: f64| (2e-3 * n).sin();
    for delay in [7_usize, 30, 60] {
        let mut delay_line = DelayLine::new(delay);
        let mut largest = 0.0_f64;
        for n in 0..3000 {
            delay_line.push(sine(n as f64));
            let [start, middle, end] = delay_line.arriving();
            let then = n as f64 - delay as f64;
            if then < 0.0 {
                assert_eq!([start, middle, end], [0.0; 3]);
            } else {
                assert_eq!([start, end], [sine(then), sine(then + 1.0)]);
                largest = largest.max((middle - sine(then + 0.5)).abs());
            }
        }
        // The cubic's remainder, 3/128 of the fourth difference inside, 5/128 at the ends: 6e-13.
        println!("{delay} steps: largest error {largest:e}");
        assert!((1e-15..1e-12).contains(&largest), "{largest:e}");
    }
}

/// Situation: the same at ever smaller steps.
/// Action: compute the error between whole steps.
/// Must hold: it falls with the fourth power.
#[test]
fn the_delay_line_is_of_fourth_order() {
    let error = |per_second: usize| {
        let h = 1.0 / per_second as f64;
        let mut delay_line = DelayLine::new(per_second * 6 / 100);
        let mut largest = 0.0_f64;
        for n in 0..per_second {
            delay_line.push((20.0 * n as f64 * h).cos());
            let t = (n as f64 + 0.5) * h - 0.06;
            if t > 0.0 {
                largest = largest.max((delay_line.arriving()[1] - (20.0 * t).cos()).abs());
            }
        }
        largest
    };
    let errors = [100, 200, 400].map(error);
    let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
    println!("errors {errors:?}, orders {orders:.3?}");
    assert!(orders.iter().all(|o| (3.8..4.2).contains(o)), "{orders:?}");
}

/// Situation: a neural delay in steps of irregular lengths; the signal is one cubic up to the delay and another after it.
/// Action: ask for the signals that arrive in each step.
/// Must hold: nothing before the delay, then either cubic to rounding, also beside the kink between them; a step never
/// passes the first two multiples of the delay, nor is longer than it.
#[test]
fn signals_of_irregular_steps_arrive_unchanged() {
    const DELAY_S: f64 = 0.03;
    let sent = |t: f64| {
        let after = (t - DELAY_S).max(0.0);
        1.0 + 40.0 * t - 900.0 * t * t + 7000.0 * t * t * t - 5000.0 * after * after
    };
    let mut history = SignalHistory::new(DELAY_S);
    let (mut t, mut arrivals, mut ends) = (0.0, 0, Vec::new());
    for step in 0..120 {
        history.push(t, sent(t));
        let longest_s = history.longest_step_s(t);
        let h = longest_s.min([0.02, 0.004, 0.0007, 0.011][step % 4]);
        for (part, arrived) in [0.0, 0.5, 1.0].into_iter().zip(history.arriving(t, h)) {
            let when = t + part * h - DELAY_S;
            if t < DELAY_S - 1e-9 {
                assert_eq!(arrived, 0.0, "at {t} s");
            } else {
                arrivals += 1;
                let error = (arrived - sent(when)).abs();
                assert!(error < 1e-9 * sent(when).abs().max(1.0), "at {t} s: {arrived}, {}", sent(when));
            }
        }
        assert!(longest_s <= DELAY_S * (1.0 + 1e-9));
        t += h;
        ends.push(t);
    }
    assert!(arrivals > 300, "{arrivals}");
    for kink in [DELAY_S, 2.0 * DELAY_S] {
        assert!(ends.iter().any(|end| (end - kink).abs() < 1e-9), "no step ends at {kink} s");
    }
}

/// Situation: a delay of 2.5 ms, of which the first signal arrives after 2 ms, in steps of up to 20 ms that end at its kinks; the
/// signal is a cubic. Action: ask for what arrives within a step, with the signal at its end.
/// Must hold: the cubic to rounding once four signals are known, and no kink after the sum of the two times.
#[test]
fn signals_arrive_within_steps_longer_than_the_delay() {
    const DELAY_S: f64 = 2.5e-3;
    let sent = |t: f64| 1.0 + 40.0 * t - 900.0 * t * t + 7000.0 * t * t * t;
    let mut history = SignalHistory::arriving_from(2e-3, DELAY_S);
    let (mut t, mut within) = (0.0, 0);
    for step in 0..60 {
        history.push(t, sent(t));
        let kink_s = history.kink_s(t);
        assert_eq!(kink_s.is_finite(), t < 2e-3 + DELAY_S - 1e-9, "{kink_s} s from {t} s");
        let h = kink_s.min([0.02, 0.004, 0.0007, 0.011][step % 4]);
        for part in [0.25, 0.5, 1.0].into_iter().filter(|part| step > 5 && part * h > DELAY_S) {
            let arrived = history.arriving_before((t + h, sent(t + h)), t, part * h);
            let wanted = sent(t + part * h - DELAY_S);
            assert!(
                (arrived - wanted).abs() < 1e-9 * wanted.abs().max(1.0),
                "{arrived} for {wanted} at {t} s"
            );
            within += 1;
        }
        t += h;
    }
    assert!(within > 80, "{within}");
}
