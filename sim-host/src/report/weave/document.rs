//! The document of `identify weave`.

use crate::eigen::LinearActuator;
use crate::report::document::SCHEMA;
use crate::report::resolved::{ResolvedBicycle, Tool};
use crate::weave::measured::{Measured, MeasuredWeave, three};
use crate::weave::pool::Pooled;
use crate::weave::segment::Segment;
use schemars::JsonSchema;
use serde::Serialize;

/// `identify weave`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WeaveDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The bicycle of the predictions.
    pub bicycle: ResolvedBicycle,
    /// How the recordings were read, and the rest of the model.
    pub config: ResolvedWeave,
    /// The recordings that could be used, in the order given.
    pub recordings: Vec<RecordingEntry>,
    /// Those that could not.
    pub refused: Vec<RefusedEntry>,
    /// Per gain and speed the repeats together, and the linear model's weave.
    pub weave: Vec<WeaveEntry>,
}

/// How recordings were read, and what they are compared with.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedWeave {
    /// The law, `{gain}` standing for a recording's.
    pub law: String,
    /// The columns that were fitted, all with the same decay and frequency.
    pub columns: Vec<String>,
    /// What was fitted beside the weave and an offset: "mode", a decaying real mode, or "offset", nothing.
    #[schemars(extend("enum" = ["mode", "offset"]))]
    pub beside: &'static str,
    /// The motor of the second prediction, fitted to the published weave.
    pub motor: LinearActuator,
}

/// A recording.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RecordingEntry {
    /// The file as it was given.
    pub file: String,
    /// The controller's gain; null if the law needs none.
    pub gain: Option<f64>,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// What of the file was left out, and why, by line.
    pub left_out: Vec<String>,
    /// What it says.
    pub weave: Segment,
}

/// A recording that could not be used.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RefusedEntry {
    /// The file as it was given.
    pub file: String,
    /// The controller's gain, if it is known.
    pub gain: Option<f64>,
    /// Forward speed, if it is known \[m/s\].
    pub speed_m_s: Option<f64>,
    /// Why.
    pub why: String,
}

/// The weave at one gain and speed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WeaveEntry {
    /// The controller's gain; null if the law needs none.
    pub gain: Option<f64>,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// How many recordings could be used.
    pub repeats: usize,
    /// How many could not.
    pub refused: usize,
    /// Real part of the eigenvalue \[1/s\]; null if no recording could be used.
    pub decay_1_s: Option<Pooled>,
    /// Imaginary part \[rad/s\].
    pub frequency_rad_s: Option<Pooled>,
    /// The linear model's.
    pub predicted: Predicted,
}

/// The eigenvalue `[re, im]` \[1/s\] that the linear model has; null where it has no pair.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Predicted {
    /// With a motor that gives what it is asked for.
    pub perfect: Option<[f64; 2]>,
    /// With the motor fitted to the published weave.
    pub fitted: Option<[f64; 2]>,
}

impl WeaveDocument {
    /// What is kept of it as a table.
    pub fn measured(&self, source: &str) -> Measured {
        let kept = |entry: &WeaveEntry| {
            let (decay, frequency) = (entry.decay_1_s?, entry.frequency_rad_s?);
            Some(MeasuredWeave {
                gain: entry.gain,
                speed_m_s: entry.speed_m_s,
                repeats: entry.repeats,
                refused: entry.refused,
                decay_1_s: three(&decay),
                decay_between_1_s: decay.between,
                frequency_rad_s: three(&frequency),
                frequency_between_rad_s: frequency.between,
            })
        };
        Measured {
            source: source.into(),
            columns: self.config.columns.clone(),
            beside: self.config.beside.into(),
            weave: self.weave.iter().filter_map(kept).collect(),
        }
    }
}
