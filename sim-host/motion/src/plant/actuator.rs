//! Actuator model: from the commanded torque to the torque on the steer axis, through drive, motor and gear.

use super::{Friction, PlantError, SteerStop};
use crate::range::within;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Supply voltage and motor constants, reflected to the steer axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Supply {
    /// Voltage \[V\].
    pub voltage_v: f64,
    /// Winding resistance \[ohm\].
    pub resistance_ohm: f64,
    /// Torque constant times gear ratio \[N m/A\], equal to the voltage constant at the steer axis \[V
    /// s/rad\].
    pub constant_nm_a: f64,
}

impl Supply {
    /// Smallest and largest torque at a steer rate \[rad/s\]: `k (-V - k q) / R` and `k (V - k q) / R`.
    fn limits(&self, rate: f64) -> (f64, f64) {
        let k = self.constant_nm_a;
        let per_volt = k / self.resistance_ohm;
        (per_volt * (-self.voltage_v - k * rate), per_volt * (self.voltage_v - k * rate))
    }
}

/// Deviations of the motor from the commanded torque, and the friction and end-stop of the steer. The default
/// is exact and has neither.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ActuatorConfig {
    /// Delay from the command to the drive \[control periods\].
    pub delay_ticks: u16,
    /// Delivered over commanded torque: the error of the torque constant. Negative: wired with the wrong
    /// sign.
    pub scale: f64,
    /// Time constant of the torque's first-order response \[s\]; 0 is no lag.
    pub time_constant_s: f64,
    /// Largest magnitude of the torque \[N m\]; null is no limit.
    pub limit_nm: Option<f64>,
    /// Torque limit by the supply voltage; null is no limit.
    pub supply: Option<Supply>,
    /// Friction about the steer axis.
    pub friction: Friction,
    /// The steer's mechanical end-stop; null is none.
    pub stop: Option<SteerStop>,
}

impl Default for ActuatorConfig {
    fn default() -> Self {
        Self {
            delay_ticks: 0,
            scale: 1.0,
            time_constant_s: 0.0,
            limit_nm: None,
            supply: None,
            friction: Friction::default(),
            stop: None,
        }
    }
}

impl ActuatorConfig {
    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), PlantError> {
        within("actuator delay (control periods)", f64::from(self.delay_ticks), 0.0, 1000.0)?;
        within("actuator scale", self.scale, -10.0, 10.0)?;
        within("actuator time constant (s)", self.time_constant_s, 0.0, 10.0)?;
        self.limit_nm.map_or(Ok(()), |limit| within("actuator limit (N m)", limit, 0.0, 1000.0))?;
        self.supply.map_or(Ok(()), |supply| {
            within("supply voltage (V)", supply.voltage_v, 1.0, 1000.0)?;
            within("motor resistance (ohm)", supply.resistance_ohm, 1e-3, 1e3)?;
            within("motor constant at the steer axis (N m/A)", supply.constant_nm_a, 1e-3, 100.0)
        })?;
        self.stop.map_or(Ok(()), |stop| stop.check())?;
        Ok(self.friction.check()?)
    }

    /// Whether the motor delivers exactly the commanded torque.
    pub fn exact(&self) -> bool {
        *self == Self { friction: self.friction, stop: self.stop, ..Self::default() }
    }
}

/// State of the actuator: delayed commands and the drive's response. All zero at the start.
///
/// The response to a torque held for a control period is computed in closed form, so it is exact at every
/// stage of an integration step.
#[derive(Clone, Debug)]
pub struct Actuator {
    on_their_way: VecDeque<f64>,
    /// Torque to which the response tends in this period, and torque at the period's start \[N m\].
    target_nm: f64,
    began_nm: f64,
}

impl Actuator {
    /// State at zero torque.
    pub fn new(config: &ActuatorConfig) -> Self {
        let on_their_way = vec![0.0; usize::from(config.delay_ticks)].into();
        Self { on_their_way, target_nm: 0.0, began_nm: 0.0 }
    }

    /// Begins a control period with the torque commanded at its start \[N m\]; the previous period lasted
    /// `period_s`.
    pub fn command(&mut self, config: &ActuatorConfig, period_s: f64, torque_nm: f64) {
        self.began_nm = self.response(config, period_s);
        let arrived = match self.on_their_way.pop_front() {
            Some(arrived) => {
                self.on_their_way.push_back(torque_nm);
                arrived
            }
            None => torque_nm,
        };
        self.target_nm = arrived * config.scale;
    }

    /// Torque on the steer axis \[N m\] `elapsed_s` into the control period, at a steer rate \[rad/s\];
    /// without friction.
    pub fn torque(&self, config: &ActuatorConfig, elapsed_s: f64, rate: f64) -> f64 {
        let mut torque = self.response(config, elapsed_s);
        if let Some(supply) = &config.supply {
            let (least, largest) = supply.limits(rate);
            torque = torque.max(least).min(largest);
        }
        config.limit_nm.map_or(torque, |limit| torque.clamp(-limit, limit))
    }

    /// Response of the drive before limits.
    fn response(&self, config: &ActuatorConfig, elapsed_s: f64) -> f64 {
        if config.time_constant_s == 0.0 {
            return self.target_nm;
        }
        let left = libm::exp(-elapsed_s / config.time_constant_s);
        self.target_nm + (self.began_nm - self.target_nm) * left
    }
}
