//! Invariants for arbitrary bytes on a link. The fuzz targets beside this file call them with bytes chosen by the
//! fuzzer, `control/tests/cards/fuzz.rs` with the corpus and random ones.
//!
//! A violation panics.

use control::safety::limits::Limits;
use control::wire::{CONFIG_BYTES, FRAME_BYTES, decode_config, decode_frame, encode_config, encode_frame};
use control::{Command, Config, Law, ParamError, Plan, Sample, SensorFrame, State, Triple, step};

/// Number of control periods for which a configuration is run, the roll rate swinging, after its controller has
/// engaged.
const TRIED: u32 = 200;
/// Longest time to full authority that is waited for \[control periods\].
const TIMEOUT: u32 = 2_000;

/// Frames one after the other, the rest dropped.
/// Must hold: each is recovered from its value in every bit, except the switch, which is on for 1 only.
pub(crate) fn frames(bytes: &[u8]) {
    for record in bytes.as_chunks::<FRAME_BYTES>().0 {
        let mut expected = *record;
        expected[FRAME_BYTES - 1] = u8::from(record[FRAME_BYTES - 1] == 1);
        assert_eq!(encode_frame(&decode_frame(record)), expected);
    }
}

/// A configuration record, patched as [`record`] describes.
/// Must hold: rejected with a value outside the named range; or read, unchanged by encoding and decoding, and then
/// rejected in the same way or ridden with, the torque inside its limits.
pub(crate) fn configuration(bytes: &[u8]) {
    let config = match decode_config(&record(bytes)) {
        Ok(config) => config,
        Err(error) => return assert_rejected(&error),
    };
    let again = encode_config(&config);
    assert_eq!(decode_config(&again).map(|config| encode_config(&config)), Ok(again));
    let plan = match config.plan() {
        Ok(plan) => plan,
        Err(error) => return assert_rejected(&error),
    };
    assert_eq!(encode_config(plan.config()), again);
    let period_us = (1e6 / plan.config().rate_hz) as u32;
    let (mut state, mut pressed) = (State::default(), false);
    for tick in 0..plan.ticks_to_engage().min(TIMEOUT) + TRIED {
        let mut frame = straight(tick, period_us, state.torque_nm(), pressed);
        frame.gyro_rad_s.value[0] = 0.5 * (0.02 * tick as f32).sin();
        pressed |= plan.ready(&checked(&plan, &mut state, &frame));
    }
}

/// The first byte chooses the product or the bare law; frames follow, the rest is dropped.
/// Must hold: the torque is inside its limits in each.
pub(crate) fn ride(bytes: &[u8]) {
    let Some((choice, frames)) = bytes.split_first() else { return };
    let config = if choice % 2 == 0 { product() } else { Config::thesis(Law::H { cut: false }) };
    let plan = config.plan().expect("in range");
    let (mut state, mut pressed) = (State::default(), false);
    // From full authority on, so that the frames decide.
    for tick in 0..plan.ticks_to_engage() {
        pressed |= plan.ready(&checked(&plan, &mut state, &straight(tick, 1000, 0.0, pressed)));
    }
    assert_eq!(state.authority(), 1.0);
    for record in frames.as_chunks().0 {
        checked(&plan, &mut state, &decode_frame(record));
    }
}

/// The record of the product, of the bare law or none, by the first byte; then patches of six bytes, each a position
/// (u16, modulo the size) and four bytes for it. So a patch is about as large as a parameter.
fn record(bytes: &[u8]) -> [u8; CONFIG_BYTES] {
    let (choice, patches) = bytes.split_first().unwrap_or((&0, &[]));
    let mut record = match choice % 3 {
        0 => encode_config(&product()),
        1 => encode_config(&Config::thesis(Law::H { cut: false })),
        _ => [0; CONFIG_BYTES],
    };
    for [low, high, patch @ ..] in patches.as_chunks::<6>().0 {
        let place = usize::from(u16::from_le_bytes([*low, *high])) % CONFIG_BYTES;
        record[place..].iter_mut().zip(patch).for_each(|(to, from)| *to = *from);
    }
    record
}

/// As flashed, after a polarity check.
fn product() -> Config {
    let mut config = Config::product();
    config.permit.need_polarity = false;
    config
}

/// Riding straight at 4 m/s, every sensor fresh, the motor's torque as requested.
fn straight(tick: u32, period_us: u32, torque_nm: f32, engage: bool) -> SensorFrame {
    let none = Sample::fresh(0.0);
    SensorFrame {
        now_us: tick.wrapping_mul(period_us),
        gyro_rad_s: Triple::fresh([0.0; 3]),
        accel_m_s2: Triple::fresh([0.0, 0.0, -9.81]),
        steer_rad: none,
        steer_rate_rad_s: none,
        front_wheel_m_s: Sample::fresh(4.0),
        rear_wheel_m_s: Sample::fresh(4.0),
        rider_torque_nm: none,
        motor_torque_nm: Sample::fresh(torque_nm),
        heading_error_rad: none,
        lateral_error_m: none,
        engage,
    }
}

fn assert_rejected(error: &ParamError) {
    let (leaf, value) = (error.leaf, error.value);
    assert!(!leaf.name.is_empty() && leaf.min <= leaf.max, "{error}");
    assert!(!(value >= leaf.min && value <= leaf.max), "{error}");
}

/// One step and its command, with the invariants of every one: a finite torque that is zero or inside the largest
/// torque and, from the previous one, inside both rates.
fn checked(plan: &Plan, state: &mut State, frame: &SensorFrame) -> Command {
    let before = state.torque_nm();
    let command = step(plan, state, frame);
    let (torque, authority) = (command.torque_nm, state.authority());
    assert!(torque.is_finite() && command.gain_nm_s_rad.is_finite(), "{command:?}");
    assert!((0.0..=1.0).contains(&authority), "{authority}");
    assert_eq!(torque.abs().to_bits(), state.torque_nm().abs().to_bits());
    let Limits { max_torque_nm, rise_nm_s, fall_nm_s, .. } = plan.config().limits;
    assert!(max_torque_nm.is_none_or(|max| torque.abs() <= max), "{command:?}");
    if let (Some(rise), Some(fall)) = (rise_nm_s, fall_nm_s) {
        let change = (f64::from(state.torque_nm()) - f64::from(before)).abs();
        let most = f64::from(rise.max(fall)) / f64::from(plan.config().rate_hz);
        // With tolerance for the rounding of an addition in f32.
        let room = f64::from(f32::EPSILON) * f64::from(before.abs() + torque.abs());
        assert!(torque == 0.0 || change <= most * (1.0 + 1e-6) + room, "{change} {command:?}");
    }
    command
}
