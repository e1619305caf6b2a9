//! The frame vibrates faster than the gyro is read.

use crate::bed::{Listener, request};
use crate::boards::{PRODUCT, powered};
use link::message::Message;
use std::f64::consts::TAU;
use virtual_board::Bench;
use virtual_board::parts::bmi160::Motion;
use virtual_board::wiring::Wiring;

/// Time between two corners of the motion \[ms\].
const CORNER_MS: f64 = 0.1;

/// The largest roll rate in the telemetry over a number of corners, while the gyro vibrates about x with 1 rad/s.
fn largest_rad_s(bench: &mut Bench, hz: f64, corners: u32) -> f64 {
    let rate = |at_ms: f64| (TAU * hz * 1e-3 * at_ms).sin();
    bench.received();
    for _ in 0..corners {
        let (at_ms, at_ns) = (bench.now_ms(), bench.now_ns());
        let slope = 1e3 * (rate(at_ms + CORNER_MS) - rate(at_ms)) / CORNER_MS;
        let [_, upright] = Motion::REST.values;
        let (values, slopes) = ([[rate(at_ms), 0.0, 0.0], upright], [[slope, 0.0, 0.0], [0.0; 3]]);
        bench.with(move |board| board.chip.wiring.imu.moves(Motion { at_ns, values, slopes }));
        bench.run_ms(CORNER_MS).unwrap();
    }
    let mut largest = 0.0_f32;
    Listener::default().take(&bench.received(), |_, message| {
        if let Message::Telemetry(telemetry) = message {
            largest = largest.max(telemetry.frame.gyro_rad_s.value[0].abs());
        }
    });
    largest.into()
}

/// Situation: the product runs, and reads its gyro 1000 times a second; frequencies above 500 Hz fold to lower ones.
/// Action: the frame rolls with 1 rad/s at 7 Hz, then at 613 Hz, which folds to 387.
/// Must hold: the slow motion is measured fully, the fast one between a fiftieth and a tenth: the sensor filters it
/// before it is read.
#[test]
fn a_vibration_does_not_fold_into_the_motion() {
    let mut bench = powered(PRODUCT, Wiring::new());
    bench.run_ms(300.0).unwrap();
    bench.send(&request(&Message::AskHello, 7));
    bench.run_ms(20.0).unwrap();
    let slow = largest_rad_s(&mut bench, 7.0, 3000);
    let fast = largest_rad_s(&mut bench, 613.0, 5000);
    println!("{slow:.3} rad/s at 7 Hz, {fast:.3} at 613 Hz");
    assert!((0.95..1.03).contains(&slow), "{slow} rad/s");
    assert!((0.02..0.1).contains(&fast), "{fast} rad/s");
}
