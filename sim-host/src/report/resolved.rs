//! The full configuration of a result, contained in every output.

use crate::basin::{Axis, Method, Search};
use crate::bicycle::{KEYS, Parameters, catalogue::Bicycle};
use crate::parameters::departing;
use crate::plant::{ActuatorConfig, ImuMount, Plant, Sensor, SensorModel};
use crate::ride::{Assist, FallCriterion};
use crate::rider::{Gains, Outside};
use crate::scenario::{LoadedRider, Preset, Resolved};
use control::estimate::{EstimateConfig, Source};
use control::{Capsize, Config, Law};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// The bicycle of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedBicycle {
    /// Name, FILE or FILE#NAME as given.
    pub name: String,
    /// Source of the values.
    pub source: Option<String>,
    /// The file's remark, and its unused entries.
    pub note: Option<String>,
    /// Whether a rider's body is part of the rear frame; null if the file does not say.
    pub rider_included: Option<bool>,
    /// Doubts about the values.
    pub warnings: Vec<String>,
    /// Standard deviations of the values that have one, SI units.
    pub uncertainties: BTreeMap<&'static str, f64>,
    /// The values, symbols of Meijaard et al. 2007, SI units.
    pub parameters: BTreeMap<&'static str, f64>,
}

impl ResolvedBicycle {
    /// The bicycle for an output.
    pub fn new(bicycle: &Bicycle) -> Self {
        Self {
            name: bicycle.name.clone(),
            source: bicycle.source.clone(),
            note: bicycle.note.clone(),
            rider_included: bicycle.rider_included,
            warnings: bicycle.warnings.clone(),
            uncertainties: uncertainties(bicycle),
            parameters: parameters(&bicycle.parameters),
        }
    }
}

fn uncertainties(bicycle: &Bicycle) -> BTreeMap<&'static str, f64> {
    let all = bicycle.measured.iter().flat_map(|measured| KEYS.into_iter().zip(measured.deviations()));
    all.filter(|(_, sd)| *sd > 0.0).collect()
}

fn parameters(p: &Parameters) -> BTreeMap<&'static str, f64> {
    KEYS.into_iter().zip(p.to_values()).collect()
}

/// The roll-rate law of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedLaw {
    /// Name, or file as given.
    pub name: String,
    /// Points of a table: speed \[m/s\], gain \[N m s/rad\]; null for a formula.
    pub points: Option<Vec<(f32, f32)>>,
}

impl ResolvedLaw {
    /// The law for an output, under its name on the command line.
    pub fn new(name: &str, law: &Law) -> Self {
        let points = match law {
            Law::Table(table) => Some(table.points().to_vec()),
            _ => None,
        };
        Self { name: name.into(), points }
    }
}

/// The capsize term of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedCapsize {
    /// Roll-angle gain per speed above `v_max_m_s` \[N s/rad\].
    pub k_c_n_s_rad: f32,
    /// Speed up to which there is no torque \[m/s\].
    pub v_max_m_s: f32,
}

impl ResolvedCapsize {
    /// The capsize term for an output; `None` if it is off.
    pub fn new(capsize: &Capsize) -> Option<Self> {
        let Capsize { k_c, v_max_m_s } = *capsize;
        capsize.is_on().then_some(Self { k_c_n_s_rad: k_c, v_max_m_s })
    }
}

/// The neuromuscular dynamics of a result's rider.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedMuscles {
    /// Undamped natural frequency \[rad/s\].
    pub omega_rad_s: f64,
    /// Damping ratio.
    pub zeta: f64,
}

/// Gains at one speed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedGains {
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// The gains: N m per rad, rad s, rad/s, rad/s^2 (roll, then steer), rad (heading), m (lateral
    /// offset).
    pub gains: BTreeMap<&'static str, f64>,
}

impl ResolvedGains {
    /// The gains for an output.
    pub fn new(speed_m_s: f64, gains: &Gains) -> Self {
        Self { speed_m_s, gains: crate::rider::KEYS.into_iter().zip(gains.0).collect() }
    }
}

/// The rider of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedRider {
    /// Name, or FILE as given.
    pub name: String,
    /// Source of the gains.
    pub source: Option<String>,
    /// Method that makes them functions of speed.
    #[schemars(extend("enum" = ["regression", "mean", "best", "spline"]))]
    pub gains: &'static str,
    /// Neural delay \[s\].
    pub delay_s: f64,
    /// "extrapolate" or "hold": the gains beyond the outermost points.
    pub outside: &'static str,
    /// The neuromuscular dynamics.
    pub muscles: ResolvedMuscles,
    /// Points of the piecewise linear gains.
    pub points: Vec<ResolvedGains>,
}

impl ResolvedRider {
    /// The rider for an output.
    pub fn new(loaded: &LoadedRider) -> Self {
        let LoadedRider { rider, table, fit } = loaded;
        Self {
            name: table.name.clone(),
            source: table.source.clone(),
            gains: fit.name(),
            delay_s: rider.delay_s,
            outside: match rider.schedule.outside() {
                Outside::Extrapolate => "extrapolate",
                Outside::Hold => "hold",
            },
            muscles: ResolvedMuscles {
                omega_rad_s: rider.neuromuscular.omega_rad_s,
                zeta: rider.neuromuscular.zeta,
            },
            points: rider.schedule.points().iter().map(|(v, k)| ResolvedGains::new(*v, k)).collect(),
        }
    }

    /// A short label, for titles.
    pub fn label(&self) -> String {
        let ms = (self.delay_s * 1e9).round() / 1e6;
        format!("rider {} ({} gains, {ms} ms)", self.name, self.gains)
    }
}

/// Sensors, motor and faults of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedPlant {
    /// The sensors with errors, by name; all others are exact.
    pub sensors: BTreeMap<&'static str, SensorModel>,
    /// Position and orientation of the IMU.
    pub imu: ImuMount,
    /// The motor and the friction of the steer.
    pub actuator: ActuatorConfig,
    /// The injected faults in the form of `--fault`, in the order in which they act.
    pub faults: Vec<String>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl ResolvedPlant {
    /// The plant for an output.
    pub fn new(plant: &Plant) -> Self {
        let departing = Sensor::ALL.into_iter().map(|sensor| (sensor.name(), *plant.sensors.model(sensor)));
        Self {
            sensors: departing.filter(|(_, model)| *model != SensorModel::default()).collect(),
            imu: plant.sensors.imu,
            actuator: plant.actuator,
            faults: plant.faults.iter().map(ToString::to_string).collect(),
            seed: plant.seed,
        }
    }
}

/// The conditions of a result, with defaults filled in.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedConfig {
    /// "thesis" or "product".
    pub preset: String,
    /// The bicycle.
    pub bicycle: ResolvedBicycle,
    /// The rider; null for a rigid rider, hands off.
    pub rider: Option<ResolvedRider>,
    /// The law.
    pub law: ResolvedLaw,
    /// "none", "firmware" or "ideal".
    pub assist: &'static str,
    /// "front", "rear" or "initial".
    pub schedule_speed: String,
    /// "euler" or "body".
    pub imu: String,
    /// Torque limit \[N m\]; null if off.
    pub torque_limit_nm: Option<f32>,
    /// Limit of the torque's rise \[N m/s\]; null if off. The limit of its fall is `limits.fall_nm_s` of `parameters`.
    pub rate_limit_nm_s: Option<f32>,
    /// Taper below walking speed: torque zero at the first speed, full at the second \[m/s\].
    pub taper_m_s: Option<(f32, f32)>,
    /// Delay of the simulated sensors \[s\].
    pub sensor_delay_s: f64,
    /// Errors of sensors and motor.
    pub plant: ResolvedPlant,
    /// Firmware parameters that differ from those of the published conditions, by name.
    pub parameters: BTreeMap<String, String>,
    /// Control rate \[Hz\]; null for the continuous ideal law.
    pub control_rate_hz: Option<f32>,
    /// Integration step \[s\].
    pub step_s: f64,
    /// When a ride counts as fallen.
    pub fall: FallCriterion,
    /// Time limit of a ride \[s\].
    pub time_limit_s: f64,
    /// Doubts about rider, sensors and files, and faults without effect.
    pub warnings: Vec<String>,
    /// A ride has recovered if, in its last second, roll and steer stay below this fraction of their maxima.
    pub recovered_below: f64,
}

impl ResolvedConfig {
    /// The configuration for an output.
    pub fn new(resolved: &Resolved) -> Self {
        let c = &resolved.conditions;
        let config = match &c.assist {
            Assist::Firmware(plan) => Some(plan.config()),
            Assist::None | Assist::Ideal(_) | Assist::Own(_) => None,
        };
        let parameters = match &c.assist {
            Assist::None | Assist::Own(_) => Vec::new(),
            Assist::Firmware(plan) => departing(plan.config(), &published(plan.config())),
            Assist::Ideal(ideal) => {
                let published = Config::thesis(ideal.law.clone());
                departing(&Config { dead_band: ideal.dead_band, ..published.clone() }, &published)
            }
        };
        Self {
            preset: match resolved.scenario.preset {
                Preset::Thesis => "thesis".into(),
                Preset::Product => "product".into(),
            },
            bicycle: ResolvedBicycle::new(&resolved.bicycle),
            rider: resolved.rider.as_ref().map(ResolvedRider::new),
            law: ResolvedLaw::new(&resolved.law_name, &resolved.law),
            assist: match &c.assist {
                Assist::None => "none",
                Assist::Firmware(_) => "firmware",
                Assist::Ideal(_) | Assist::Own(_) => "ideal",
            },
            schedule_speed: format!("{:?}", c.schedule_speed).to_lowercase(),
            imu: format!("{:?}", c.imu).to_lowercase(),
            torque_limit_nm: config.and_then(|c| c.limits.max_torque_nm),
            rate_limit_nm_s: config.and_then(|c| c.limits.rise_nm_s),
            taper_m_s: config.and_then(|c| c.limits.taper).map(|t| (t.zero_m_s, t.full_m_s)),
            sensor_delay_s: f64::from(c.sensor_delay_ticks) * c.step_s,
            plant: ResolvedPlant::new(&c.plant),
            parameters: parameters.into_iter().collect(),
            control_rate_hz: config.map(|c| c.rate_hz),
            step_s: c.step_s,
            fall: c.fall,
            time_limit_s: c.time_limit_s,
            warnings: resolved.warnings.clone(),
            recovered_below: c.recovered_below,
        }
    }

    /// A short label: "rigid_jason, rider young (mean gains, 30 ms), law none".
    pub fn label(&self) -> String {
        let rider = self.rider.as_ref().map_or(String::new(), |r| format!(", {}", r.label()));
        format!("{}{rider}, law {}", self.bicycle.name, self.law.name)
    }
}

/// The published conditions for the same bicycle.
fn published(config: &Config) -> Config {
    let mut published = Config::thesis(config.law.clone());
    published.estimate = EstimateConfig { roll_rate: Source::GyroX, ..config.estimate };
    published.cross.wheelbase_m = config.cross.wheelbase_m;
    published.cross.tilt_rad = config.cross.tilt_rad;
    published.calibration.polarity_checked = config.calibration.polarity_checked;
    published
}

/// The search of a basin.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedSearch {
    /// "steer-rate" or "roll-rate".
    pub axis: String,
    /// Largest disturbance tried \[rad/s\].
    pub max_rate: f64,
    /// Step of the scan \[rad/s\].
    pub scan_step: f64,
    /// Accuracy of borders \[rad/s\].
    pub tolerance: f64,
    /// "fast" or "plain".
    pub method: Method,
    /// Tolerance of the outline between speeds, as a part of the largest height; absent: no speeds were added.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adaptive_speeds: Option<f64>,
}

impl ResolvedSearch {
    /// The search for an output.
    pub fn new(search: &Search) -> Self {
        Self {
            axis: axis_name(search.axis).into(),
            max_rate: search.max_rate,
            scan_step: search.scan_step,
            tolerance: search.tolerance,
            method: search.method,
            adaptive_speeds: None,
        }
    }
}

/// The axis's name in files and on the command line.
pub fn axis_name(axis: Axis) -> &'static str {
    match axis {
        Axis::SteerRate => "steer-rate",
        Axis::RollRate => "roll-rate",
    }
}
