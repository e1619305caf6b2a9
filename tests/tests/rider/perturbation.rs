//! Perturbation records: the pushed ride against the linear model and its energy, pulses, noise, and the shipped riders.

use nalgebra::{DMatrix, DVector};
use sim_host::bicycle::linear::Linear;
use sim_host::bicycle::{ForcePoint, Motion, State};
use sim_host::eigen::{Feedback, Model};
use sim_host::exponential::exponential;
use sim_host::perturbation::{
    Drift, Experiment, PerturbationError, Record, RecordSample, Remnant, SensorNoise, record,
};
use sim_host::ride::{Conditions, MotionSample, Perturbed, Push, perturbed};
use sim_host::rider::{Fit, Outside, Rider, Schedule, catalogue};
use tests::basins::alone;
use tests::riders::thorough;
use tests::rides::shipped;

const POINT: ForcePoint = ForcePoint { ahead_m: 0.4, height_m: 0.8 };
const SAMPLE_S: f64 = 5e-3;

/// The thesis bicycle with a shipped rider.
fn ridden(name: &str) -> Conditions {
    let table = catalogue::load(name).unwrap_or_else(|e| panic!("{e}"));
    let rider = table.rider(Fit::Mean, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"));
    Conditions { rider: Some(rider), ..alone() }
}

fn made(conditions: &Conditions, experiment: &Experiment) -> Record {
    record(conditions, experiment).and_then(Record::upright).unwrap_or_else(|e| panic!("{e}"))
}

/// Pushes of force (`size` N) and torque (a tenth of it in N m) that change sides every 37 and 23 times `length` samples.
fn pushes(size: f64, length: usize, speed_m_s: f64, n: usize) -> Vec<Push> {
    let side = |i: usize, every: usize| if (i / (every * length)).is_multiple_of(2) { 1.0 } else { -1.0 };
    let push = |i| Push {
        lateral_force_n: size * side(i, 37),
        steer_torque_nm: 0.1 * size * side(i, 23),
        speed_m_s,
    };
    (0..n).map(push).collect()
}

/// Situation: a rider without delay who uses every gain, also those of accelerations; pushes so small that the bicycle is
/// linear, each held over a sample. Action: ride 2 s. Must hold: roll, steer, their rates and the rider's torque are those
/// of the linear closed loop with the linear input, by matrix exponentials from sample to sample.
#[test]
fn a_small_pushed_ride_is_the_linear_closed_loop() {
    let gains = thorough(0.0).schedule.at(4.0);
    let rider = Rider { schedule: Schedule::constant(gains), ..thorough(0.0) };
    let p = shipped("rigid_jason").parameters;
    let conditions = Conditions { rider: Some(rider.clone()), ..alone() };
    let how = Perturbed { point: POINT, steps_per_sample: 5, speed_hold_s: Some(1.0) };
    let pushes = pushes(1e-6, 1, 4.0, 401);
    let ride = perturbed(&conditions, &how, 4.0, &pushes);
    assert!(ride.fall.is_none() && ride.samples.len() == 401);

    let matrix: DMatrix<f64> =
        Model::new(&p, Feedback::Law(control::Law::None), Some(rider.clone())).at(4.0).undelayed();
    let (n, linear) = (matrix.nrows(), Linear::new(&p));
    let inverse = linear.m.try_inverse().expect("a regular mass matrix");
    // Accelerations by the push; through the gains of accelerations they reach the rider's torque at once.
    let input = |push: &Push| {
        let [roll, steer] = linear.lateral_force_input(POINT);
        let force = nalgebra::Vector2::new(roll, steer) * push.lateral_force_n;
        let by = inverse * (force + nalgebra::Vector2::new(0.0, push.steer_torque_nm));
        let mut input = DVector::zeros(n);
        (input[2], input[3]) = (by[0], by[1]);
        let omega = rider.neuromuscular.omega_rad_s;
        input[n - 1] = omega * omega * (gains.0[3] * by[0] + gains.0[7] * by[1]);
        input
    };
    let (mut x, mut worst) = (DVector::<f64>::zeros(n), 0.0_f64);
    for (i, (sample, push)) in ride.samples.iter().zip(&pushes).enumerate() {
        let got = [
            sample.roll_rad,
            sample.steer_rad,
            sample.roll_rate_rad_s,
            sample.steer_rate_rad_s,
            sample.rider_torque_nm,
        ];
        let expected = [x[0], x[1], x[2], x[3], x[n - 2]];
        let size = expected.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        if i >= 20 {
            let off = got.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
            worst = worst.max(off);
            assert!(off < 1e-6, "sample {i}: {got:?} {expected:?}");
        }
        let mut block = DMatrix::zeros(n + 1, n + 1);
        block.view_mut((0, 0), (n, n)).copy_from(&matrix);
        block.view_mut((0, n), (n, 1)).copy_from(&input(push));
        let step = exponential(&(block * SAMPLE_S));
        x = step.view((0, 0), (n, n)) * &x + step.view((0, n), (n, 1));
    }
    println!("a pushed ride is off the linear closed loop by {worst:.1e}");
    assert!(worst > 1e-14, "two independent computations do not agree to the last bit");
}

/// Situation: no rider, no held speed, pushes of 40 N and 4 N m at 7 m/s, where the bicycle is stable. Action: ride 10 s, a
/// sample per step. Must hold: kinetic and potential energy change by the work of force and torque.
#[test]
fn energy_changes_by_the_work_of_the_pushes() {
    let conditions = alone();
    let (b, h) = (&conditions.bicycle, conditions.step_s);
    let how = Perturbed { point: POINT, steps_per_sample: 1, speed_hold_s: None };
    let pushes = pushes(40.0, 10, 0.0, 10_000);
    let ride = perturbed(&conditions, &how, 7.0, &pushes);
    assert!(ride.fall.is_none());
    let motion = |sample: &MotionSample| {
        let state = State {
            roll: sample.roll_rad,
            steer: sample.steer_rad,
            roll_rate: sample.roll_rate_rad_s,
            steer_rate: sample.steer_rate_rad_s,
            rear_wheel_rate: -sample.speed_m_s / b.rR,
            pitch: 0.0,
        };
        (Motion::new(b, &state), state)
    };
    let energy = |sample| {
        let (motion, state) = motion(sample);
        motion.energy(b, &state)
    };
    let velocity = |sample| motion(sample).0.lateral_velocity(b, POINT);
    let mut work = [0.0_f64; 2];
    let (mut peak, mut largest, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
    let first = energy(&ride.samples[0]);
    for (pair, push) in ride.samples.windows(2).zip(&pushes) {
        work[0] += push.lateral_force_n * 0.5 * h * (velocity(&pair[0]) + velocity(&pair[1]));
        work[1] += push.steer_torque_nm * (pair[1].steer_rad - pair[0].steer_rad);
        let change = energy(&pair[1]) - first;
        peak = peak.max(pair[1].roll_rad.abs());
        largest = largest.max(change.abs());
        worst = worst.max((change - work[0] - work[1]).abs());
    }
    println!(
        "work {work:.3?} J, energy changes by up to {largest:.3} J, off by {worst:.1e} J, roll to {peak:.3} rad"
    );
    assert!(worst < 1e-5 * largest && largest > 5.0 && work[0].abs() > 1.0 && work[1].abs() > 0.1);
    assert!((0.02..0.5).contains(&peak));
}

/// Situation: the shipped riders of state feedback from 2 to 7 m/s, Hess's from 4 m/s. Action: the default experiment with
/// two seeds. Must hold: none falls; each answers, and holds the speed.
#[test]
fn the_shipped_riders_stay_upright_under_the_default_pulses() {
    for (name, speeds) in [
        ("young", &[2.1, 4.0, 7.0][..]),
        ("smart", &[2.1, 4.0, 7.0]),
        ("smart6", &[2.1, 4.0, 7.0]),
        ("undelayed", &[2.1, 4.0, 7.0]),
        ("undelayed-alt", &[2.1, 4.0, 7.0]),
        ("hess", &[4.0, 5.0, 7.0]),
    ] {
        for (&speed, seed) in speeds.iter().zip([0, 1, 2]) {
            let all = made(&ridden(name), &Experiment { seed, ..Experiment::at(speed) });
            let peak = |of: fn(&RecordSample) -> f64| {
                all.samples.iter().map(of).fold(0.0, |a: f64, b| a.max(b.abs()))
            };
            let (roll, steer) = (peak(|s| s.roll_rad), peak(|s| s.steer_rad));
            println!("{name}, {speed} m/s: roll to {roll:.3}, steer to {steer:.3} rad");
            assert!((0.01..0.2).contains(&roll) && (0.005..0.3).contains(&steer), "{name} at {speed} m/s");
            assert_eq!(all.samples.len(), 12_000);
            let off = all.samples.iter().map(|s| (s.speed_m_s - speed).abs()).fold(0.0, f64::max);
            assert!((1e-6..0.1).contains(&off), "{name} at {speed} m/s: {off}");
        }
    }
}

/// Situation: an hour of pulses. Action: find their starts. Must hold: both sides alike, every one with its duration, pauses
/// from half to one and a half times the interval; a stronger pulse has the same times.
#[test]
fn pulses_come_at_random_times_to_both_sides() {
    let force = |amplitude: f64| -> Vec<f64> {
        let mut experiment = Experiment { duration_s: 3600.0, rate_hz: 50.0, ..Experiment::at(5.0) };
        experiment.force.amplitude = amplitude;
        made(&ridden("young"), &experiment).samples.iter().map(|s| s.lateral_force_n).collect()
    };
    let weak = force(1.0);
    let mut runs: Vec<(f64, usize)> = Vec::new();
    for &value in &weak {
        match runs.last_mut() {
            Some((same, count)) if *same == value => *count += 1,
            _ => runs.push((value, 1)),
        }
    }
    runs.pop();
    let pulses: Vec<_> = runs.iter().filter(|(value, _)| *value != 0.0).collect();
    let right = pulses.iter().filter(|(value, _)| *value == 1.0).count();
    // 0.25 s are 12 or 13 samples of 20 ms: rounded to 13.
    assert!(pulses.iter().all(|(value, count)| value.abs() == 1.0 && *count == 13));
    let pauses: Vec<f64> =
        runs.iter().filter(|(value, _)| *value == 0.0).map(|(_, n)| *n as f64 * 0.02).collect();
    let mean = pauses.iter().sum::<f64>() / pauses.len() as f64;
    println!("{} pulses, {right} to the right, mean pause {mean:.3} s", pulses.len());
    assert!((655..715).contains(&pulses.len()), "{}", pulses.len());
    assert!((right as f64 / pulses.len() as f64 - 0.5).abs() < 0.06);
    assert!(pauses.iter().all(|pause| (2.48..=7.52).contains(pause)) && (mean - 5.0).abs() < 0.2);
    assert!(pauses.iter().any(|pause| *pause < 3.0) && pauses.iter().any(|pause| *pause > 7.0));
    let strong = force(2.0);
    assert!(weak.iter().zip(&strong).all(|(a, b)| 2.0 * a == *b));
}

/// Situation: a record, the same with sensor noise, with a drifting steer sensor, and with a remnant. Action: compare each
/// with the first. Must hold: noise has its standard deviations and leaves the rest alone; drift is slow and in the steer
/// angle alone; the remnant moves the bicycle in proportion.
#[test]
fn noise_drift_and_remnant_are_what_they_say() {
    let (conditions, still) = (ridden("young"), Experiment::at(5.0));
    let clean = made(&conditions, &still);
    let differences = |other: &Record, of: fn(&RecordSample) -> f64| -> Vec<f64> {
        other.samples.iter().zip(&clean.samples).map(|(a, b)| of(a) - of(b)).collect()
    };
    let rms = |all: &[f64]| (all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt();
    let neighbours = |all: &[f64]| rms(&all.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>()) / rms(all);

    let noise = SensorNoise { steer_rad: 1e-3, roll_rad: 2e-3, roll_rate_rad_s: 1e-2 };
    let noisy = made(&conditions, &Experiment { noise, ..still });
    for (of, std) in [
        ((|s| s.steer_rad) as fn(&RecordSample) -> f64, 1e-3),
        (|s| s.roll_rad, 2e-3),
        (|s| s.roll_rate_rad_s, 1e-2),
    ] {
        let found = differences(&noisy, of);
        assert!((rms(&found) / std - 1.0).abs() < 0.04, "{} {std}", rms(&found));
        // White: neighbours differ by sqrt 2 times the standard deviation.
        assert!((neighbours(&found) - std::f64::consts::SQRT_2).abs() < 0.05);
    }
    assert_eq!(rms(&differences(&noisy, |s| s.speed_m_s)), 0.0);

    let drift = Drift { speed_m_s: 0.0, steer_rad: 1e-2 };
    let drifting = made(&conditions, &Experiment { drift, duration_s: 3600.0, ..still });
    let offset: Vec<f64> =
        drifting.samples.iter().zip(&clean.samples).map(|(a, b)| a.steer_rad - b.steer_rad).collect();
    assert!(offset[0] == 0.0 && (1e-3..2e-2).contains(&rms(&offset)), "{}", rms(&offset));
    assert!((0.01..0.05).contains(&neighbours(&offset)), "{}", neighbours(&offset));

    let belt = Drift { speed_m_s: 0.1, steer_rad: 0.0 };
    let speeds = made(&conditions, &Experiment { drift: belt, ..still });
    let (change, steps) = {
        let change = differences(&speeds, |s| s.speed_m_s);
        (rms(&change), neighbours(&change))
    };
    assert!((0.02..0.2).contains(&change) && steps < 0.01, "{change} {steps}");

    let with = |std_nm| {
        let remnant = Remnant { std_nm, ..Remnant::default() };
        rms(&differences(&made(&conditions, &Experiment { remnant, ..still }), |s| s.steer_rad))
    };
    let [small, large] = [1e-3, 1e-2].map(with);
    println!("a remnant of 0.01 N m turns the steer by {large:.2e} rad");
    assert!((large / small / 10.0 - 1.0).abs() < 0.02 && large > 1e-5, "{small} {large}");
}

/// Situation: pulses too strong, a step that nothing divides, values out of range. Action: record. Must hold: a fall with its
/// time, and the record up to it; the errors name the value.
#[test]
fn falls_and_wrong_values_are_errors() {
    let conditions = ridden("young");
    let mut strong = Experiment::at(5.0);
    strong.force.amplitude = 800.0;
    let all = record(&conditions, &strong).unwrap_or_else(|e| panic!("{e}"));
    let (time_s, _) = all.fall.expect("800 N are too strong");
    let first = all.samples.iter().position(|s| s.lateral_force_n != 0.0).expect("a pulse") as f64 * SAMPLE_S;
    assert!((first..first + 5.0).contains(&time_s), "{time_s} after {first}");
    let last = all.samples.last().expect("samples").time_s;
    assert!((time_s - SAMPLE_S..=time_s).contains(&last), "{last} {time_s}");
    assert!(all.samples.iter().all(|s| s.roll_rad.is_finite() && s.steer_rad.is_finite()));
    assert!(matches!(all.upright(), Err(PerturbationError::Fall { .. })));

    let mut rider = thorough(0.0);
    rider.delay_s = 0.012_345_67;
    let odd = Conditions { rider: Some(rider), ..alone() };
    let error = record(&odd, &Experiment::at(4.0)).expect_err("no common step");
    assert!(matches!(error, PerturbationError::Step { .. }), "{error}");

    let wrong = |change: fn(&mut Experiment)| {
        let mut experiment = Experiment::at(5.0);
        change(&mut experiment);
        record(&conditions, &experiment).expect_err("out of range").to_string()
    };
    for (change, named) in [
        ((|e| e.speed_m_s = f64::NAN) as fn(&mut Experiment), "speed (m/s)"),
        (|e| e.rate_hz = 0.0, "sample rate"),
        (|e| e.duration_s = 1e9, "duration"),
        (|e| e.point.height_m = -1.0, "height above the ground"),
        (|e| e.force.duration_s = 0.0, "duration of a pulse"),
        (|e| e.steer_torque.amplitude = -1.0, "steer torque"),
        (|e| e.remnant.std_nm = f64::INFINITY, "remnant"),
        (|e| e.noise.roll_rad = -1.0, "roll noise"),
        (|e| e.drift.speed_m_s = 2.0, "drift of the speed"),
    ] {
        let message = wrong(change);
        assert!(message.contains(named) && message.contains("outside"), "{message}");
    }
}

/// Situation: a delay of 37.5 ms, 200 and 400 samples per second. Action: record. Must hold: a step that divides delay and
/// samples is found, and the rider answers alike; only the pulses' times differ, which are whole samples.
#[test]
fn the_rate_does_not_change_the_ride() {
    let mut conditions = ridden("young");
    conditions.rider.as_mut().expect("a rider").delay_s = 0.0375;
    let at =
        |rate_hz| made(&conditions, &Experiment { duration_s: 60.0, rate_hz, ..Experiment::at(6.0) }).samples;
    let (slow, fast) = (at(200.0), at(400.0));
    assert_eq!((slow.len(), fast.len()), (12_000, 24_000));
    let (mut peak, mut worst) = (0.0_f64, 0.0_f64);
    for (a, b) in slow.iter().zip(fast.iter().step_by(2)) {
        assert_eq!(a.time_s, b.time_s);
        peak = peak.max(a.roll_rad.abs());
        worst = worst.max((a.roll_rad - b.roll_rad).abs());
    }
    println!("roll to {peak:.3} rad, the rates differ by {worst:.1e} rad");
    assert!(worst < 0.1 * peak && worst > 1e-9 && peak > 0.01);
}
