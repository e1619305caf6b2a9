//! The plant between bicycle and controller: sensors, the steer motor, and faults of either. `docs/plant.md`.

mod actuator;
mod error;
mod fault;
mod fault_text;
mod fitted;
mod friction;
mod idle_fault;
mod reading;
mod sensor;
mod sensor_suite;
mod stop;

pub use actuator::{Actuator, ActuatorConfig, Supply};
pub use error::PlantError;
pub use fault::{Channel, Fault, FaultState, Kind};
pub use fault_text::{FaultFormError, FaultTextError};
pub use fitted::{FittedErrors, OCTAVES_HZ};
pub use friction::Friction;
pub use reading::{Frame, Imu, Odometry, Reading, Sensor};
pub use sensor::{Before, ImuMount, SensorConfig, SensorModel, SensorRng, SensorState};
pub use sensor_suite::faulty;
pub use sensor_suite::{Held, Measured, SensorSuite};
pub use stop::SteerStop;

/// Sensors, actuator and faults. The default is exact, without delay or fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plant {
    /// The sensors.
    pub sensors: SensorConfig,
    /// The motor, and the steer's friction and end-stop.
    pub actuator: ActuatorConfig,
    /// Faults, in the order in which they act.
    pub faults: Vec<Fault>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Plant {
    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), PlantError> {
        self.sensors.check().map_err(|error| error.of("plant.sensors"))?;
        self.actuator.check().map_err(|error| error.of("plant.actuator"))
    }

    /// Whether sensors and motor are exact and without faults; friction and end-stop do not count.
    pub fn exact(&self) -> bool {
        self.reads_exactly() && self.actuator.exact()
    }

    /// Whether sensors are exact and nothing has a fault.
    pub fn reads_exactly(&self) -> bool {
        self.sensors.exact() && self.faults.is_empty()
    }

    /// Whether the mirror image of every ride is also a ride.
    pub fn mirrors(&self) -> bool {
        self.sensors.mirrors() && self.faults.is_empty()
    }

    /// The same plant with all sensors delayed by another `ticks` control periods.
    pub fn delayed(&self, ticks: u16) -> Self {
        let mut later = self.clone();
        for sensor in Sensor::ALL {
            let delay_ticks = &mut later.sensors.model_mut(sensor).delay_ticks;
            *delay_ticks = delay_ticks.saturating_add(ticks);
        }
        later
    }

    /// Exact value of a sensor in its mounting.
    fn truth(&self, sensor: Sensor, reading: &Reading) -> [f64; 3] {
        let imu = &self.sensors.imu;
        match sensor {
            Sensor::Gyro | Sensor::Accel if imu.turned_rad != [0.0; 3] => imu.rotated(reading.of(sensor)),
            _ => reading.of(sensor),
        }
    }
}
