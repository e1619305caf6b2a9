//! Parameters of the motor loop, their check, and the constants that follow from them.

use crate::align::AlignConfig;
use crate::current::{CurrentConfig, Gains};
use crate::current_offset::CurrentOffsetConfig;
use crate::encoder::{EncoderConfig, EncoderPlan};
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
use control::ParamError;
use control::param::{Checker, ParamSpec, ParamVisitor};

/// All parameters of the motor loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Calls of [`crate::step`] per second: the PWM frequency \[Hz\].
    pub rate_hz: f32,
    /// Motor and gear.
    pub motor: Motor,
    /// Encoder.
    pub encoder: EncoderConfig,
    /// Bridge.
    pub bridge: Bridge,
    /// Current loop.
    pub current: CurrentConfig,
    /// Limits of the requested torque.
    pub demand: TorqueLimit,
    /// Offset measurement of the current sensors.
    pub zero: CurrentOffsetConfig,
    /// Encoder alignment.
    pub align: AlignConfig,
    /// Checks of the current sensors.
    pub sensors: SensorsConfig,
    /// Thermal overload of the winding.
    pub overload: OverloadConfig,
    /// Supply voltage.
    pub supply: SupplyConfig,
    /// Temperature.
    pub temperature: TemperatureConfig,
    /// Stall: torque without motion.
    pub stall: StallConfig,
    /// Current tracking.
    pub follow: CurrentTrackingConfig,
    /// Magnitude of the back-EMF.
    pub emf: BackEmfConfig,
    /// Direction of the back-EMF.
    pub angle: AngleConfig,
}

/// Delay from sampling a current to the middle of the duty cycles that result from it \[calls\].
pub const DELAY_TICKS: f32 = 1.5;

/// Least number of calls per period of the loop's bandwidth: fewer leave less than 45 degrees of phase margin after
/// [`DELAY_TICKS`].
pub const TICKS_PER_BANDWIDTH: f32 = 12.0;

impl Config {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("", "rate_hz", 5_000.0, 60_000.0), &mut self.rate_hz);
        self.motor.visit_params(to);
        self.encoder.visit_params(to);
        self.bridge.visit_params(to);
        self.current.visit_params(to);
        self.demand.visit_params(to);
        self.zero.visit_params(to);
        self.align.visit_params(to);
        self.sensors.visit_params(to);
        self.overload.visit_params(to);
        self.supply.visit_params(to);
        self.temperature.visit_params(to);
        self.stall.visit_params(to);
        self.follow.visit_params(to);
        self.emf.visit_params(to);
        self.angle.visit_params(to);
    }

    /// Identifies the motor and encoder to which an encoder offset belongs: 32-bit FNV-1a over pole pairs, winding,
    /// flux, and the encoder's counts and direction. Gear and steer direction do not affect the offset.
    pub fn motor_id(&self) -> u32 {
        let Self { motor, encoder, .. } = self;
        let words = [
            u32::from(motor.pole_pairs),
            motor.resistance_ohm.to_bits(),
            motor.inductance_d_h.to_bits(),
            motor.inductance_q_h.to_bits(),
            motor.flux_wb.to_bits(),
            u32::from(encoder.counts),
            u32::from(encoder.reversed),
        ];
        let mut id = 0x811c_9dc5_u32;
        for byte in words.into_iter().flat_map(u32::to_le_bytes) {
            id = (id ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
        id
    }

    /// Checks every value and their consistency, and computes the constants that [`crate::step`] needs.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn plan(mut self) -> Result<Plan, ParamError> {
        let mut checker = Checker::default();
        self.visit_params(&mut checker);
        let c = &self;
        let between = |group, name, min, max, value| ParamSpec::new(group, name, min, max).check(value);
        let most_hz = c.rate_hz / TICKS_PER_BANDWIDTH;
        checker.note(between("current", "bandwidth_hz", 10.0, most_hz, c.current.bandwidth_hz));
        checker.note(between("align", "current_a", 0.1, c.current.max_a, c.align.current_a));
        // The trip leaves a margin for the loop's overshoot and for noise.
        checker.note(between(
            "sensors",
            "trip_a",
            1.2 * c.current.max_a,
            c.sensors.range_a,
            c.sensors.trip_a,
        ));
        checker.note(between("supply", "sag_v", 1.01 * c.supply.low_v, c.supply.high_v, c.supply.sag_v));
        checker.note(between("heat", "hot_c", c.temperature.warm_c + 1.0, 160.0, c.temperature.hot_c));
        // A jump of an eighth of an electrical turn or more would misdirect the torque.
        let eighth = 0.125 / f32::from(c.motor.pole_pairs.max(1));
        checker.note(between("encoder", "jump_turns", 1e-4, eighth, c.encoder.jump_turns));
        checker.verdict()?;
        Ok(Plan {
            gains: Gains::new(&self.motor, &self.current, self.rate_hz),
            encoder: EncoderPlan::new(&self.encoder, self.rate_hz),
            period_s: 1.0 / self.rate_hz,
            torque_nm_a: self.motor.torque_nm_a(),
            unverified_angle_limit_a: self.angle.unproved_nm / self.motor.torque_nm_a().abs(),
            dead_duty: self.bridge.dead_duty(self.rate_hz),
            max_voltage_ratio: self.bridge.max_voltage_ratio(),
            config: self,
        })
    }
}

/// A checked [`Config`] with the constants that follow from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    pub(crate) config: Config,
    pub(crate) gains: Gains,
    pub(crate) encoder: EncoderPlan,
    pub(crate) period_s: f32,
    pub(crate) torque_nm_a: f32,
    pub(crate) unverified_angle_limit_a: f32,
    pub(crate) dead_duty: f32,
    pub(crate) max_voltage_ratio: f32,
}

impl Plan {
    /// The checked configuration.
    pub fn config(&self) -> &Config {
        &self.config
    }
}
