//! The options for sensor and motor errors and for faults.

use crate::plant::sensor_file::{EXACT, SHIPPED, SensorFile, table_of};
use crate::plant::{
    ActuatorConfig, Fault, ImuMount, Plant, Sensor, SensorConfig, SensorModel, SteerStop, Supply, catalogue,
};
use crate::range::time;
use std::path::Path;

/// Longest delay of the motor, and of all sensors in common \[s\].
pub(super) const LONGEST_S: f64 = 1.0;
/// No error and no fault: the value for a sweep's reference cell.
const NONE: &str = "none";
/// Longest delay of one sensor \[s\].
const LONGEST_SENSOR_S: f64 = 5.0;

#[derive(clap::Args)]
pub(super) struct PlantArgs {
    /// Sensor errors: models of real sensors by name or FILE, several joined by +; or NAME:KEY=VALUE,... for example
    /// gyro:noise=0.01,bias=0.02,delay=5ms or front-wheel:model=hall-16; or none; may be repeated
    #[arg(long, value_name = "MODEL|NAME:KEY=VALUE,...", allow_hyphen_values = true)]
    sensor: Vec<String>,
    /// Motor, steer friction and end stop: none, davis, gazelle, a FILE, and KEY=VALUE to change values
    #[arg(long, value_name = "NAME|FILE|KEY=VALUE,...", default_value = "none", allow_hyphen_values = true)]
    actuator: String,
    /// Inject a fault, for example gyro.x:stuck@1.5s..2s or motor:dead@1s, or none; may be repeated
    #[arg(long, value_name = "CHANNEL:KIND@FROM..TO", allow_hyphen_values = true)]
    fault: Vec<String>,
    /// Seed of noise and dropouts; each ride derives its own from its initial state
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
}

impl PlantArgs {
    /// Values that can name a file.
    pub(super) fn files(&self) -> impl Iterator<Item = &str> {
        self.sensor.iter().chain([&self.actuator]).map(String::as_str)
    }

    /// The requested plant with a control period of `period_s`.
    pub(super) fn plant(&self, period_s: f64) -> Result<Plant, String> {
        let mut sensors = SensorConfig::default();
        for text in self.sensor.iter().filter(|text| *text != NONE) {
            depart(&mut sensors, text, period_s).map_err(|e| format!("--sensor {text}: {e}"))?;
        }
        let actuator =
            actuator(&self.actuator, period_s).map_err(|e| format!("--actuator {}: {e}", self.actuator))?;
        let faults = self.fault.iter().filter(|text| *text != NONE).map(|text| text.parse::<Fault>());
        let faults = faults.collect::<Result<_, _>>().map_err(|e| format!("--fault: {e}"))?;
        let plant = Plant { sensors, actuator, faults, seed: self.seed };
        plant.check().map_err(|e| e.to_string())?;
        Ok(plant)
    }
}

/// Number of control periods in a time, which must be an integer.
pub(super) fn whole_ticks(name: &str, time_s: f64, period_s: f64, most_s: f64) -> Result<u16, String> {
    let ticks = time_s / period_s;
    // The ranges refer to a control period of 1 ms.
    if ticks > most_s * 1e3 {
        return Err(format!("{name} {} ms is outside 0 to {} ms", time_s * 1e3, most_s * period_s * 1e6));
    }
    if (ticks - ticks.round()).abs() > 1e-6 {
        let near = |n: f64| format!("{} ms", n * period_s * 1e3);
        return Err(format!(
            "{name} {} ms is not a whole number of control periods of {} ms; nearest are {} and {}",
            time_s * 1e3,
            period_s * 1e3,
            near(ticks.floor()),
            near(ticks.ceil())
        ));
    }
    Ok(ticks.round() as u16)
}

/// The pairs of `KEY=VALUE,...`.
pub(super) fn pairs(text: &str) -> impl Iterator<Item = Result<(&str, &str), String>> {
    text.split(',').map(|pair| pair.split_once('=').ok_or_else(|| format!("`{pair}` is not KEY=VALUE")))
}

fn number(key: &str, value: &str) -> Result<f64, String> {
    value.trim().parse().map_err(|_| format!("{key}: `{value}` is not a number"))
}

fn ticks(key: &str, value: &str, period_s: f64, most_s: f64) -> Result<u16, String> {
    whole_ticks(key, time(value, most_s)?, period_s, most_s)
}

/// Applies one `NAME[.AXIS]:KEY=VALUE,...`.
fn depart(sensors: &mut SensorConfig, text: &str, period_s: f64) -> Result<(), String> {
    let Some((place, settings)) = text.split_once(':') else {
        return text.split('+').try_for_each(|name| models(sensors, name, period_s));
    };
    if place == "imu" {
        return pairs(settings)
            .try_for_each(|pair| pair.and_then(|(key, value)| mount(&mut sensors.imu, key, value)));
    }
    let (name, axis) = place.split_once('.').map_or((place, None), |(name, axis)| (name, Some(axis)));
    let sensor = Sensor::ALL.into_iter().find(|sensor| sensor.name() == name).ok_or_else(|| {
        format!("unknown sensor `{name}`; expected imu, {}", Sensor::ALL.map(Sensor::name).join(", "))
    })?;
    let axes = sensor.axes();
    let axis = axis.map(|axis| {
        let known = axes.iter().position(|known| *known == axis);
        known.ok_or_else(|| match axes {
            [] => format!("{name} has one axis only; leave out `.{axis}`"),
            _ => format!("{name} has no axis `{axis}`; it has {}", axes.join(", ")),
        })
    });
    let axis = axis.transpose()?;
    let model = sensors.model_mut(sensor);
    for pair in pairs(settings) {
        let (key, value) = pair?;
        match (key, axis) {
            ("model", None) => *model = model_of(sensor, value, period_s)?,
            ("bias", Some(axis)) => model.bias[axis] = number(key, value)?,
            (_, Some(_)) => {
                return Err(format!("{key} applies to all axes; only bias can differ between them"));
            }
            ("bias", None) => {
                let bias = number(key, value)?;
                model.bias.iter_mut().take(axes.len().max(1)).for_each(|axis| *axis = bias);
            }
            ("delay", None) => model.delay_ticks = ticks(key, value, period_s, LONGEST_SENSOR_S)?,
            ("every", None) => model.every_ticks = ticks(key, value, period_s, LONGEST_SENSOR_S)?,
            ("scale", None) => model.scale = number(key, value)?,
            ("noise", None) => model.noise = number(key, value)?,
            ("quantum", None) => model.quantum = number(key, value)?,
            ("range", None) => model.range = Some(number(key, value)?),
            ("dropout", None) => model.dropout = number(key, value)?,
            _ => {
                return Err(format!(
                    "unknown key `{key}`; expected model=NAME|FILE, delay=TIME, every=TIME, noise, bias, scale, quantum, range, dropout"
                ));
            }
        }
    }
    Ok(())
}

/// Applies all models of a file.
fn models(sensors: &mut SensorConfig, name: &str, period_s: f64) -> Result<(), String> {
    if name == EXACT {
        return Ok(());
    }
    if !SHIPPED.iter().any(|(shipped, _)| *shipped == name) && !Path::new(name).exists() {
        let names: Vec<_> = SHIPPED.iter().map(|(shipped, _)| *shipped).collect();
        let names = names.join(", ");
        return Err(format!(
            "`{name}` is neither NAME:KEY=VALUE,... nor a FILE nor a built-in model: {EXACT}, {names}"
        ));
    }
    Ok(SensorFile::load(name).map_err(|e| e.to_string())?.apply(sensors, period_s)?)
}

/// A file's model of a sensor.
fn model_of(sensor: Sensor, name: &str, period_s: f64) -> Result<SensorModel, String> {
    if name == EXACT {
        return Ok(SensorModel::default());
    }
    let file = SensorFile::load(name).map_err(|e| e.to_string())?;
    let numbers = file.of(sensor).ok_or_else(|| {
        let tables: Vec<_> = file.tables().map(|(sensor, _)| table_of(sensor)).collect();
        format!("the model {name} has no table {}; it has {}", table_of(sensor), tables.join(", "))
    })?;
    Ok(numbers.model(period_s)?)
}

fn mount(imu: &mut ImuMount, key: &str, value: &str) -> Result<(), String> {
    let [x, y, z] = &mut imu.point_m;
    let [roll, pitch, yaw] = &mut imu.turned_rad;
    let place = match key {
        "x" => x,
        "y" => y,
        "z" => z,
        "roll" => roll,
        "pitch" => pitch,
        "yaw" => yaw,
        _ => {
            return Err(format!(
                "unknown key `{key}` of the imu; expected x, y, z in m, roll, pitch, yaw in rad"
            ));
        }
    };
    *place = number(key, value)?;
    Ok(())
}

/// Parses the actuator from `NAME|FILE|KEY=VALUE,...`.
fn actuator(text: &str, period_s: f64) -> Result<ActuatorConfig, String> {
    let (name, settings) = match text.split_once(',') {
        _ if text.split(',').next().is_some_and(|first| first.contains('=')) => ("none", Some(text)),
        Some((name, settings)) => (name, Some(settings)),
        None => (text, None),
    };
    let mut config = catalogue::load(name).map_err(|e| e.to_string())?;
    let mut supply = [None; 3];
    for pair in settings.into_iter().flat_map(pairs) {
        let (key, value) = pair?;
        match key {
            "delay" => config.delay_ticks = ticks(key, value, period_s, LONGEST_S)?,
            "time-constant" => config.time_constant_s = time(value, 10.0)?,
            "scale" => config.scale = number(key, value)?,
            "limit" => config.limit_nm = Some(number(key, value)?),
            "viscous" => config.friction.viscous_nm_s_rad = number(key, value)?,
            "coulomb" => config.friction.coulomb_nm = number(key, value)?,
            "creep" => config.friction.creep_rad_s = number(key, value)?,
            "stop" => config.stop = Some(SteerStop::at(number(key, value)?)),
            "voltage" => supply[0] = Some(number(key, value)?),
            "resistance" => supply[1] = Some(number(key, value)?),
            "constant" => supply[2] = Some(number(key, value)?),
            _ => {
                return Err(format!(
                    "unknown key `{key}`; expected delay=TIME, time-constant=TIME, scale, limit, viscous, coulomb, creep, \
                     stop, voltage, resistance, constant"
                ));
            }
        }
    }
    match supply {
        [None, None, None] => {}
        [Some(voltage_v), Some(resistance_ohm), Some(constant_nm_a)] => {
            config.supply = Some(Supply { voltage_v, resistance_ohm, constant_nm_a });
        }
        _ => return Err("voltage, resistance and constant must be given together".into()),
    }
    Ok(config)
}
