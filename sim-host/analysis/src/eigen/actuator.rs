//! Linear model of the motor and its gear.

use physics::range::{RangeError, within, within_key};

/// Deviation of the torque on the steer axis from the requested one, and the friction and inertia that motor,
/// gear and bearings add. The default is exact and adds none.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct LinearActuator {
    /// Delivered over requested torque.
    pub scale: f64,
    /// Delay from the command to the drive \[s\].
    pub delay_s: f64,
    /// Time constant of the torque's first-order response \[s\]; 0 is no lag.
    pub time_constant_s: f64,
    /// Viscous friction about the steer axis \[N m s/rad\].
    pub viscous_nm_s_rad: f64,
    /// Inertia about the steer axis in addition to the bicycle's: that of the rotor times the gear ratio
    /// squared \[kg m^2\].
    pub inertia_kg_m2: f64,
}

impl Default for LinearActuator {
    fn default() -> Self {
        Self { scale: 1.0, delay_s: 0.0, time_constant_s: 0.0, viscous_nm_s_rad: 0.0, inertia_kg_m2: 0.0 }
    }
}

impl LinearActuator {
    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), RangeError> {
        within("actuator scale", self.scale, -10.0, 10.0)?;
        within_key("actuator.delay_s", "actuator delay (s)", self.delay_s, 0.0, 1.0)?;
        within_key(
            "actuator.time_constant_s",
            "actuator time constant (s)",
            self.time_constant_s,
            0.0,
            10.0,
        )?;
        within_key(
            "actuator.viscous_nm_s_rad",
            "viscous friction (N m s/rad)",
            self.viscous_nm_s_rad,
            0.0,
            100.0,
        )?;
        within_key("actuator.inertia_kg_m2", "actuator inertia (kg m^2)", self.inertia_kg_m2, 0.0, 10.0)
    }
}

/// An actuator that can't be added to a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ActuatorError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A delay beside a rider's: the analysis allows one delayed signal.
    #[error("--actuator-delay cannot be combined with --rider")]
    TwoDelays,
}
