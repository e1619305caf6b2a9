//! Constants of a VESC 6 MK6 on a bicycle: the board's circuits, and the sensors wired to it.
//!
//! The board's values are from the public hardware definition (`hwconf/trampa/vesc6/hw_60_core.h` in the repository
//! vedderb/bldc, hardware 60_MK6). The wiring (encoder, steer sensor, wheels, torque sensor) and all thresholds are
//! chosen here; docs/hardware.md describes the wiring.

use crate::analog::{Divider, Gauge, Shunt, Thermistor};
use crate::as5047;
use crate::drv8301::{Gain, GateCurrent, OverCurrent, Settings};
use control::sensors::wheel_speed::WheelPulsesConfig;
use core::f32::consts::FRAC_PI_2;
use motor::example::EXAMPLE;

/// Supply and reference voltage of the converter \[V\].
const REFERENCE_V: f32 = 3.3;

/// Shunts of the three phases.
pub const SHUNT: Shunt =
    Shunt { resistance_ohm: 0.5e-3, gain: 20.0, reference_v: REFERENCE_V, reversed: false };

/// Divider of the bus voltage.
pub const SUPPLY: Divider = Divider { upper_ohm: 39_000.0, lower_ohm: 2_200.0, reference_v: REFERENCE_V };

/// Thermistor beside the switches.
pub const BOARD_TEMPERATURE: Thermistor =
    Thermistor { lower_ohm: 10_000.0, nominal_ohm: 10_000.0, beta_k: 3380.0 };

/// Settings of the gate driver. The VESC firmware runs this board with 1.7 A, 403 mV and cycle-by-cycle limiting,
/// dead time 0.36 us (`hwconf/drv8301.c`, `mcconf_default.h` in vedderb/bldc).
///
/// Gate current: as in the VESC firmware, since the board is known to switch well with it. With 0.25 A, switching takes
/// seven times as long: a dead time of 0.5 us can be too short, and the over-current comparators can act on switches
/// that are not fully closed yet.
///
/// Over-current: the VESC firmware carries 150 A without reaching 403 mV, so a switch has 2.7 mohm at most. Here the
/// motor loop opens the bridge at 15 A, 19.5 A at worst, which is 53 mV at most: 250 mV is nearly five times that. A
/// current above it is a short outside the winding, too fast for a call every 50 us, and must not be switched on
/// again in the next cycle. So the driver latches, which also is the only mode reported on its fault pin (data sheet:
/// limiting is reported on nOCTW, which is not wired here).
///
/// The driver's amplifiers are unused, as the shunts have their own.
pub const GATE_DRIVER: Settings = Settings {
    gate_current: GateCurrent::A1_7,
    over_current: OverCurrent::Latch,
    over_current_mv: 250,
    gain: Gain::X20,
};

/// Voltage at the motor terminals from which on the gate driver's start-up after enabling can fail \[V\]: DRV8301 data
/// sheet, rev. F, 8.1.1.
pub const ENABLE_V: f32 = 8.5;

/// Motor: the example's, with the encoder wired here. The encoder offset comes from flash, where alignment stores it; a
/// value of `encoder.offset_turns` set here takes precedence. Without an offset the motor gives no torque.
pub const MOTOR: motor::Config = motor::Config {
    encoder: motor::encoder::EncoderConfig { counts: as5047::COUNTS, ..EXAMPLE.encoder },
    ..EXAMPLE
};

/// Time without a command after which the bridge opens \[calls of the motor interrupt\]: 5 ms, as long as
/// `input.max_gap_ms` of `control::Config::product`.
pub const COMMAND_TIMEOUT_CALLS: u16 = 100;

/// Steer sensor: 10 to 90 % of the reference over 180 degrees, rising to the right.
pub const STEER_RAD: Gauge = Gauge {
    least_counts: 410,
    most_counts: 3685,
    value_at_least_counts: -FRAC_PI_2,
    value_at_most_counts: FRAC_PI_2,
};

/// Optional torque sensor of the rider: 10 to 90 % of the reference over 40 N m, rising to the right.
pub const RIDER_NM: Gauge =
    Gauge { least_counts: 410, most_counts: 3685, value_at_least_counts: -20.0, value_at_most_counts: 20.0 };

/// Counts below which the rider's switch is closed: a contact to ground with a pull-up, so that a cut wire means open.
pub const SWITCH_COUNTS: u16 = 1365;

/// Debounce time of the switch \[control periods\]: the longest bounce time in data sheets of switches, 20 ms.
pub const SWITCH_TICKS: u16 = 20;

/// Clock of the CAN controller: APB1, a quarter of the core clock \[Hz\].
pub const CAN_CLOCK_HZ: u32 = 42_000_000;

/// Pulse sensors of both wheels: 16 magnets on 0.35 m.
pub fn wheel() -> WheelPulsesConfig {
    WheelPulsesConfig::default()
}
