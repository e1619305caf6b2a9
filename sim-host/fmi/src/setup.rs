//! What an FMU is made of: the model with every number that it needs, as the file `resources/model.json`.

use crate::variable::Table;
use crate::{bicycle, controller, rider};
use motion::bicycle::{ForcePoint, Parameters};
use motion::plant::{Friction, Imu, SteerStop};
use motion::ride::{FallCriterion, ScheduleSpeed, Start};
use motion::rider::{Gains, Neuromuscular, Outside};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file in an FMU's resources.
pub const MODEL_FILE: &str = "model.json";

/// A model with its defaults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(clippy::large_enum_variant, reason = "each instance has one")]
pub enum Setup {
    /// The flashed control step.
    Controller {
        /// [`control::wire::encode_config`], as hexadecimal digits.
        configuration: String,
        /// Speed of the warm start \[m/s\].
        speed_m_s: f64,
        /// Gravity in the warm start \[m/s^2\].
        g_m_s2: f64,
    },
    /// The nonlinear bicycle.
    Bicycle {
        /// Its parameters.
        parameters: Parameters,
        /// The initial state.
        start: Start,
        /// Where a lateral force acts.
        force_point: ForcePoint,
        /// Roll rate that the gyro measures.
        imu: Imu,
        /// The IMU's place from the rear wheel's centre: forward, right, down \[m\].
        imu_point_m: [f64; 3],
        /// Friction of the steer.
        friction: Friction,
        /// The steer's end-stop.
        stop: Option<SteerStop>,
        /// Duration for which fast motion is followed as in a ride of this duration \[s\].
        time_limit_s: f64,
        /// When it counts as fallen.
        fall: FallCriterion,
        /// Time step \[s\].
        step_s: f64,
    },
    /// A rider model.
    Rider {
        /// Speeds \[m/s\] and gains.
        gains: Vec<(f64, Gains)>,
        /// Gains beyond these speeds.
        outside: Outside,
        /// Speed that schedules the gains.
        schedule_speed: ScheduleSpeed,
        /// Neural delay \[s\].
        delay_s: f64,
        /// Neuromuscular dynamics.
        neuromuscular: Neuromuscular,
        /// Time step \[s\].
        step_s: f64,
    },
}

/// The part of the file that the library reads.
#[derive(Deserialize)]
struct File {
    model: Setup,
    variables: u32,
}

impl Setup {
    /// Reads the file of an FMU: the model and its variables.
    ///
    /// # Errors
    /// The file, and why it can't be read; another `token` than that of the model description; a library of another build, with
    /// other variables.
    pub fn read(resources: &Path, expected: &str) -> Result<(Self, Table), String> {
        let path = resources.join(MODEL_FILE);
        let wrong = |reason: String| format!("{}: {reason}", path.display());
        let bytes = std::fs::read(&path).map_err(|e| wrong(e.to_string()))?;
        let found = token(&bytes);
        if found != expected {
            return Err(wrong(format!(
                "belongs to the token {found}, not to {expected} of modelDescription.xml"
            )));
        }
        let File { model, variables } = serde_json::from_slice(&bytes).map_err(|e| wrong(e.to_string()))?;
        let table = model.table().map_err(wrong)?;
        if table.fingerprint() == variables {
            return Ok((model, table));
        }
        Err(wrong("was written by another build than that of the library in this FMU".into()))
    }

    /// The model's variables.
    ///
    /// # Errors
    /// The configuration can't be decoded.
    pub fn table(&self) -> Result<Table, String> {
        Ok(Table::new(match self {
            Self::Controller { configuration, speed_m_s, g_m_s2, .. } => {
                controller::variables(&controller::decoded(configuration)?, *speed_m_s, *g_m_s2)
            }
            Self::Bicycle { parameters, start, force_point, .. } => {
                bicycle::variables(parameters, start, force_point)
            }
            Self::Rider { delay_s, neuromuscular, schedule_speed, .. } => {
                rider::variables(*delay_s, neuromuscular, *schedule_speed)
            }
        }))
    }

    /// Time step of the model \[s\].
    ///
    /// # Errors
    /// The configuration can't be decoded.
    pub fn step_s(&self) -> Result<f64, String> {
        match self {
            Self::Controller { configuration, .. } => {
                controller::decoded(configuration).map(|config| 1.0 / f64::from(config.rate_hz))
            }
            Self::Bicycle { step_s, .. } | Self::Rider { step_s, .. } => Ok(*step_s),
        }
    }
}

/// Instantiation token of an FMU with this file: it changes with the file and with the library's version.
pub fn token(file: &[u8]) -> String {
    let crc = |seed| {
        let mut hasher = crc32fast::Hasher::new_with_initial(seed);
        hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
        hasher.update(file);
        hasher.finalize()
    };
    format!("steer-assist-{:08x}{:08x}", crc(0), crc(1))
}
