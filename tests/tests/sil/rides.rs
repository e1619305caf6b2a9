//! Rides with the control crate in the loop.

use control::{Config, Law, Taper};
use sim_host::ride::{Conditions, Imu, Outcome, Ride, Start, rides, traced, traced_until};
use std::cell::Cell;
use tests::basins::{H, alone, assisted, configured, ideal};

fn knock(speed_m_s: f64, steer_rate_rad_s: f64) -> Start {
    Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 }
}

fn one(conditions: &Conditions, start: Start) -> Ride {
    rides(conditions, &[start])[0]
}

/// Situation: 4 m/s, where the bicycle without assist is unstable.
/// Action: a knock of 5 rad/s to the handlebar.
/// Must hold: without assist it falls; assisted it recovers, with 3 to 9 N m and 4 to 8 J, of which the motor takes
/// back 0.1 to 1 J.
#[test]
fn the_assist_recovers_a_ride_that_falls_without() {
    let start = knock(4.0, 5.0);
    let fallen = one(&alone(), start);
    let time = fallen.outcome.time_to_fall_s().expect("falls");
    assert!((0.3..3.0).contains(&time), "{time}");
    let saved = one(&assisted(H), start);
    assert_eq!(saved.outcome, Outcome::Recovered);
    assert!((3.0..9.0).contains(&saved.effort.peak_torque_nm), "{:?}", saved.effort);
    assert!((10.0..35.0).contains(&saved.effort.peak_steer_rad.to_degrees()), "{:?}", saved.effort);
    let (out_j, net_j) = (saved.effort.motor_energy_out_j, saved.effort.motor_energy_j);
    assert!((4.0..8.0).contains(&out_j) && (0.1..1.0).contains(&(out_j - net_j)), "{:?}", saved.effort);
}

/// Situation: a ride that is asked in every control period whether it is stopped.
/// Action: never, and at the hundredth question.
/// Must hold: the ride and the record of an ordinary one, to the bit; no ride, and no further question.
#[test]
fn a_stopped_ride_is_none() {
    let (conditions, start) = (assisted(H), knock(4.0, 5.0));
    let asked = Cell::new(0);
    let whole = traced_until(&conditions, start, &|| {
        asked.set(asked.get() + 1);
        false
    });
    assert_eq!(whole, Some(traced(&conditions, start)));
    assert!((6000..6010).contains(&asked.get()), "{}", asked.get());
    asked.set(0);
    let stopped = traced_until(&conditions, start, &|| {
        asked.set(asked.get() + 1);
        asked.get() == 100
    });
    assert_eq!((stopped, asked.get()), (None, 100));
}

/// Situation: h at 2 m/s, below its weave speed of 2.445 m/s.
/// Action: a small knock.
/// Must hold: it does not fall within the time limit, and is not called recovered.
#[test]
fn an_unstable_ride_that_lasts_to_the_time_limit_is_undecided() {
    assert_eq!(one(&assisted(H), knock(2.0, 1.0)).outcome, Outcome::Undecided);
    assert_eq!(one(&assisted(H), knock(5.0, 1.0)).outcome, Outcome::Recovered);
}

/// Situation: any disturbance.
/// Action: the same to the other side.
/// Must hold: all quantities mirror, to the bit.
#[test]
fn left_mirrors_right_to_the_bit() {
    for conditions in [alone(), assisted(H), ideal(H), configured(Config::product())] {
        for (v, w) in [(1.0, 3.0), (4.0, 5.0), (4.0, 9.0), (6.5, 7.7), (9.0, 27.25)] {
            let (right, left) = (one(&conditions, knock(v, w)), one(&conditions, knock(v, -w)));
            assert_eq!(right.outcome, left.outcome, "{v} {w}");
            assert_eq!((right.end.roll, right.end.steer), (-left.end.roll, -left.end.steer), "{v} {w}");
            assert_eq!(right.end.rear_wheel_rate.to_bits(), left.end.rear_wheel_rate.to_bits());
            assert_eq!(right.effort, left.effort);
        }
    }
}

/// Situation: many rides of different length.
/// Action: ride them in a batch, in another order, and each alone.
/// Must hold: a ride has the same bits in any batch.
#[test]
fn a_ride_has_the_same_bits_in_any_batch() {
    let starts: Vec<Start> = (0..40).map(|i| knock(0.25 * f64::from(i), 0.3 * f64::from(i))).collect();
    for conditions in [alone(), assisted(H), ideal(Law::G)] {
        let together = rides(&conditions, &starts);
        let backwards: Vec<Start> = starts.iter().rev().copied().collect();
        let mut turned = rides(&conditions, &backwards);
        turned.reverse();
        assert_eq!(together, turned);
        assert!(together.iter().any(Ride::fell) && !together.iter().all(Ride::fell));
        for (start, ride) in starts.iter().zip(&together) {
            let (alone, trace) = traced(&conditions, *start);
            assert_eq!(alone, *ride);
            assert_eq!(trace.len(), ride.steps as usize);
        }
    }
}

/// Situation: the bicycle without assist falls, in the last two rides with its front wheel passing across the path,
/// where rear wheel rate and steer rate no longer fix the yaw rate.
/// Action: quarter the step.
/// Must hold: the time of the fall stays within a microsecond.
#[test]
fn the_fall_is_located_within_a_microsecond() {
    for (v, w) in [(3.0, 4.5), (7.0, 8.0), (4.0, 5.0), (5.0, 8.5)] {
        let coarse = one(&alone(), knock(v, w)).outcome.time_to_fall_s().expect("falls");
        let fine = Conditions { step_s: 2.5e-4, ..alone() };
        let fine = one(&fine, knock(v, w)).outcome.time_to_fall_s().expect("falls");
        println!("{v} m/s, {w} rad/s: {coarse} and {fine} s");
        assert!((coarse - fine).abs() < 1e-6, "{v} {w}: {coarse} {fine}");
    }
}

/// Situation: each limit switched on alone.
/// Action: a hard knock.
/// Must hold: the ride obeys the limit, reaches it, and differs from the unlimited one.
#[test]
fn limits_are_obeyed_in_the_loop() {
    let start = knock(4.0, 7.0);
    let free = one(&assisted(H), start);
    let limited = |change: fn(&mut Config)| {
        let mut config = Config::thesis(H);
        change(&mut config);
        one(&configured(config), start)
    };
    let magnitude = limited(|c| c.limits.max_torque_nm = Some(3.0));
    assert_eq!(magnitude.effort.peak_torque_nm, 3.0);
    assert!(free.effort.peak_torque_nm > 6.0);
    let rate = limited(|c| (c.limits.rise_nm_s, c.limits.fall_nm_s) = (Some(20.0), Some(20.0)));
    assert!((19.9..20.001).contains(&rate.effort.peak_slew_nm_s), "{:?}", rate.effort);
    assert!(free.effort.peak_slew_nm_s > 40.0);
    let taper = limited(|c| c.limits.taper = Some(Taper { zero_m_s: 3.0, full_m_s: 9.9 }));
    assert!(taper.effort.peak_torque_nm < 0.7 * free.effort.peak_torque_nm);
    let far = limited(|c| c.limits.max_torque_nm = Some(50.0));
    assert_eq!(far, free);
}

/// Situation: sensors that are 0, 20 and 60 ms late.
/// Action: the same knock.
/// Must hold: the torque begins that much later and the ride gets worse.
#[test]
fn a_late_sensor_makes_the_torque_late() {
    let mut peaks = Vec::new();
    for ticks in [0_u16, 20, 60] {
        let conditions = Conditions { sensor_delay_ticks: ticks, ..assisted(H) };
        let (ride, trace) = traced(&conditions, knock(5.0, 3.0));
        let first = trace.iter().position(|p| p.torque != 0.0).expect("a torque");
        // At t = 0 the roll rate is still zero, so the first torque comes a period later.
        assert_eq!(first, usize::from(ticks) + 1);
        peaks.push(ride.effort.peak_steer_rad);
    }
    assert!(peaks[0] < peaks[1] && peaks[1] < peaks[2], "{peaks:?}");
}

/// Situation: a gyro on the frame instead of the rate of the roll angle.
/// Action: the same ride.
/// Must hold: the two signals differ slightly once the bicycle yaws and pitches.
#[test]
fn the_body_rate_is_not_the_euler_rate() {
    let body = Conditions { imu: Imu::Body, ..assisted(H) };
    let (_, trace) = traced(&body, knock(4.0, 7.0));
    let gap = trace.iter().map(|p| (p.measured_roll_rate - p.roll_rate).abs()).fold(0.0, f64::max);
    println!("largest difference {gap:.4} rad/s");
    assert!((1e-4..0.5).contains(&gap), "{gap}");
}

/// Situation: no disturbance at all, any speed, zero too.
/// Action: ride.
/// Must hold: nothing moves.
#[test]
fn an_undisturbed_ride_stays_straight() {
    for conditions in [alone(), assisted(H)] {
        for ride in rides(&conditions, &[0.0, 0.5, 3.0, 30.0].map(|v| knock(v, 0.0))) {
            assert_eq!(ride.outcome, Outcome::Recovered);
            assert_eq!((ride.end.roll, ride.end.steer, ride.effort.peak_torque_nm), (0.0, 0.0, 0.0));
        }
    }
}

/// Situation: rides that recover and rides that fall, under the crate and under the ideal law.
/// Action: compute the effort again from the trace.
/// Must hold: it is the reported one.
#[test]
fn the_effort_is_that_of_the_trace() {
    for conditions in [assisted(H), ideal(H)] {
        for (v, w) in [(5.0, 5.0), (4.0, 9.0), (8.0, 15.0), (8.0, 30.0)] {
            let (ride, trace) = traced(&conditions, knock(v, w));
            // The period in which the bicycle falls is not counted.
            let booked = &trace[..trace.len() - usize::from(ride.fell())];
            let peak = booked.iter().map(|p| p.torque.abs()).fold(0.0, f64::max);
            let slew =
                booked.windows(2).map(|p| (p[1].torque - p[0].torque).abs() / 1e-3).fold(0.0, f64::max);
            let squares: f64 = booked.iter().map(|p| p.torque * p.torque).sum();
            let rms = (squares / booked.len() as f64).sqrt();
            let e = &ride.effort;
            assert_eq!(e.peak_torque_nm, peak, "{v} {w}");
            assert!(peak > 0.5 && (e.peak_slew_nm_s - slew).abs() < 1e-9 * slew, "{v} {w}: {e:?}, {slew}");
            assert!((e.rms_torque_nm - rms).abs() < 1e-12 * rms, "{v} {w}: {e:?}, {rms}");
        }
    }
}
