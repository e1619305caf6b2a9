//! The gains of a rider from a perturbation record.

use super::identify_text::{drift_name, select_name};
use crate::bicycle::catalogue::Bicycle;
use crate::bicycle::linear::Linear;
use crate::bicycle::{ForcePoint, Geometry};
use crate::identify::{
    Drift, GAINS, GrayBox, Hold, Identified, Plan, Problem, Pushed, Select, Signal, Stage, identify as fit,
    symbols,
};
use crate::recording::{ReadOptions, read};
use crate::replay::{Map, perturbed};
use crate::report::identify::{IdentifyDocument, RecordEntry, ResolvedIdentify};
use crate::report::resolved::ResolvedBicycle;
use crate::rider::{Covariance, Gains, Neuromuscular, RiderTable, Row};
use crate::rider_record::{Prepared, Settings, prepare};
use crate::sweep::sha256;
use std::error::Error;
use std::path::Path;

/// An error of a record.
type Failure = Box<dyn Error + Send + Sync>;

/// The neural delay of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Delay {
    /// Given \[s\].
    Given(f64),
    /// The likeliest.
    Estimate,
}

/// Choices of an identification.
#[derive(Clone, Debug)]
pub struct IdentifyChoice {
    /// The bicycle.
    pub bicycle: Bicycle,
    /// Assignment of the columns; `None`: by the columns.
    pub map: Option<Map>,
    /// Its name, for the document.
    pub map_name: String,
    /// How the record is read.
    pub read: ReadOptions,
    /// Forward speed \[m/s\] in place of the recorded one.
    pub speed_m_s: Option<f64>,
    /// Where the lateral force acts.
    pub force_at: ForcePoint,
    /// Signals to fit.
    pub fit: Vec<Signal>,
    /// Indices of the gains of the full fit; empty for all.
    pub gains: Vec<usize>,
    /// Neuromuscular dynamics.
    pub neuromuscular: Neuromuscular,
    /// Neural delay.
    pub delay: Delay,
    /// Delays of the profile \[s\].
    pub delays_s: Vec<f64>,
    /// Slow motion that is no response.
    pub drift: Drift,
    /// Time from the start that is not fitted \[s\].
    pub skip_s: f64,
    /// Course of the disturbance between two samples.
    pub hold: Hold,
    /// Whether the output of the impulse response is fitted in place of the signals.
    pub filter: bool,
    /// Whether the gains of the linear bicycle are kept.
    pub linear: bool,
    /// Criterion that selects the gains.
    pub select: Select,
    /// Variance accounted for at which the reduction ends; `None` for no reduction.
    pub reduce_until: Option<f64>,
    /// Seed of the global search.
    pub seed: u64,
}

impl IdentifyChoice {
    /// The choices that are made by default, for a bicycle.
    pub fn new(bicycle: Bicycle) -> Self {
        Self {
            bicycle,
            map: None,
            map_name: "by the columns".into(),
            read: ReadOptions { strict: false, dbc: Vec::new() },
            speed_m_s: None,
            force_at: ForcePoint::SADDLE,
            fit: vec![Signal::Steer],
            gains: Vec::new(),
            neuromuscular: Neuromuscular::SHOULDERS,
            delay: Delay::Given(0.03),
            delays_s: Vec::new(),
            drift: Drift::Offset,
            skip_s: 2.0,
            hold: Hold::Zero,
            filter: false,
            linear: false,
            select: Select::Full,
            reduce_until: Some(0.5),
            seed: 0,
        }
    }
}

/// A record that is ready for the fit.
#[derive(Clone, Debug)]
pub struct ReadyRecord {
    /// The record.
    pub record: RecordEntry,
    /// Configuration of the fit.
    pub config: ResolvedIdentify,
    problem: Problem,
    plan: Plan,
}

/// The rider of one record.
#[derive(Clone, Debug)]
pub struct FoundRider {
    /// The document.
    pub document: IdentifyDocument,
    /// What was found.
    pub found: Identified,
    /// The rider's table with one row.
    pub rider: RiderTable,
}

/// Delays of the profile if the delay is to be estimated and no range is given \[s\].
fn default_delays() -> Vec<f64> {
    (0..=24).map(|i| 0.005 * f64::from(i)).collect()
}

/// Delay from which the estimate of the delay starts \[s\]: the young cyclist's.
const START_DELAY_S: f64 = 0.03;

/// Reads a record and prepares its fit.
///
/// # Errors
/// The file, or the part of it that can't be used.
pub fn ready(choice: &IdentifyChoice, file: &Path) -> Result<ReadyRecord, Failure> {
    let name = file.display().to_string();
    let recording = read(file, &choice.read)?;
    let map = choice.map.as_ref().map_or_else(|| Map::of_perturbation(&recording), |map| Ok(map.clone()))?;
    let signals = perturbed(&recording, &map).map_err(|remark| remark.to_string())?;
    let settings = Settings { signals: choice.fit.clone(), hold: choice.hold, speed_m_s: choice.speed_m_s };
    let mut prepared = prepare(&signals, &settings)?;
    let concerning = recording.remarks.iter().filter(|remark| map.concerns_perturbation(remark));
    prepared.remarks.splice(0..0, concerning.map(ToString::to_string));
    let (problem, plan) = problem(choice, &prepared);
    let record = RecordEntry {
        sha256: sha256(&crate::input_file::bytes(file, crate::input_file::LARGEST_RECORDING)?),
        ..entry(&name, &prepared)
    };
    Ok(ReadyRecord { record, config: config(choice, &problem, &plan), problem, plan })
}

impl ReadyRecord {
    /// Fits the rider, on all cores of the current rayon pool. `begins` is called at each stage.
    ///
    /// # Errors
    /// The record determines no rider, or the fit was stopped ([`crate::identify::FitError::Interrupted`]).
    pub fn identify(
        self,
        bicycle: &Bicycle,
        begins: &(impl Fn(Stage) + Sync),
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<FoundRider, Failure> {
        let Self { record, config, problem, plan } = self;
        let name = record.file.clone();
        let found = fit(problem, &plan, begins, &|| stop())?;
        let document = IdentifyDocument::new(record, ResolvedBicycle::new(bicycle), config, &found);
        let rider = table_of(&name, bicycle, &found)?;
        Ok(FoundRider { document, found, rider })
    }
}

fn problem(choice: &IdentifyChoice, prepared: &Prepared) -> (Problem, Plan) {
    let linear = Linear::new(&choice.bicycle.parameters);
    let (delay_s, estimate_delay) = match choice.delay {
        Delay::Given(delay_s) => (delay_s, false),
        Delay::Estimate => (START_DELAY_S, true),
    };
    let profile = choice.delays_s.clone();
    let delays_s = if profile.is_empty() && estimate_delay { default_delays() } else { profile };
    let mut gains = choice.gains.clone();
    gains.sort_unstable();
    gains.dedup();
    let gains = if gains.is_empty() { (0..GAINS).collect() } else { gains };
    let model = GrayBox {
        bicycle: linear,
        force_input: linear.lateral_force_input(choice.force_at).into(),
        neuromuscular: choice.neuromuscular,
        speed_m_s: prepared.speed_m_s,
        delay_s,
    };
    let problem = Problem {
        record: prepared.record.clone(),
        model,
        drift: choice.drift,
        skip_s: choice.skip_s,
        seed: choice.seed,
    };
    let plan = Plan {
        gains,
        reduce_until: choice.reduce_until,
        select: choice.select,
        delays_s,
        estimate_delay,
        nonlinear: (!choice.linear).then(|| Pushed {
            bicycle: Geometry::new(&choice.bicycle.parameters),
            point: choice.force_at,
            speeds_m_s: prepared.speeds_m_s.clone(),
        }),
        filter: choice.filter,
    };
    (problem, plan)
}

fn entry(name: &str, prepared: &Prepared) -> RecordEntry {
    let record = &prepared.record;
    let root_mean_square = record.measured.iter().map(|measured| {
        let valid = (0..record.len()).filter(|k| measured.valid[*k]);
        let (sum, count) = valid.fold((0.0, 0.0), |(sum, n), k| (sum + measured.values[k].powi(2), n + 1.0));
        (measured.signal.name(), (sum / count).sqrt())
    });
    RecordEntry {
        file: name.into(),
        sha256: String::new(),
        samples: record.len(),
        sample_s: record.disturbances.sample_s,
        duration_s: record.duration_s(),
        speed_m_s: prepared.speed_m_s,
        speed_deviation_m_s: prepared.speed_deviation_m_s,
        root_mean_square: root_mean_square.collect(),
        remarks: prepared.remarks.clone(),
    }
}

fn config(choice: &IdentifyChoice, problem: &Problem, plan: &Plan) -> ResolvedIdentify {
    ResolvedIdentify {
        map: choice.map_name.clone(),
        force_at: choice.force_at,
        fit: choice.fit.clone(),
        feedback: plan.gains.iter().map(|i| symbols()[*i]).collect(),
        neuromuscular: problem.model.neuromuscular,
        delay_s: (!plan.estimate_delay).then_some(problem.model.delay_s),
        delay_profile_s: plan.delays_s.clone(),
        drift: drift_name(choice.drift),
        skip_s: choice.skip_s,
        hold: choice.hold,
        filter: choice.filter,
        linear: choice.linear,
        select: select_name(choice.select),
        reduce_until: plan.reduce_until,
        seed: choice.seed,
    }
}

/// The rider's table with one row.
fn table_of(name: &str, bicycle: &Bicycle, found: &Identified) -> Result<RiderTable, Failure> {
    let fit = found.fit();
    let model = &found.problem.model;
    let unknown = found.errors_unknown();
    let row = Row {
        speed_m_s: model.speed_m_s,
        run: None,
        group: 1,
        vaf: Some(100.0 * fit.mean_vaf()),
        gains: Gains::of_states(&fit.gains),
        covariance: match unknown {
            Some(_) => None,
            None => Some(Covariance::new(&fit.covariance, &fit.active)?),
        },
    };
    Ok(RiderTable {
        name: "identified".into(),
        source: Some(format!("identified from {name}")),
        note: unknown.map(|why| format!("{why}: the gains' errors are not known")),
        bicycle: Some(bicycle.name.clone()),
        delay_s: model.delay_s,
        neuromuscular: model.neuromuscular,
        best_runs: None,
        regression: None,
        columns: fit.active.clone(),
        rows: vec![row],
    })
}
