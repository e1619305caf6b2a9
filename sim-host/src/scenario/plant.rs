//! The plant of a scenario: changes to exact sensors and an exact motor, in seconds, to the models of a ride in control
//! periods.

use super::content::{Content, NONE, NameOr, name_or_table};
use super::error::ScenarioError;
use super::is_default;
use super::plant_error::{PlantChoiceError, UnknownSensorError};
use super::ticks::{LONGEST_S, LONGEST_SENSOR_S, whole_ticks};
use crate::plant::sensor_file::{EXACT, SHIPPED, SensorFile};
use crate::plant::{
    ActuatorConfig, Fault, ImuMount, Plant, Sensor, SensorConfig, SensorModel, SteerStop, Supply, catalogue,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Sensors, motor and faults; the default is exact.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PlantChoice {
    /// Sensor errors, in the order in which they are applied.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<SensorChange>,
    /// Position and orientation of the IMU.
    #[serde(skip_serializing_if = "is_default")]
    pub imu: ImuMount,
    /// Motor, friction of the steer and end stop.
    #[serde(deserialize_with = "name_or_table", skip_serializing_if = "is_default")]
    #[schemars(with = "NameOr<ActuatorChoice>")]
    pub actuator: ActuatorChoice,
    /// Faults as text, for example "gyro.x:stuck@1.5s..2s", in the order in which they act.
    #[schemars(with = "Vec<String>")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<Fault>,
    /// Seed of noise and dropouts.
    pub seed: u64,
}

/// Change of sensor models: a model of several sensors, or values of one sensor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(inline)]
pub struct SensorChange {
    /// The sensor: gyro, accel, steer, ...; absent for a model of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
    /// Its axis: x, y, z; absent for all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// Model of real sensors: built-in name, "exact", a file, or a file's content.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<Content<SensorFile>>,
    /// Time from the measurement to its arrival \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<f64>,
    /// Time between samples \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every_s: Option<f64>,
    /// Added value, in the sensor's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias: Option<f64>,
    /// Measured over true value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Standard deviation of white noise, in the sensor's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
    /// Quantisation step, in the sensor's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quantum: Option<f64>,
    /// Largest magnitude that the sensor reports, in its unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<f64>,
    /// Probability that a sample is lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dropout: Option<f64>,
}

/// The motor, the friction of the steer and its end stop: a model and changes of its values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ActuatorChoice {
    /// Built-in name or file, or a file's content; absent or "none" for an exact motor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<Content<ActuatorConfig>>,
    /// Delay from the command to the drive \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<f64>,
    /// Time constant of the torque's response \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_constant_s: Option<f64>,
    /// Delivered over commanded torque.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Largest torque \[N m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_nm: Option<f64>,
    /// Viscous friction of the steer \[N m s/rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscous_nm_s_rad: Option<f64>,
    /// Coulomb friction of the steer \[N m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coulomb_nm: Option<f64>,
    /// Steer rate at which Coulomb friction reaches 71 % \[rad/s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub creep_rad_s: Option<f64>,
    /// Steer angle of the end stop on either side \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_rad: Option<f64>,
    /// Supply voltage; together with resistance and constant \[V\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voltage_v: Option<f64>,
    /// Winding resistance \[ohm\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resistance_ohm: Option<f64>,
    /// Torque constant times gear ratio \[N m/A\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constant_nm_a: Option<f64>,
}

impl From<String> for ActuatorChoice {
    fn from(name: String) -> Self {
        Self { model: Some(Content::Named(name)), ..Self::default() }
    }
}

impl PlantChoice {
    /// The plant with control periods of `period_s`.
    ///
    /// # Errors
    /// States the key, the value and its range, or the file.
    pub fn resolve(&self, period_s: f64) -> Result<Plant, ScenarioError> {
        let mut sensors = SensorConfig::default();
        sensors.imu = self.imu;
        for change in &self.sensors {
            change.apply(&mut sensors, period_s).map_err(|e| ScenarioError::value("plant.sensors", e))?;
        }
        let name = self.actuator.model.as_ref().and_then(Content::name).unwrap_or("model");
        let wrong = |e: PlantChoiceError| ScenarioError::value("plant.actuator", e.at(name));
        let actuator = self.actuator.resolve(period_s).map_err(wrong)?;
        let plant = Plant { sensors, actuator, faults: self.faults.clone(), seed: self.seed };
        plant.check()?;
        Ok(plant)
    }

    /// Names that can be files.
    pub(super) fn files(&self) -> impl Iterator<Item = &str> {
        let sensors = self.sensors.iter().filter_map(|change| change.model.as_ref()?.name());
        sensors.chain(self.actuator.model.as_ref().and_then(Content::name))
    }

    /// Puts the contents of files in the places of their names.
    pub(super) fn include(&mut self) -> Result<(), PlantChoiceError> {
        for change in &mut self.sensors {
            if let Some(Content::Named(name)) = &change.model
                && is_file(name)
            {
                change.model = Some(Content::Given(Box::new(SensorFile::load(name)?)));
            }
        }
        if let Some(Content::Named(name)) = &self.actuator.model
            && !catalogue::shipped_names().iter().any(|shipped| shipped == name)
        {
            let config = catalogue::load(name)?;
            self.actuator.model = Some(Content::Given(Box::new(config)));
        }
        Ok(())
    }
}

/// Whether a sensor model's name is that of a file.
fn is_file(name: &str) -> bool {
    name != EXACT && !SHIPPED.iter().any(|(shipped, _)| *shipped == name)
}

/// The sensor with this name.
///
/// # Errors
/// Lists the names.
pub(super) fn sensor_named(name: &str) -> Result<Sensor, UnknownSensorError> {
    let known = Sensor::ALL.into_iter().find(|sensor| sensor.name() == name);
    known.ok_or_else(|| UnknownSensorError(name.into()))
}

impl SensorChange {
    /// Applies the change.
    fn apply(&self, sensors: &mut SensorConfig, period_s: f64) -> Result<(), PlantChoiceError> {
        let Some(name) = &self.sensor else {
            let others = Self { model: None, ..self.clone() } != Self::default();
            return match &self.model {
                Some(model) if !others => {
                    let name = model.name().unwrap_or("model");
                    apply_file(model, sensors, period_s).map_err(|e| e.at(name))
                }
                _ => Err(PlantChoiceError::NoSensor),
            };
        };
        let place = self.axis.as_ref().map_or(name.clone(), |axis| format!("{name}.{axis}"));
        if *self == (Self { sensor: self.sensor.clone(), axis: self.axis.clone(), ..Self::default() }) {
            return Err(PlantChoiceError::NoValue.at(&place));
        }
        self.apply_to(sensor_named(name)?, sensors, period_s).map_err(|e| e.at(&place))
    }

    fn apply_to(
        &self,
        sensor: Sensor,
        sensors: &mut SensorConfig,
        period_s: f64,
    ) -> Result<(), PlantChoiceError> {
        let axes = sensor.axes();
        let axis = self.axis.as_ref().map(|axis| {
            let known = axes.iter().position(|known| known == axis);
            known.ok_or_else(|| match axes {
                [] => PlantChoiceError::OneAxis(axis.clone()),
                known => PlantChoiceError::Axis { axis: axis.clone(), known },
            })
        });
        let axis = axis.transpose()?;
        let others = Self { sensor: None, axis: None, bias: None, ..self.clone() } != Self::default();
        if axis.is_some() && others {
            return Err(PlantChoiceError::BiasOnly);
        }
        let model = sensors.model_mut(sensor);
        if let Some(content) = &self.model {
            *model = model_of(sensor, content, period_s)?;
        }
        match (self.bias, axis) {
            (Some(bias), Some(axis)) => model.bias[axis] = bias,
            (Some(bias), None) => model.bias.iter_mut().take(axes.len().max(1)).for_each(|axis| *axis = bias),
            (None, _) => {}
        }
        let ticks = |key, time_s| {
            whole_ticks(time_s, period_s, LONGEST_SENSOR_S)
                .map_err(|error| PlantChoiceError::Ticks { key, error })
        };
        set(&mut model.delay_ticks, self.delay_s.map(|s| ticks("delay", s)).transpose()?);
        set(&mut model.every_ticks, self.every_s.map(|s| ticks("every", s)).transpose()?);
        set(&mut model.scale, self.scale);
        set(&mut model.noise, self.noise);
        set(&mut model.quantum, self.quantum);
        set(&mut model.dropout, self.dropout);
        model.range = self.range.or(model.range);
        Ok(())
    }
}

fn set<T>(place: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *place = value;
    }
}

/// Applies all models of a file.
fn apply_file(
    model: &Content<SensorFile>,
    sensors: &mut SensorConfig,
    period_s: f64,
) -> Result<(), PlantChoiceError> {
    let name = match model {
        Content::Given(file) => return Ok(file.apply(sensors, period_s)?),
        Content::Named(name) if name == EXACT => return Ok(()),
        Content::Named(name) => name,
    };
    if is_file(name) && !Path::new(name).exists() {
        return Err(PlantChoiceError::Model(name.clone()));
    }
    Ok(SensorFile::load(name)?.apply(sensors, period_s)?)
}

/// A file's model of one sensor.
fn model_of(
    sensor: Sensor,
    content: &Content<SensorFile>,
    period_s: f64,
) -> Result<SensorModel, PlantChoiceError> {
    let (name, file) = match content {
        Content::Named(name) if name == EXACT => return Ok(SensorModel::default()),
        Content::Named(name) => (&**name, &SensorFile::load(name)?),
        Content::Given(file) => ("in the scenario", &**file),
    };
    let numbers = file.of(sensor).ok_or_else(|| PlantChoiceError::Table {
        name: name.into(),
        sensor,
        known: file.tables().map(|(sensor, _)| sensor).collect(),
    })?;
    Ok(numbers.model(period_s)?)
}

impl ActuatorChoice {
    fn resolve(&self, period_s: f64) -> Result<ActuatorConfig, PlantChoiceError> {
        let mut config = match &self.model {
            Some(Content::Given(config)) => **config,
            Some(Content::Named(name)) => catalogue::load(name)?,
            None => catalogue::load(NONE)?,
        };
        let ticks = |time_s| {
            whole_ticks(time_s, period_s, LONGEST_S)
                .map_err(|error| PlantChoiceError::Ticks { key: "delay", error })
        };
        set(&mut config.delay_ticks, self.delay_s.map(ticks).transpose()?);
        set(&mut config.time_constant_s, self.time_constant_s);
        set(&mut config.scale, self.scale);
        set(&mut config.friction.viscous_nm_s_rad, self.viscous_nm_s_rad);
        set(&mut config.friction.coulomb_nm, self.coulomb_nm);
        set(&mut config.friction.creep_rad_s, self.creep_rad_s);
        config.limit_nm = self.limit_nm.or(config.limit_nm);
        config.stop = self.stop_rad.map(SteerStop::at).or(config.stop);
        match (self.voltage_v, self.resistance_ohm, self.constant_nm_a) {
            (None, None, None) => {}
            (Some(voltage_v), Some(resistance_ohm), Some(constant_nm_a)) => {
                config.supply = Some(Supply { voltage_v, resistance_ohm, constant_nm_a });
            }
            _ => return Err(PlantChoiceError::Supply),
        }
        Ok(config)
    }
}
