//! Document and text of `sim-host record`.

use super::document::FALLS;
use super::resolved::{ResolvedBicycle, ResolvedGains, ResolvedRider};
use super::tool::{SCHEMA, Tool};
use crate::bicycle::catalogue::Bicycle;
use crate::perturbation::{Experiment, Record, RecordSample};
use crate::scenario::LoadedRider;
use schemars::JsonSchema;
use serde::Serialize;

/// `record`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PerturbationDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The bicycle.
    pub bicycle: ResolvedBicycle,
    /// The rider; null for a rigid rider, hands off.
    pub rider: Option<ResolvedRider>,
    /// The rider's gains at the experiment's speed, which an identification should find; null without a rider.
    pub gains: Option<ResolvedGains>,
    /// Doubts about the combination of rider and bicycle.
    pub warnings: Vec<String>,
    /// The experiment.
    pub experiment: Experiment,
    /// Samples in the record.
    pub samples: usize,
    /// Pulses of the lateral force in the record.
    pub pulses: usize,
    /// Largest magnitude of the measured steer angle \[rad\].
    pub peak_steer_rad: f64,
    /// Largest magnitude of the measured roll angle \[rad\].
    pub peak_roll_rad: f64,
    /// Smallest and largest forward speed \[m/s\].
    pub speed_range_m_s: [f64; 2],
    /// Time of a fall, which ended the record \[s\]; null without.
    pub time_to_fall_s: Option<f64>,
    /// Reason for which the bicycle counts as fallen; null if it did not fall.
    #[schemars(extend("enum" = FALLS))]
    pub fall: Option<&'static str>,
}

impl PerturbationDocument {
    /// The document of a record.
    pub fn new(
        bicycle: &Bicycle,
        rider: Option<&LoadedRider>,
        warnings: Vec<String>,
        experiment: &Experiment,
        record: &Record,
    ) -> Self {
        let all = || record.samples.iter();
        let peak = |of: fn(&RecordSample) -> f64| all().map(of).fold(0.0, |a, b: f64| f64::max(a, b.abs()));
        let force = |sample: &RecordSample| sample.lateral_force_n;
        let starts =
            record.samples.windows(2).filter(|pair| force(&pair[0]) == 0.0 && force(&pair[1]) != 0.0);
        let speed_m_s = experiment.speed_m_s;
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            bicycle: ResolvedBicycle::new(bicycle),
            rider: rider.map(ResolvedRider::new),
            gains: rider.map(|one| ResolvedGains::new(speed_m_s, &one.rider.schedule.at(speed_m_s))),
            warnings,
            experiment: *experiment,
            samples: record.samples.len(),
            pulses: starts.count(),
            peak_steer_rad: peak(|sample| sample.steer_rad),
            peak_roll_rad: peak(|sample| sample.roll_rad),
            speed_range_m_s: all().fold([speed_m_s; 2], |[low, high], sample| {
                [low.min(sample.speed_m_s), high.max(sample.speed_m_s)]
            }),
            time_to_fall_s: record.fall.map(|(time_s, _)| time_s),
            fall: record.fall.map(|(_, cause)| cause.name()),
        }
    }

    /// The record in two lines.
    pub fn text(&self) -> String {
        let end =
            self.time_to_fall_s.map_or(String::new(), |time_s| format!(", up to a fall at {time_s:.3} s"));
        let [slowest, fastest] = self.speed_range_m_s;
        format!(
            "{} samples at {} Hz{end}; {} pulses of {} N\npeak roll {:.1} deg, peak steer {:.1} deg, speed {slowest:.3} to {fastest:.3} m/s\n",
            self.samples,
            self.experiment.rate_hz,
            self.pulses,
            self.experiment.force.amplitude,
            self.peak_roll_rad.to_degrees(),
            self.peak_steer_rad.to_degrees(),
        )
    }
}
