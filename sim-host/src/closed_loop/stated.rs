//! The law that a controller's source states, beside the identified one.

use super::{Identified, Signal};
use crate::weave::Estimate;
use std::path::Path;

/// A law that is followed exactly has an interval without width: it is taken wider by this part of the stated number.
const ROUNDING: f64 = 1e-9;

/// A stated law: a TOML file.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedLaw {
    /// Its origin.
    pub source: String,
    /// Gains over the speed.
    #[serde(default)]
    gain: Vec<StatedGain>,
    /// Responses of a law with internal states over the speed.
    #[serde(default)]
    response: Vec<StatedResponse>,
}

#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StatedGain {
    signal: Signal,
    speed_m_s: Vec<f64>,
    gain: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StatedResponse {
    input: Signal,
    frequency_hz: f64,
    speed_m_s: Vec<f64>,
    magnitude: Vec<f64>,
}

/// A file without a stated law.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StatedError {
    /// A file that can't be read.
    #[error("{file}: {error}")]
    Read {
        /// The file.
        file: String,
        /// The error.
        error: std::io::Error,
    },
    /// Text that is no stated law.
    #[error("{file}: {error}")]
    Syntax {
        /// The file.
        file: String,
        /// The error, with line and key.
        error: Box<toml::de::Error>,
    },
    /// A course over the speed that is none.
    #[error("{file}: {what}: as many numbers as speeds are needed, at least one, with rising speeds")]
    Course {
        /// The file.
        file: String,
        /// The entry.
        what: String,
    },
}

/// A stated number beside the identified one.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Compared {
    /// The signal or input.
    pub signal: Signal,
    /// Frequency of a response \[Hz\]; null for a gain.
    pub frequency_hz: Option<f64>,
    /// Speed \[m/s\].
    pub speed_m_s: f64,
    /// As stated, at this speed.
    pub stated: f64,
    /// As identified.
    pub identified: Estimate,
    /// Whether the interval contains the stated number.
    pub holds: bool,
}

impl StatedLaw {
    /// Reads a file.
    ///
    /// # Errors
    /// The file with line and key.
    pub fn load(path: &Path) -> Result<Self, StatedError> {
        let file = path.display().to_string();
        let read = |error| StatedError::Read { file: file.clone(), error };
        let syntax = |error| StatedError::Syntax { file: file.clone(), error: Box::new(error) };
        let law: Self = toml::from_str(&crate::input_file::text(path).map_err(read)?).map_err(syntax)?;
        let gains = law.gain.iter().map(|g| (format!("gain of {}", g.signal.name()), &g.speed_m_s, &g.gain));
        let responses = law.response.iter().map(|r| {
            (format!("response to {} at {} Hz", r.input.name(), r.frequency_hz), &r.speed_m_s, &r.magnitude)
        });
        for (what, speeds, values) in gains.chain(responses) {
            let rising = speeds.windows(2).all(|two| two[0] < two[1]);
            let finite = speeds.iter().chain(values).all(|x| x.is_finite());
            if speeds.is_empty() || speeds.len() != values.len() || !rising || !finite {
                return Err(StatedError::Course { file, what });
            }
        }
        Ok(law)
    }

    /// Every stated number that was identified too.
    pub fn beside(&self, identified: &Identified) -> Vec<Compared> {
        let compared = |signal, frequency_hz, speed_m_s, stated, identified: Estimate| Compared {
            signal,
            frequency_hz,
            speed_m_s,
            stated,
            identified,
            holds: (identified.low - ROUNDING * stated.abs()..=identified.high + ROUNDING * stated.abs())
                .contains(&stated),
        };
        let gains = self.gain.iter().filter_map(|stated| {
            let law = identified.law.found()?;
            let gain = law.gains.iter().find(|gain| gain.signal == stated.signal)?;
            let number = course(&stated.speed_m_s, &stated.gain, law.speed_m_s);
            Some(compared(stated.signal, None, law.speed_m_s, number, gain.gain))
        });
        let responses = self.response.iter().filter_map(|stated| {
            let law = identified.memory.found()?;
            let same = |response: &&super::Response| {
                response.input == stated.input && response.frequency_hz == stated.frequency_hz
            };
            let response = law.responses.iter().find(same)?;
            let number = course(&stated.speed_m_s, &stated.magnitude, law.speed_m_s);
            let frequency = Some(stated.frequency_hz);
            Some(compared(stated.input, frequency, law.speed_m_s, number, response.magnitude))
        });
        gains.chain(responses).collect()
    }
}

/// Linear between the points, constant beyond.
fn course(speeds: &[f64], values: &[f64], speed: f64) -> f64 {
    let next = speeds.partition_point(|v| *v <= speed);
    match (next.checked_sub(1), speeds.get(next)) {
        (Some(i), Some(upper)) => {
            values[i] + (values[next] - values[i]) * (speed - speeds[i]) / (upper - speeds[i])
        }
        (Some(i), None) => values[i],
        (None, _) => values[0],
    }
}
