//! A VESC 6 MK6 on a bicycle, in numbers: what is on the board, and what is wired to it here.
//!
//! The board's own are facts of the public hardware definition (`hwconf/trampa/vesc6/hw_60_core.h` in the repository
//! vedderb/bldc, hardware 60_MK6). What is wired to it (encoder, steer sensor, wheels, torque sensor) and every
//! threshold is chosen here; docs/hardware.md tells the wiring.

use crate::analog::{Divider, Gauge, Shunt, Thermistor};
use crate::as5047;
use crate::drv8301::{Gain, GateCurrent, OverCurrent, Settings};
use control::sensors::wheel_speed::WheelPulsesConfig;
use core::f32::consts::FRAC_PI_2;
use motor::example::EXAMPLE;

/// Supply and reference of the converter \[V\].
const REFERENCE_V: f32 = 3.3;

/// The shunts in the three phases.
pub const SHUNT: Shunt =
    Shunt { resistance_ohm: 0.5e-3, gain: 20.0, reference_v: REFERENCE_V, reversed: false };

/// The supply's divider.
pub const SUPPLY: Divider = Divider { upper_ohm: 39_000.0, lower_ohm: 2_200.0, reference_v: REFERENCE_V };

/// The thermistor beside the switches.
pub const BOARD_HEAT: Thermistor = Thermistor { lower_ohm: 10_000.0, nominal_ohm: 10_000.0, beta_k: 3380.0 };

/// The gate driver. The drive's own firmware runs this board with 1.7 A, 403 mV and cycle-by-cycle limiting, dead time
/// 0.36 us (`hwconf/drv8301.c`, `mcconf_default.h` in vedderb/bldc).
///
/// Gate current: as there, since it is the one the board is known to switch well with. With 0.25 A a gate takes seven
/// times as long, which a dead time of 0.5 us need not cover, and the over-current comparators look at switches that
/// are not closed yet.
///
/// Over-current: the board carries 150 A there without passing 403 mV, so a switch has 2.7 mohm at most. Here the
/// motor's loop opens the bridge at 15 A, 19.5 A at the worst, which is 53 mV at most: 250 mV is nearly five times
/// that. What passes it is a short outside the winding, too fast for a call each 50 us, and is not to be tried again in
/// the next cycle. So the driver latches, which also is the only mode shown on its fault pin (its data sheet: limiting
/// is shown on nOCTW, not wired here).
///
/// Its amplifiers are not used, as the shunts have their own.
pub const GATE_DRIVER: Settings = Settings {
    gate_current: GateCurrent::A1_7,
    over_current: OverCurrent::Latch,
    over_current_mv: 250,
    gain: Gain::X20,
};

/// Voltage of the motor's terminals from which on the gate driver may not start rightly when it is enabled \[V\]:
/// DRV8301 data sheet, rev. F, 8.1.1.
pub const ENABLE_V: f32 = 8.5;

/// The motor: the example's, with the encoder wired here. Its offset is that in flash, which alignment leaves there; one
/// that is written down here as `encoder.offset_turns` is used instead. Without either no torque is given.
pub const MOTOR: motor::Config = motor::Config {
    encoder: motor::encoder::EncoderConfig { counts: as5047::COUNTS, ..EXAMPLE.encoder },
    ..EXAMPLE
};

/// Silence of control after which the bridge opens \[calls of the motor's interrupt\]: 5 ms, as long as
/// `input.max_gap_ms` of `control::Config::product`.
pub const COMMAND_TIMEOUT_CALLS: u16 = 100;

/// The steer sensor: 10 to 90 % of the reference over 180 degrees, rising to the right.
pub const STEER_RAD: Gauge = Gauge { least_counts: 410, most_counts: 3685, max: -FRAC_PI_2, min: FRAC_PI_2 };

/// The rider's torque sensor, where there is one: 10 to 90 % of the reference over 40 N m, rising to the right.
pub const RIDER_NM: Gauge = Gauge { least_counts: 410, most_counts: 3685, max: -20.0, min: 20.0 };

/// Counts below which the rider's switch is closed: a contact to ground under a pull-up, so a cut wire is open.
pub const SWITCH_COUNTS: u16 = 1365;

/// Control periods for which the switch must seem otherwise: the longest bouncing in data sheets of switches, 20 ms.
pub const SWITCH_TICKS: u16 = 20;

/// The CAN controller's clock: APB1, a quarter of the core's \[Hz\].
pub const CAN_CLOCK_HZ: u32 = 42_000_000;

/// Both wheels: 16 magnets on 0.35 m.
pub fn wheel() -> WheelPulsesConfig {
    WheelPulsesConfig::default()
}
