//! A law with internal states, such as an observer or an integrator, in the longest stretch of uniform speed: an output-error
//! model (`output_error`) of as few states as explain the torque.
//!
//! From outside, gains and observer of such a law have only their product: the response from each measured input to the
//! torque. That is reported.

use super::Part;
use super::checked::{Checked, FEWEST, SHORTEST_S};
use super::collinear::separable;
use super::output_error::{Data, Model};
use super::record::{Record, Signal};
use crate::weave::Estimate;
use nalgebra::{ComplexField, DMatrix, DVector};

/// Inputs of the law: what a steering controller measures.
const INPUTS: [Signal; 3] = [Signal::RollRate, Signal::Steer, Signal::RiderTorque];
/// Number of internal states at most.
const MOST_STATES: usize = 4;
/// A model of fewer states is preferred while it leaves at most this many times as much unexplained.
const PREFERRED: f64 = 2.0;
/// Largest over smallest speed of the stretch: the gains may depend on the speed.
const SAME_SPEED: f64 = 1.1;
/// Slowest speed of the stretch \[m/s\].
const SLOWEST_M_S: f64 = 0.5;
/// Most samples of the stretch, which bounds the computing time.
const MOST_SAMPLES: usize = 8000;
/// Frequencies of the reported response \[Hz\].
const FREQUENCIES_HZ: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Time over which residuals are correlated \[s\].
const MEMORY_S: f64 = 1.0;
/// Without internal states a law may leave this much unexplained.
const WITHOUT: f64 = 0.01;
/// Least explained fraction of a law.
const LEAST_VAF: f64 = 0.5;

/// Response of the torque to a sine of one input.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Response {
    /// The input.
    pub input: Signal,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude ratio; unit as that of a gain. The interval is extended to the values of the models with other numbers of
    /// states that fit as well.
    pub magnitude: Estimate,
    /// Phase lead of the torque \[deg\].
    pub phase_deg: f64,
}

/// A law with internal states.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MemoryLaw {
    /// Number of internal states; with 0, the torque depends on the signals of one instant.
    pub states: usize,
    /// Explained fraction of the variance of the torque, simulated from the inputs alone.
    pub vaf: f64,
    /// The same without internal states.
    pub vaf_without: f64,
    /// Start of the stretch of uniform speed \[s\].
    pub from_s: f64,
    /// End of the stretch \[s\].
    pub to_s: f64,
    /// Mean speed there \[m/s\].
    pub speed_m_s: f64,
    /// The response to each input.
    pub responses: Vec<Response>,
}

/// Identifies a law with internal states in the longest stretch of uniform speed.
pub fn memory(record: &Record, checked: &Checked) -> Part<MemoryLaw> {
    let recorded = INPUTS.into_iter().filter_map(|signal| Some((signal, record.channel(signal)?)));
    let recorded: Vec<(Signal, &[f64])> = recorded.collect();
    let stretch = stretch(record, checked, &recorded);
    let seconds = stretch.len() as f64 * checked.period_s;
    if recorded.is_empty() || stretch.len() < FEWEST || seconds < SHORTEST_S {
        return Part::not(format!(
            "no stretch of uniform speed with a changing torque is longer than {seconds:.1} s"
        ));
    }
    let columns = DMatrix::from_fn(stretch.len(), recorded.len(), |i, j| recorded[j].1[stretch.start + i]);
    let (kept, _) = separable(&columns);
    let centred = |j: &usize| {
        let column = columns.column(*j);
        column.add_scalar(-column.mean()).as_slice().to_vec()
    };
    let data = Data {
        torque: DVector::from_column_slice(&record.torque_nm[stretch.clone()]),
        inputs: kept.iter().map(centred).collect(),
    };
    let models: Vec<Model> = (0..=MOST_STATES).filter_map(|states| data.fit(states)).collect();
    let least = models.iter().map(|model| model.cost).fold(f64::INFINITY, f64::min);
    let enough = |model: &&Model| {
        model.cost <= PREFERRED * least || (model.states == 0 && data.vaf(model) >= 1.0 - WITHOUT)
    };
    let Some(model) = models.iter().find(enough) else {
        return Part::not("roll rate and steer angle do not change");
    };
    let vaf = |model: &Model| data.vaf(model);
    if vaf(model) < LEAST_VAF {
        let percent = 100.0 * vaf(model);
        return Part::not(format!("roll rate and steer angle explain {percent:.0} % of the torque only"));
    }
    let Some(errors) = data.errors(model, checked.samples(MEMORY_S)) else {
        return Part::not("the coefficients of the law are not separable");
    };
    let nyquist_hz = 0.5 / checked.period_s;
    let frequencies = FREQUENCIES_HZ.into_iter().filter(|f| *f < 0.5 * nyquist_hz);
    let response = |(j, frequency_hz): (usize, f64)| {
        let turns = frequency_hz * checked.period_s;
        let response = model.response(j, turns);
        let mut magnitude = errors.estimate(response.modulus(), &model.slope(j, turns))?;
        for other in models.iter().filter(|other| other.cost <= PREFERRED * model.cost) {
            let value = other.response(j, turns).modulus();
            (magnitude.low, magnitude.high) = (magnitude.low.min(value), magnitude.high.max(value));
        }
        let phase_deg = response.argument().to_degrees();
        Some(Response { input: recorded[kept[j]].0, frequency_hz, magnitude, phase_deg })
    };
    let inputs = 0..data.inputs.len();
    let responses =
        inputs.flat_map(|j| frequencies.clone().map(move |f| (j, f))).filter_map(response).collect();
    let speeds = &record.speed_m_s[stretch.clone()];
    Part::Found(MemoryLaw {
        states: model.states,
        vaf: vaf(model),
        vaf_without: models.first().map_or(0.0, vaf),
        from_s: record.times_s[stretch.start],
        to_s: record.times_s[stretch.end - 1],
        speed_m_s: speeds.iter().sum::<f64>() / speeds.len() as f64,
        responses,
    })
}

/// The longest stretch of driven samples with known inputs and nearly one speed.
fn stretch(record: &Record, checked: &Checked, inputs: &[(Signal, &[f64])]) -> std::ops::Range<usize> {
    let speed = &record.speed_m_s;
    let known = |i: usize| {
        checked.driven[i] && speed[i] >= SLOWEST_M_S && inputs.iter().all(|(_, values)| values[i].is_finite())
    };
    let mut longest = 0..0;
    for run in checked.breaks.windows(2) {
        let mut from = run[0];
        for i in run[0]..run[1] {
            if !known(i) {
                from = i + 1;
                continue;
            }
            let apart = |k: &usize| speed[*k].max(speed[i]) > SAME_SPEED * speed[*k].min(speed[i]);
            from = (from..i).rev().find(apart).map_or(from, |k| k + 1);
            from = from.max((i + 1).saturating_sub(MOST_SAMPLES));
            if i + 1 - from > longest.len() {
                longest = from..i + 1;
            }
        }
    }
    longest
}
