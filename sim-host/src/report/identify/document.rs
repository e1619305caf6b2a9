//! The documents of an identified rider.

use super::warnings::{insignificant, warnings};
use crate::bicycle::ForcePoint;
use crate::identify::{Fit, Hold, Identified, LocalOptimum, PerGain, Signal, Step, symbols};
use crate::report::resolved::ResolvedBicycle;
use crate::report::tool::Tool;
use crate::rider::Neuromuscular;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Fraction of a signal, by signal.
type PerSignal = BTreeMap<&'static str, f64>;

/// The fitted record.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RecordEntry {
    /// The file.
    pub file: String,
    /// SHA-256 of its content.
    pub sha256: String,
    /// Samples after the preparation.
    pub samples: usize,
    /// Time between two samples \[s\].
    pub sample_s: f64,
    /// Duration \[s\].
    pub duration_s: f64,
    /// Forward speed of the model \[m/s\].
    pub speed_m_s: f64,
    /// Standard deviation of the recorded speed \[m/s\]; null if it was not recorded.
    pub speed_deviation_m_s: Option<f64>,
    /// Root mean square of each fitted signal \[rad or rad/s\].
    pub root_mean_square: PerSignal,
    /// What was left out or bridged, and what looks wrong.
    pub remarks: Vec<String>,
}

/// Settings of an identification.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedIdentify {
    /// The map of the columns.
    pub map: String,
    /// Point of the rear frame where the lateral force acts.
    pub force_at: ForcePoint,
    /// Signals that are fitted.
    pub fit: Vec<Signal>,
    /// Gains of the full fit.
    pub feedback: Vec<&'static str>,
    /// Neuromuscular dynamics of the rider.
    pub neuromuscular: Neuromuscular,
    /// Slow motion that is no response: `none`, `offset`, or slower than a frequency, such as `0.05Hz`.
    pub drift: String,
    /// Time from the record's start that is not fitted \[s\].
    pub skip_s: f64,
    /// Course of the disturbance between two samples.
    pub hold: Hold,
    /// Whether the output of the impulse response is fitted in place of the measured signals.
    pub filter: bool,
    /// The given neural delay \[s\]; null if it was estimated.
    pub delay_s: Option<f64>,
    /// Delays of the profile \[s\].
    pub delay_profile_s: Vec<f64>,
    /// Whether the gains of the linear bicycle are kept, without refinement on the nonlinear one.
    pub linear: bool,
    /// Criterion that selects the gains.
    pub select: String,
    /// Variance accounted for at which the reduction ends; null without a reduction.
    pub reduce_until: Option<f64>,
    /// Seed of the global search.
    pub seed: u64,
}

/// A gain with its uncertainty.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct GainValue {
    /// The gain: N m per rad, rad s, rad/s, rad/s^2 (roll, then steer).
    pub value: f64,
    /// Its standard error; null where it is not known: for gains that could not be refined on the nonlinear bicycle, and for
    /// those of an unstable closed loop.
    pub std_error: Option<f64>,
}

/// A gain that does not differ significantly from zero.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Unidentified {
    /// The gain.
    pub gain: &'static str,
    /// The rest of the sentence that begins with the gain: its 95 % interval, and the gain that it can't be separated from.
    pub why: String,
}

/// A local optimum of the fit.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OptimumEntry {
    /// The gains.
    pub gains: BTreeMap<&'static str, f64>,
    /// Variance accounted for, the mean of the signals.
    pub vaf: f64,
    /// The same within a second of the perturbations' onsets; null if the record has none.
    pub vaf_after_onset: Option<f64>,
    /// Drop of the log-likelihood below the best optimum's; 1.92 at the ends of a 95 % interval.
    pub log_likelihood_drop: f64,
    /// Real part of the closed loop's rightmost eigenvalue \[1/s\]; positive if unstable.
    pub rightmost_eigenvalue_1_s: f64,
    /// The number of starts of the search that led here.
    pub starts: usize,
}

/// A step of the reduction.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReductionEntry {
    /// The gains.
    pub gains: BTreeMap<&'static str, GainValue>,
    /// Variance accounted for, the mean of the signals.
    pub vaf: f64,
    /// The same within a second of the perturbations' onsets.
    pub vaf_after_onset: Option<f64>,
    /// The same for data that was not fitted; null if a part of the record can't be fitted alone.
    pub vaf_cross_validated: Option<f64>,
    /// Information criterion of Akaike.
    pub aic: f64,
    /// Information criterion of Bayes.
    pub bic: f64,
    /// Real part of the closed loop's rightmost eigenvalue \[1/s\].
    pub rightmost_eigenvalue_1_s: f64,
    /// The gain that the next step is without.
    pub weakest: &'static str,
    /// Its variance relative to its square (eq. 2.15).
    pub weakest_relative_variance: f64,
}

/// A delay with its best gains.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DelayEntry {
    /// The delay \[s\].
    pub delay_s: f64,
    /// Drop of the log-likelihood below the best delay's.
    pub log_likelihood_drop: f64,
    /// Variance accounted for.
    pub vaf: f64,
    /// The best gains with this delay.
    pub gains: BTreeMap<&'static str, f64>,
}

/// What the record tells about the delay.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DelayEstimate {
    /// The likeliest delay \[s\].
    pub estimate_s: f64,
    /// Lower end of the 95 % interval \[s\]; null if it is below the profile.
    pub low_s: Option<f64>,
    /// Upper end \[s\]; null if it is above the profile.
    pub high_s: Option<f64>,
    /// The profile likelihood.
    pub profile: Vec<DelayEntry>,
}

impl DelayEstimate {
    /// Estimate and 95 % interval in words.
    pub(super) fn sentence(&self) -> String {
        let ms = |s: f64| format!("{:.1} ms", 1e3 * s);
        let first_s = self.profile.first().map_or(0.0, |point| point.delay_s);
        let low = match self.low_s {
            Some(low_s) => ms(low_s),
            // There is no shorter delay.
            None if first_s == 0.0 => ms(0.0),
            None => format!("below {}, the first of the profile,", ms(first_s)),
        };
        let last_s = self.profile.last().map_or(0.0, |point| point.delay_s);
        let high = match self.high_s {
            Some(high_s) => ms(high_s),
            None => format!("above {}, the last of the profile", ms(last_s)),
        };
        format!(
            "The likeliest delay with the gains of the full fit is {}, its 95 % interval from {low} to {high}.",
            ms(self.estimate_s)
        )
    }
}

/// The impulse response: what the perturbation explains of a signal without a model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct BlackBox {
    /// The signal.
    pub signal: Signal,
    /// Power of the response over that of the rest.
    pub signal_to_noise: f64,
    /// Time between two coefficients \[s\].
    pub step_s: f64,
    /// Response to a unit impulse of the lateral force \[rad or rad/s, per N s\].
    pub to_force: Vec<f64>,
    /// Response to a unit impulse of the steer torque \[rad or rad/s, per N m s\].
    pub to_steer_torque: Vec<f64>,
}

/// `identify RECORD`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct IdentifyDocument {
    /// 1.
    #[schemars(extend("const" = crate::report::tool::SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The record.
    pub record: RecordEntry,
    /// The bicycle.
    pub bicycle: ResolvedBicycle,
    /// The settings.
    pub config: ResolvedIdentify,
    /// The selected gains.
    pub gains: BTreeMap<&'static str, GainValue>,
    /// Covariance of the selected gains, in the order of their names in `covariance_of`; null if it is not known.
    pub covariance: Option<Vec<Vec<f64>>>,
    /// Names of the rows and columns of `covariance`.
    pub covariance_of: Vec<&'static str>,
    /// Variance accounted for (eq. 2.12) by the selected gains, the mean of the signals: 1 for a perfect model.
    pub vaf: f64,
    /// The same by signal.
    pub vaf_by_signal: PerSignal,
    /// The same within a second of the perturbations' onsets; null if the record has none.
    pub vaf_after_onset: Option<PerSignal>,
    /// The neural delay of the fit \[s\].
    pub delay_s: f64,
    /// Real part of the closed loop's rightmost eigenvalue \[1/s\]; positive if unstable.
    pub rightmost_eigenvalue_1_s: f64,
    /// Whether the gains are refined on the nonlinear bicycle; the optima and the reduction are those of the linear one.
    pub refined: bool,
    /// Condition number of the fit.
    pub condition: f64,
    /// The number of independent samples: all, less what the correlation of the residuals takes.
    pub independent_samples: f64,
    /// Why the gains may be wrong by more than their standard errors say; empty if nothing was noticed.
    pub warnings: Vec<String>,
    /// Gains that do not differ significantly from zero: their 95 % intervals contain it. Empty without standard errors.
    pub not_identified: Vec<Unidentified>,
    /// The distinct optima of the full fit, best first.
    pub optima: Vec<OptimumEntry>,
    /// The reduction, from the full fit.
    pub reduction: Vec<ReductionEntry>,
    /// Index of the selected step in `reduction`.
    pub selected: usize,
    /// The delay's profile; null without one.
    pub delay: Option<DelayEstimate>,
    /// Impulse responses.
    pub black_box: Vec<BlackBox>,
    /// File of the rider; null if none was written.
    pub rider_file: Option<String>,
}

/// `identify` with several records.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct IdentifyManyDocument {
    /// 1.
    #[schemars(extend("const" = crate::report::tool::SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// One document for each record that could be fitted.
    pub records: Vec<serde_json::Value>,
    /// Files that could not be fitted, with the reason.
    pub refused: BTreeMap<String, String>,
    /// File of the rider; null if none was written.
    pub rider_file: Option<String>,
}

fn named(gains: &PerGain, active: &[usize]) -> BTreeMap<&'static str, f64> {
    active.iter().map(|i| (symbols()[*i], gains[*i])).collect()
}

/// The gains of a fit, with their standard errors if these hold (`known`).
fn values(fit: &Fit, known: bool) -> BTreeMap<&'static str, GainValue> {
    let errors = fit.standard_errors();
    let value = |i: &usize| {
        let std_error = known.then_some(errors[*i]);
        (symbols()[*i], GainValue { value: fit.gains[*i], std_error })
    };
    fit.active.iter().map(value).collect()
}

fn by_signal(of: &[(Signal, f64)]) -> PerSignal {
    of.iter().map(|(signal, x)| (signal.name(), *x)).collect()
}

fn mean(of: &[(Signal, f64)]) -> f64 {
    of.iter().map(|(_, x)| x).sum::<f64>() / of.len() as f64
}

impl IdentifyDocument {
    /// The document of an identification.
    pub fn new(
        record: RecordEntry,
        bicycle: ResolvedBicycle,
        config: ResolvedIdentify,
        found: &Identified,
    ) -> Self {
        let fit = found.fit();
        let known = found.errors_unknown().is_none();
        let all = &found.steps[0].fit;
        let optimum = |optimum: &LocalOptimum| OptimumEntry {
            gains: named(&optimum.gains, &all.active),
            vaf: mean(&optimum.vaf),
            vaf_after_onset: optimum.vaf_after_onset.as_deref().map(mean),
            log_likelihood_drop: optimum.drop,
            rightmost_eigenvalue_1_s: optimum.rightmost_1_s,
            starts: optimum.starts,
        };
        let step = |step: &Step| ReductionEntry {
            gains: values(&step.fit, step.fit.is_stable()),
            vaf: step.fit.mean_vaf(),
            vaf_after_onset: step.fit.vaf_after_onset.as_deref().map(mean),
            vaf_cross_validated: step.cross_validated_vaf,
            aic: step.criteria.aic,
            bic: step.criteria.bic,
            rightmost_eigenvalue_1_s: step.fit.rightmost_1_s,
            weakest: symbols()[step.weakest.0],
            weakest_relative_variance: step.weakest.1,
        };
        let delay = found.delay.as_ref().map(|profile| DelayEstimate {
            estimate_s: profile.estimate_s,
            low_s: profile.interval_s[0],
            high_s: profile.interval_s[1],
            profile: profile
                .points
                .iter()
                .map(|point| DelayEntry {
                    delay_s: point.delay_s,
                    log_likelihood_drop: point.drop,
                    vaf: point.vaf,
                    gains: named(&point.gains, &all.active),
                })
                .collect(),
        });
        let measured = &found.problem.record.measured;
        let black_box = measured.iter().zip(&found.impulse_responses).filter_map(|(measured, fir)| {
            let fir = fir.as_ref()?;
            let [to_force, to_steer_torque] = fir.taps.clone();
            let (signal_to_noise, step_s) = (fir.signal_to_noise, fir.step_s);
            Some(BlackBox { signal: measured.signal, signal_to_noise, step_s, to_force, to_steer_torque })
        });
        Self {
            schema: crate::report::tool::SCHEMA,
            tool: Tool::this(),
            record,
            bicycle,
            config,
            gains: values(fit, known),
            covariance: known
                .then(|| fit.covariance.row_iter().map(|row| row.iter().copied().collect()).collect()),
            covariance_of: fit.active.iter().map(|i| symbols()[*i]).collect(),
            vaf: fit.mean_vaf(),
            vaf_by_signal: by_signal(&fit.vaf),
            vaf_after_onset: fit.vaf_after_onset.as_deref().map(by_signal),
            delay_s: found.problem.model.delay_s,
            rightmost_eigenvalue_1_s: fit.rightmost_1_s,
            refined: matches!(found.refined, Some(Ok(_))),
            condition: fit.condition,
            independent_samples: fit.residuals.iter().map(|residuals| residuals.independent).sum(),
            warnings: warnings(found),
            not_identified: if known { insignificant(fit) } else { Vec::new() },
            optima: all.optima.iter().map(optimum).collect(),
            reduction: found.steps.iter().map(step).collect(),
            selected: found.selected,
            delay,
            black_box: black_box.collect(),
            rider_file: None,
        }
    }
}
