//! The bicycle rides on the virtual board.

use crate::bed::product;
use crate::boards::slow;
use control::Mode;
use sim_host::ride::{Conditions, Ride, Start, traced, traced_on};
use std::path::Path;
use virtual_board::Options;
use virtual_board::bicycle::OnBicycle;
use virtual_board::bicycle::causes::Cause;
use virtual_board::bicycle::compare::{Difference, torques_nm};
use virtual_board::bicycle::rides::{BOARD_STEP_S, PERIOD_S, Preset, on_board, simulated};

/// Steer rate of the disturbance \[rad/s\].
const KNOCK_RAD_S: f64 = 1.5;
/// Duration of the ride after the disturbance \[s\].
const RIDDEN_S: f64 = 1.0;

/// A ride in the simulator and its torque in each control period \[N m\].
fn in_simulator(conditions: &Conditions, start: Start) -> (Ride, Vec<f64>) {
    let (ride, trace) = traced(conditions, start);
    (ride, torques_nm(&trace, 1))
}

/// One ride of the tests below; the check of the final state is left to the caller.
fn rides(image: &Path, preset: Preset, rider: Option<&str>, speed_m_s: f64) -> Ride {
    let name = format!("{} {rider:?} {speed_m_s} m/s", preset.name());
    let start = Start { speed_m_s, steer_rate_rad_s: KNOCK_RAD_S, roll_rate_rad_s: 0.0 };
    let conditions = on_board(preset, rider, RIDDEN_S).expect("shipped");
    let mut board = OnBicycle::new(image.to_owned(), Options::default(), &conditions);
    let (rode, trace) = traced_on(&conditions, start, &mut board).expect("the board rides to the end");
    let torque = torques_nm(&trace, (PERIOD_S / BOARD_STEP_S).round() as usize);

    let states: Vec<(u8, u64)> = trace.iter().map(|point| (point.mode, point.causes)).collect();
    let mut changes: Vec<_> = trace.iter().map(|point| point.t).zip(&states).collect();
    changes.dedup_by_key(|(_, states)| *states);
    assert!(
        states.iter().all(|(mode, _)| *mode == Mode::Engaged as u8),
        "{name}: engaged from the knock to the end, {changes:?}"
    );
    let state = board.display().state.expect("broadcast");
    assert!(state.driven && state.authority == Some(1.0), "{name}: {state:?}");
    let bench = board.bench().expect("still powered");
    assert_eq!(bench.resets().len(), 0, "{name}");

    let mut alike = simulated(preset, rider, RIDDEN_S).expect("shipped");
    for cause in Cause::ALL {
        cause.act(&mut alike, speed_m_s).expect("shipped");
    }
    let (simulated, expected) = in_simulator(&alike, start);
    let by = Difference::new(&torque, &expected);
    println!("{name}: {by:.3?}, roll {:.3} {:.3}", rode.effort.peak_roll_rad, simulated.effort.peak_roll_rad);
    assert!(!rode.fell() && !simulated.fell(), "{name}");
    assert!((0.3..3.0).contains(&by.rms_nm), "{name}: the motor works: {by:?}");
    assert!((1e-4..0.06).contains(&(by.rms_difference_nm / by.rms_nm)), "{name}: {by:?}");
    assert!((1e-3..0.6).contains(&by.largest_nm), "{name}: {by:?}");
    let roll = rode.effort.peak_roll_rad / simulated.effort.peak_roll_rad;
    assert!((0.95..1.05).contains(&roll), "{name}: largest roll {roll} of the simulator's");
    rode
}

/// The rides of a preset; by default the first and the last.
fn rides_of(preset: Preset) {
    let Some(image) = product() else { return };
    let all = [(None, 3.0), (None, 5.0), (Some("smart"), 3.0), (Some("smart"), 5.0)];
    for (rider, speed_m_s) in all.into_iter().step_by(if slow() { 1 } else { 3 }) {
        let rode = rides(&image, preset, rider, speed_m_s);
        let name = format!("{} {rider:?} {speed_m_s} m/s", preset.name());
        assert!(
            (0.01..0.15).contains(&rode.effort.peak_roll_rad),
            "{name}: the knock shows: {:?}",
            rode.effort
        );
        assert!(rode.end.roll.abs() < 0.1 && rode.end.steer.abs() < 0.3, "{name}: upright: {:?}", rode.end);
    }
}

/// Situation: the flashed image on the virtual board on a bicycle, set to the published law h without limits by
/// stored parameters, the encoder aligned; hands off at 3 m/s, and the smart rider at 5 m/s (with `--all` both at both
/// speeds).
/// Action: the rider engages it, then a knock gives the handlebar 1.5 rad/s.
/// Must hold: engaged without a pause to the end of 1 s, no reset, upright; the motor's torque within 6 % (root mean
/// square) and 0.6 N m of the simulator's with the board's parts modelled, the largest roll within 5 %, and the two
/// not identical.
#[test]
fn law_h_rides_on_the_board() {
    rides_of(Preset::H);
}

/// As above, set to the flashed configuration.
#[test]
fn the_product_rides_on_the_board() {
    rides_of(Preset::Product);
}
