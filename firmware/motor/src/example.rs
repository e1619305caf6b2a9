//! Example configuration: a gear motor of about 7 N m on the steer axis, on a VESC-6-class board.
//!
//! Motor: maxon EC 45 flat, 70 W, the winding for 24 V, from its data sheet (catalogue page "EC 45 flat, 43.5 mm,
//! brushless, 70 watt, provisional"): terminal resistance 0.573 ohm, terminal inductance 0.301 mH, torque constant
//! 40.4 mN m/A, rotor inertia 181 g cm^2, nominal current 3.29 A, thermal time constant of the winding 43.1 s,
//! winding up to 125 deg C, 10 000 rpm. The 8 pole pairs are those known of this family; the page was read without
//! that line.
//! Gear: 36:1, as on the TU Delft steer-by-wire bicycle, which has two EC 45 flat with a GP 42 C 36:1 each
//! (mechmotum/sbw_bicycle_with_model_matching). Torque limit: 7 N m, the balance-assist prototype's.
//! Board: shunts of 0.5 mohm, gain 20, 12 bits of 3.3 V: 0.0806 A a step, 165 A either way.
//!
//! Values without a source (dead time, all thresholds) are assumptions and must be measured on a real board.

use crate::align::AlignConfig;
use crate::config::Config;
use crate::current::CurrentConfig;
use crate::current_offset::CurrentOffsetConfig;
use crate::encoder::EncoderConfig;
use crate::machine::Motor;
use crate::modulate::Bridge;
use crate::protect::angle::AngleConfig;
use crate::protect::back_emf::BackEmfConfig;
use crate::protect::current_tracking::CurrentTrackingConfig;
use crate::protect::overload::OverloadConfig;
use crate::protect::sensors::SensorsConfig;
use crate::protect::stall::StallConfig;
use crate::protect::supply::SupplyConfig;
use crate::protect::temperature::TemperatureConfig;
use crate::torque_limit::TorqueLimit;

/// Torque constant of the data sheet, for block commutation every sixth of a turn \[N m/A\].
const SHEET_NM_A: f32 = 40.4e-3;

/// The motor and its gear.
pub const MOTOR: Motor = Motor {
    pole_pairs: 8,
    resistance_ohm: 0.573 / 2.0,
    inductance_d_h: 0.301e-3 / 2.0,
    inductance_q_h: 0.301e-3 / 2.0,
    // The data sheet's constant is the mean over a sixth of a turn, 3/pi of the peak, between two terminals.
    flux_wb: SHEET_NM_A * core::f32::consts::FRAC_PI_3 / 1.732_050_8 / 8.0,
    ratio: 36.0,
    reversed: false,
};

/// The complete configuration, at 20 kHz. The encoder's offset is unknown: the motor must be aligned.
pub const EXAMPLE: Config = Config {
    rate_hz: 20_000.0,
    motor: MOTOR,
    encoder: EncoderConfig {
        counts: 16_384,
        reversed: false,
        offset_turns: None,
        timeout_calls: 10,
        jump_turns: 0.012,
        speed_max_turns_s: 166.0,
        tracking_hz: 300.0,
    },
    bridge: Bridge { duty_min: 0.02, duty_max: 0.95, dead_time_s: 0.5e-6, dead_time_a: 0.5 },
    current: CurrentConfig { bandwidth_hz: 1000.0, max_a: 10.0 },
    demand: TorqueLimit { max_nm: 7.0, slew_nm_s: 2000.0 },
    zero: CurrentOffsetConfig { samples: 2000, max_a: 5.0, spread_a: 2.0 },
    align: AlignConfig {
        current_a: 6.0,
        ramp_calls: 10_000,
        move_calls: 10_000,
        rest_calls: 10_000,
        tolerance_turns: 0.06,
    },
    sensors: SensorsConfig { range_a: 160.0, trip_a: 15.0, sum_a: 2.0, sum_calls: 4 },
    overload: OverloadConfig { continuous_a: 3.29, time_s: 43.1 },
    supply: SupplyConfig { low_v: 16.0, sag_v: 18.0, high_v: 32.0, persist_calls: 2 },
    temperature: TemperatureConfig { warm_c: 80.0, hot_c: 100.0 },
    stall: StallConfig { hold_a: 3.0, still_turns_s: 0.3, time_s: 2.0 },
    follow: CurrentTrackingConfig { error_a: 1.5, mean_calls: 20 },
    emf: BackEmfConfig { error_v: 1.0, resistance_part: 0.5, mean_calls: 100 },
    angle: AngleConfig {
        error_v: 0.1,
        resistance_part: 0.45,
        flux_part: 0.4,
        dead_part: 0.67,
        mean_calls: 200,
        unproved_nm: 2.5,
        proof_calls: 4_000,
    },
};
