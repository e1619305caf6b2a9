//! An experiment as data. A [`Scenario`] has the bicycle, the rider, the law, the limits, the plant with its faults, the
//! disturbance and the search; [`Scenario::resolve`] gives what a ride needs. Files, options of the command line, cells
//! of a sweep and code make the same type, and every result contains the one that reproduces it. `docs/scenario.md`.

mod blame;
pub mod content;
mod cut_files;
mod error;
mod fall;
mod file;
mod idle;
pub mod law;
mod named;
pub mod parameter_file;
mod plant;
mod plant_error;
mod repeats;
mod resolve;
mod rider;
mod search;
pub mod setting;
pub mod speeds;
mod text;
mod text_error;
mod ticks;
mod unit;

pub(crate) use blame::search_key;
pub use blame::{bounds, number};
pub use content::{Content, OrNone};
pub use cut_files::warnings as cut_warnings;
pub use error::ScenarioError;
pub use fall::FallChoice;
pub use file::{SyntaxError, choices};
pub use law::{LawChoiceError, LawTable};
pub use named::named;
pub use parameter_file::{ParameterFile, ParameterFileError, ParameterTextError};
pub use plant::{ActuatorChoice, PlantChoice, SensorChange};
pub use plant_error::{PlantChoiceError, UnknownSensorError};
pub use resolve::Resolved;
pub use rider::{LoadedRider, RiderChoice};
pub use search::{SearchChoice, Speeds};
pub use speeds::SpeedsError;
pub use text::seed;
pub use text_error::TextError;
pub use ticks::TicksError;
pub use unit::unit_of;

use crate::basin::PlaneSearch;
use crate::bicycle::catalogue::Bicycle;
use crate::parameters::Value;
use crate::ride::{Imu, ScheduleSpeed, Start};
use content::{NameOr, name_or_table};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Source of the defaults of law, limits and parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// The published conditions: law h, every limit off.
    #[default]
    Thesis,
    /// The flashed configuration.
    Product,
}

/// What computes the torque of the assist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum AssistKind {
    /// The firmware's control crate: f32, sampled, with all limits.
    #[default]
    Firmware,
    /// The law alone in f64, continuous, without limits.
    Ideal,
}

/// An experiment. Absent keys have their defaults, which are the published conditions.
///
/// ```
/// use sim_host::ride::{Outcome, traced};
/// use sim_host::scenario::Scenario;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario::from_toml(
///     "preset = 'product'
///      rider = 'smart'
///      [start]
///      speed_m_s = 4
///      steer_rate_rad_s = 3
///      [plant]
///      faults = ['gyro:stuck@2s']",
/// )?;
/// let resolved = scenario.resolve()?;
/// let (ride, trace) = traced(&resolved.conditions, scenario.start.unwrap_or_default());
/// assert!(ride.effort.peak_torque_nm <= 7.0 && trace.len() > 1000);
/// assert_eq!(Scenario::from_toml(&scenario.to_toml()?)?, scenario);
///
/// // Errors name the key, the value and its range.
/// let wrong = Scenario::from_toml("time_limit_s = 0")?.resolve().unwrap_err();
/// assert!(wrong.to_string().contains("time limit (s) = 0 is outside"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// Built-in bicycle, FILE, or FILE#NAME of a collection, or its content in place.
    pub bicycle: Content<Bicycle>,
    /// Changed parameters of the bicycle, SI units.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub bicycle_set: BTreeMap<String, f64>,
    /// The rider; absent for a rigid one, hands off.
    #[serde(deserialize_with = "name_or_table", skip_serializing_if = "is_default")]
    #[schemars(with = "NameOr<RiderChoice>")]
    pub rider: RiderChoice,
    /// Roll-rate law: its name, a table FILE, or a table in place; absent: h, none with a rider, product: h-cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub law: Option<Content<LawTable>>,
    /// Defaults of law, limits and parameters.
    pub preset: Preset,
    /// What computes the torque.
    pub assist: AssistKind,
    /// Speed that schedules the gain.
    pub schedule_speed: ScheduleSpeed,
    /// Largest torque \[N m\], or "none"; absent: the preset's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_limit_nm: Option<OrNone<f64>>,
    /// Largest change of torque \[N m/s\], or "none"; absent: the preset's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_limit_nm_s: Option<OrNone<f64>>,
    /// Taper \[m/s\]: torque zero at the first, full at the second speed, or "none"; absent: the preset's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub taper_m_s: Option<OrNone<[f64; 2]>>,
    /// Delay of the simulated sensors \[s\], a whole number of control periods.
    pub sensor_delay_s: f64,
    /// Errors of sensors and motor, and faults.
    #[serde(skip_serializing_if = "is_default")]
    pub plant: PlantChoice,
    /// Law and parameters of the firmware as exported from a board; other keys have precedence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameter_file: Option<Content<ParameterFile>>,
    /// Parameters of the firmware by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, Value>,
    /// Roll rate that the gyro measures.
    pub imu: Imu,
    /// When a ride counts as fallen.
    #[serde(skip_serializing_if = "is_default")]
    pub fall: FallChoice,
    /// Duration of a ride that does not fall \[s\].
    pub time_limit_s: f64,
    /// A ride has recovered if roll and steer end below this fraction of their maxima.
    pub recovered_below: f64,
    /// Initial state of a single ride.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<Start>,
    /// Search of a basin over speed.
    #[serde(skip_serializing_if = "is_default")]
    pub search: SearchChoice,
    /// Search of a basin over steer rate and roll rate at one speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneSearch>,
    /// Number of bicycles drawn from the uncertainties of the bicycle's parameters, 2 to 10000.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertain: Option<u32>,
    /// Number of riders drawn from the covariances of the rider's gains, or from the sets in its groups, 2 to 10000.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rider_draws: Option<u32>,
    /// File that the scenario was read from, for messages.
    #[serde(skip)]
    pub file: Option<PathBuf>,
    /// Keys that options changed, for messages.
    #[serde(skip)]
    pub options: BTreeSet<&'static str>,
}

impl Default for Scenario {
    fn default() -> Self {
        Self {
            bicycle: "rigid_jason".into(),
            bicycle_set: BTreeMap::new(),
            rider: RiderChoice::default(),
            law: None,
            preset: Preset::default(),
            assist: AssistKind::default(),
            schedule_speed: ScheduleSpeed::Front,
            torque_limit_nm: None,
            rate_limit_nm_s: None,
            taper_m_s: None,
            sensor_delay_s: 0.0,
            plant: PlantChoice::default(),
            parameter_file: None,
            parameters: BTreeMap::new(),
            imu: Imu::Euler,
            fall: FallChoice::default(),
            time_limit_s: 6.0,
            recovered_below: 0.1,
            start: None,
            search: SearchChoice::default(),
            plane: None,
            uncertain: None,
            rider_draws: None,
            file: None,
            options: BTreeSet::new(),
        }
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
