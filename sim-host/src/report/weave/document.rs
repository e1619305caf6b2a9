//! Document of `identify weave`.

use crate::eigen::LinearActuator;
use crate::report::resolved::ResolvedBicycle;
use crate::report::tool::{SCHEMA, Tool};
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
    /// How the recordings were read, and the other parameters of the model.
    pub config: ResolvedWeave,
    /// The usable recordings, in the given order.
    pub recordings: Vec<RecordingEntry>,
    /// The unusable recordings.
    pub refused: Vec<RefusedEntry>,
    /// Per gain and speed the pooled repeats, and the linear model's weave.
    pub weave: Vec<WeaveEntry>,
}

/// How recordings were read, and the model they are compared with.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedWeave {
    /// The law; `{gain}` is replaced by a recording's gain.
    pub law: String,
    /// The fitted columns; all have the same decay and frequency.
    pub columns: Vec<String>,
    /// Fitted in addition to the weave and an offset: "mode", a decaying real mode, or "offset", nothing.
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
    /// Parts of the file that were left out, with the reason, by line.
    pub left_out: Vec<String>,
    /// The fitted weave.
    pub weave: Segment,
}

/// An unusable recording.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RefusedEntry {
    /// The file as it was given.
    pub file: String,
    /// The controller's gain, if known.
    pub gain: Option<f64>,
    /// Forward speed, if known \[m/s\].
    pub speed_m_s: Option<f64>,
    /// The reason.
    pub why: String,
}

/// The weave at one gain and speed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WeaveEntry {
    /// The controller's gain; null if the law needs none.
    pub gain: Option<f64>,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// Number of usable recordings.
    pub repeats: usize,
    /// Number of unusable recordings.
    pub refused: usize,
    /// Real part of the eigenvalue \[1/s\]; null if no recording could be used.
    pub decay_1_s: Option<Pooled>,
    /// Imaginary part \[rad/s\].
    pub frequency_rad_s: Option<Pooled>,
    /// The linear model's eigenvalue.
    pub predicted: Predicted,
}

/// The eigenvalue `[re, im]` \[1/s\] of the linear model; null where it has no pair.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Predicted {
    /// With an ideal motor.
    pub perfect: Option<[f64; 2]>,
    /// With the motor fitted to the published weave.
    pub fitted: Option<[f64; 2]>,
}

impl WeaveDocument {
    /// The pooled weave as measured values; `source` names their origin.
    pub fn measured(&self, source: &str) -> Measured {
        let selected = |entry: &WeaveEntry| {
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
            weave: self.weave.iter().filter_map(selected).collect(),
        }
    }
}
