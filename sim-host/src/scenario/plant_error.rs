//! Errors of a scenario's sensors and motor.

use super::ticks::TicksError;
use crate::plant::Sensor;
use crate::plant::catalogue::ActuatorFileError;
use crate::plant::sensor_file::{EXACT, SHIPPED, SensorFileError, table_of};
use crate::range::RangeError;

/// An unknown name of a sensor.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown sensor `{0}`; expected imu, {known}", known = Sensor::ALL.map(Sensor::name).join(", "))]
pub struct UnknownSensorError(pub String);

/// Sensors or a motor that cannot be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlantChoiceError {
    /// A change without a sensor that is not a model alone.
    #[error("a change needs a `sensor`, or a `model` alone")]
    NoSensor,
    /// A change without a value.
    #[error("a change needs a value")]
    NoValue,
    /// An unknown sensor.
    #[error(transparent)]
    Sensor(#[from] UnknownSensorError),
    /// An axis of a sensor that has one axis.
    #[error("it has one axis only; leave out `{0}`")]
    OneAxis(String),
    /// An unknown axis.
    #[error("no axis `{axis}`; it has {}", known.join(", "))]
    Axis {
        /// The axis.
        axis: String,
        /// The sensor's axes.
        known: &'static [&'static str],
    },
    /// Another value than the bias for a single axis.
    #[error("only bias can differ between axes; everything else applies to all of them")]
    BiasOnly,
    /// A text that is neither a change nor a model.
    #[error(
        "`{0}` is neither NAME:KEY=VALUE,... nor a FILE nor a built-in model: {EXACT}, {known}",
        known = SHIPPED.map(|(shipped, _)| shipped).join(", ")
    )]
    Model(String),
    /// A model without the sensor's table.
    #[error(
        "the model {name} has no table {}; it has {}",
        table_of(*sensor), known.iter().map(|one| table_of(*one)).collect::<Vec<_>>().join(", ")
    )]
    Table {
        /// The model.
        name: String,
        /// The sensor.
        sensor: Sensor,
        /// Sensors of its tables.
        known: Vec<Sensor>,
    },
    /// A wrong file of a sensor model.
    #[error(transparent)]
    SensorFile(#[from] SensorFileError),
    /// A model with numbers that do not fit the control period.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A wrong file of a motor.
    #[error(transparent)]
    ActuatorFile(#[from] ActuatorFileError),
    /// A time that is no number of control periods.
    #[error("{key} {error}")]
    Ticks {
        /// The key.
        key: &'static str,
        /// The error.
        error: TicksError,
    },
    /// A part of the motor's supply is missing.
    #[error("voltage, resistance and constant must be given together")]
    Supply,
    /// An error of one sensor, model or motor.
    #[error("{place}: {error}")]
    At {
        /// The sensor with its axis, the model or the motor.
        place: String,
        /// The error.
        error: Box<Self>,
    },
}

impl PlantChoiceError {
    /// The error, of the sensor, model or motor `place`.
    pub(super) fn at(self, place: &str) -> Self {
        Self::At { place: place.into(), error: Box::new(self) }
    }
}
