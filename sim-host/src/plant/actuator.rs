//! The motor with its drive and gear: from the commanded torque to the torque on the steer axis.

use super::{Friction, PlantError, SteerStop};
use crate::range::within;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A supply voltage and the motor it drives, seen at the steer axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Supply {
    /// Voltage \[V\].
    pub voltage_v: f64,
    /// Winding resistance \[ohm\].
    pub resistance_ohm: f64,
    /// Torque constant times gear ratio \[N m/A\], which is the voltage constant at the steer axis
    /// \[V s/rad\] too.
    pub constant_nm_a: f64,
}

impl Supply {
    /// Least and largest torque at a steer rate \[rad/s\]: `k (-V - k q) / R` and `k (V - k q) / R`.
    fn limits(&self, rate: f64) -> (f64, f64) {
        let k = self.constant_nm_a;
        let per_volt = k / self.resistance_ohm;
        (per_volt * (-self.voltage_v - k * rate), per_volt * (self.voltage_v - k * rate))
    }
}

/// How the motor departs from giving the torque it is asked for, and the friction and end-stop of the
/// steer. The default does not, and has neither.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ActuatorConfig {
    /// Control periods from the command to the drive.
    pub delay_ticks: u16,
    /// Torque given over torque asked for: the torque constant's error; negative is wired the wrong way.
    pub scale: f64,
    /// Time constant of the torque's first-order response \[s\]; 0 is at once.
    pub time_constant_s: f64,
    /// Largest torque either way \[N m\]; null is no limit.
    pub limit_nm: Option<f64>,
    /// What the voltage allows; null is everything.
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
    /// Names the value and its range.
    pub fn check(&self) -> Result<(), PlantError> {
        let all = || {
            within("actuator delay (control periods)", f64::from(self.delay_ticks), 0.0, 1000.0)?;
            within("actuator scale", self.scale, -10.0, 10.0)?;
            within("actuator time constant (s)", self.time_constant_s, 0.0, 10.0)?;
            self.limit_nm.map_or(Ok(()), |limit| within("actuator limit (N m)", limit, 0.0, 1000.0))?;
            self.supply.map_or(Ok(()), |supply| {
                within("supply voltage (V)", supply.voltage_v, 1.0, 1000.0)?;
                within("motor resistance (ohm)", supply.resistance_ohm, 1e-3, 1e3)?;
                within("motor constant at the steer axis (N m/A)", supply.constant_nm_a, 1e-3, 100.0)
            })
        };
        all().map_err(PlantError)?;
        self.stop.map_or(Ok(()), |stop| stop.check())?;
        self.friction.check()
    }

    /// Whether the motor gives exactly what it is asked for.
    pub fn exact(&self) -> bool {
        *self == Self { friction: self.friction, stop: self.stop, ..Self::default() }
    }
}

/// One motor: commands on their way, and the response under way. All zero at the start.
///
/// The response to a torque that is held for a control period is known in closed form, so it is as
/// exact at every stage of an integration step as the exponential.
#[derive(Clone, Debug)]
pub struct Actuator {
    on_their_way: VecDeque<f64>,
    /// The torque that the response tends to in this period, and where it began \[N m\].
    target_nm: f64,
    began_nm: f64,
}

impl Actuator {
    /// A motor at rest.
    pub fn new(config: &ActuatorConfig) -> Self {
        let on_their_way = vec![0.0; usize::from(config.delay_ticks)].into();
        Self { on_their_way, target_nm: 0.0, began_nm: 0.0 }
    }

    /// Begins a control period, `period_s` after the one before, with the torque commanded at its
    /// start \[N m\].
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

    /// The torque on the steer axis \[N m\] `elapsed_s` into the control period, at a steer rate
    /// \[rad/s\]; friction is not in it.
    pub fn torque(&self, config: &ActuatorConfig, elapsed_s: f64, rate: f64) -> f64 {
        let mut torque = self.response(config, elapsed_s);
        if let Some(supply) = &config.supply {
            let (least, largest) = supply.limits(rate);
            torque = torque.max(least).min(largest);
        }
        config.limit_nm.map_or(torque, |limit| torque.clamp(-limit, limit))
    }

    /// The drive's response, limits left out.
    fn response(&self, config: &ActuatorConfig, elapsed_s: f64) -> f64 {
        if config.time_constant_s == 0.0 {
            return self.target_nm;
        }
        let left = libm::exp(-elapsed_s / config.time_constant_s);
        self.target_nm + (self.began_nm - self.target_nm) * left
    }
}
