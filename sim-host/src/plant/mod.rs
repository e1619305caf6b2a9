//! What lies between the bicycle and the controller: sensors that measure it, the motor that turns
//! its steer, and what can be wrong with either. `docs/plant.md`.

mod actuator;
pub mod catalogue;
mod fault;
mod fault_text;
mod fitted;
mod friction;
mod random_stream;
mod reading;
mod sensor;
pub mod sensor_file;
mod sensor_suite;
mod stop;

pub use actuator::{Actuator, ActuatorConfig, Supply};
pub use fault::{Channel, Fault, FaultState, Kind};
pub use fitted::{FittedErrors, OCTAVES_HZ};
pub use friction::Friction;
pub use random_stream::RandomStream;
pub use reading::{Frame, Odometry, Reading, Sensor};
pub use sensor::{Before, ImuMount, SensorConfig, SensorDice, SensorModel, SensorState};
pub(crate) use sensor_suite::faulty;
pub use sensor_suite::{Held, Measured, SensorSuite};
pub use stop::SteerStop;

/// A value of the plant that can't be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct PlantError(pub String);

/// Everything between bicycle and controller. The default is exact, at once and without fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plant {
    /// The sensors.
    pub sensors: SensorConfig,
    /// The motor, the steer's friction and its end-stop.
    pub actuator: ActuatorConfig,
    /// What goes wrong, in the order in which it acts.
    pub faults: Vec<Fault>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Plant {
    /// Checks every value.
    ///
    /// # Errors
    /// Names the value and its range.
    pub fn check(&self) -> Result<(), PlantError> {
        self.sensors.check()?;
        self.actuator.check()
    }

    /// Whether sensors and motor are exact and nothing goes wrong; friction and an end-stop may be there.
    pub fn exact(&self) -> bool {
        self.sensors.exact() && self.actuator.exact() && self.faults.is_empty()
    }

    /// Whether the mirrored ride of every ride is one too.
    pub fn mirrors(&self) -> bool {
        self.sensors.mirrors() && self.faults.is_empty()
    }

    /// The same with all sensors later by `ticks` control periods.
    pub fn delayed(&self, ticks: u16) -> Self {
        let mut later = self.clone();
        for sensor in Sensor::ALL {
            let delay_ticks = &mut later.sensors.model_mut(sensor).delay_ticks;
            *delay_ticks = delay_ticks.saturating_add(ticks);
        }
        later
    }

    /// What an exact sensor would say where it sits.
    fn truth(&self, sensor: Sensor, reading: &Reading) -> [f64; 3] {
        let imu = &self.sensors.imu;
        match sensor {
            Sensor::Gyro | Sensor::Accel if imu.turned_rad != [0.0; 3] => imu.seen(reading.of(sensor)),
            _ => reading.of(sensor),
        }
    }
}
