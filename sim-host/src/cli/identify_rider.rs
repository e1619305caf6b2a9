//! `sim-host identify RECORD`: the gains of a rider from perturbation records.

use super::command_line::command_line;
use super::identify_rider_args::{Delay, RiderArgs, drift_name, select_name};
use super::identify_rider_results::{Finished, Store};
use super::inputs::once;
use super::interrupt;
use super::outputs::{Further, Outputs, Results, complain};
use super::progress::progress;
use super::{Ended, Failure, warn};
use crate::bicycle::Geometry;
use crate::bicycle::catalogue::Bicycle;
use crate::bicycle::linear::Linear;
use crate::identify::{
    FitError, GAINS, GrayBox, Identified, Plan, Problem, Pushed, Stage, identify, symbols,
};
use crate::recording::{RecordingError, read};
use crate::replay::{Map, perturbed};
use crate::report::figure;
use crate::report::identify::{
    IdentifyDocument, IdentifyManyDocument, RecordEntry, ReductionRow, ResolvedIdentify, chart, page, rows,
    text,
};
use crate::report::output::Output;
use crate::report::resolved::ResolvedBicycle;
use crate::report::table;
use crate::report::tool::{SCHEMA, Tool};
use crate::rider::{Covariance, Gains, Neuromuscular, RiderTable, Row, merge};
use crate::rider_record::{Prepared, Settings, prepare};
use crate::sweep::sha256;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;
use std::time::Duration;

/// Delays of the profile if the delay is to be estimated and no range is given \[s\].
fn default_delays() -> Vec<f64> {
    (0..=24).map(|i| 0.005 * f64::from(i)).collect()
}

/// Delay from which the estimate of the delay starts \[s\]: the young cyclist's.
const START_DELAY_S: f64 = 0.03;
/// Speeds of records in one group of the rider's file differ by at most this \[m/s\].
const GROUP_M_S: f64 = 0.3;

/// Time between looks at records that others identify.
const LOOK: Duration = Duration::from_millis(500);

pub(super) fn run(args: &RiderArgs) -> Result<Ended, Failure> {
    once(&args.files)?;
    distinct("--feedback", args.feedback.iter().map(|gain| symbols()[*gain]))?;
    distinct("--fit", args.fit.iter().map(|signal| signal.name()))?;
    let bicycle = args.bicycle.load()?;
    warn(&bicycle);
    let map = args.recording.map()?;
    let many = args.files.len() > 1;
    if many || args.results.is_some() {
        args.outputs.refuse_figures(
            "a figure shows one record; with --results each record has a page with figures",
        )?;
    }
    if many && args.report.is_some() {
        return Err("--report: a report is of one record; give one, or --results".into());
    }
    let outputs = args.outputs.open(Further::default())?;
    let out = args.out.as_deref().map(Output::create).transpose()?;
    if let Some(out) = &out {
        outputs.refuse_place_of("--out", out)?;
    }
    let report = args.report.as_deref().map(Output::create).transpose()?;
    if let Some(report) = &report {
        outputs.refuse_place_of("--report", report)?;
        if out.as_ref().is_some_and(|out| out.collides(report)) {
            return Err("--out and --report have the same place to write to".into());
        }
    }
    let store = args.results.as_deref().map(|folder| Store::open(folder, &args.files)).transpose()?;
    interrupt::install_saying("finished records are written");
    let bar = progress(outputs.shows_progress(), "identify", 4 * args.files.len(), "stages");
    let (mut finished, mut refused) = (BTreeMap::new(), BTreeMap::new());
    let mut open: VecDeque<usize> = (0..args.files.len()).collect();
    // Records that other processes with the same folder of results identify.
    let mut elsewhere = VecDeque::new();
    while !interrupt::stopped() {
        let Some(i) = open.pop_front() else {
            if elsewhere.is_empty() {
                break;
            }
            open = std::mem::take(&mut elsewhere);
            std::thread::sleep(LOOK);
            continue;
        };
        let file = &args.files[i];
        let begins = |_: Stage| bar.inc(1);
        let of_this = || one(args, &bicycle, map.as_ref(), file, store.as_ref(), &begins);
        let of_one = match &store {
            None => of_this(),
            Some(store) => match store.alone(file, of_this)? {
                Some(of_one) => of_one,
                None => {
                    elsewhere.push_back(i);
                    continue;
                }
            },
        };
        match of_one {
            Ok(one) => drop(finished.insert(i, one)),
            Err(error) if error.downcast_ref() == Some(&FitError::Interrupted) => break,
            Err(error) if many => {
                let reason = reason(file, error.as_ref());
                complain(&format!("{}: not used: {reason}", file.display()));
                refused.insert(file.display().to_string(), reason);
            }
            Err(error) => return Err(format!("{}: {}", file.display(), reason(file, error.as_ref())).into()),
        }
    }
    bar.finish_and_clear();
    let finished: Vec<Finished> = finished.into_values().collect();
    if finished.is_empty() {
        if interrupt::stopped() {
            return Ok(Ended::Interrupted);
        }
        return Err("no record could be used".into());
    }
    let rider = rider(&finished)?;
    let rider_file = args.out.as_ref().filter(|_| out.is_some()).map(|path| path.display().to_string());
    let page = finished[0].page.clone();
    write(outputs, finished, refused, rider_file, many)?;
    if let Some(out) = out {
        out.finish(rider.to_toml().as_bytes())?;
    }
    report.map_or(Ok(()), |report| report.finish(page.as_bytes()))?;
    Ok(if interrupt::stopped() { Ended::Interrupted } else { Ended::Done })
}

/// Rejects a word that an option's list contains twice.
fn distinct<'a>(option: &str, mut words: impl Iterator<Item = &'a str>) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    match words.find(|word| !seen.insert(*word)) {
        Some(twice) => Err(format!("{option}: {twice} is given twice")),
        None => Ok(()),
    }
}

/// Why a record is not used, without its name.
fn reason(file: &Path, error: &(dyn std::error::Error + 'static)) -> String {
    error.downcast_ref::<RecordingError>().map_or_else(|| error.to_string(), |error| error.beside(file))
}

/// One rider of all records.
fn rider(finished: &[Finished]) -> Result<RiderTable, Failure> {
    match finished {
        [one] => Ok(one.rider.clone()),
        all => {
            let riders: Vec<RiderTable> = all.iter().map(|one| one.rider.clone()).collect();
            let files: Vec<&str> =
                all.iter().map(|one| one.document["record"]["file"].as_str().unwrap_or_default()).collect();
            let source = Some(format!("identified from {}", files.join(", ")));
            Ok(RiderTable { source, ..merge("identified", &riders, GROUP_M_S)? })
        }
    }
}

fn write(
    outputs: Outputs,
    finished: Vec<Finished>,
    refused: BTreeMap<String, String>,
    rider_file: Option<String>,
    many: bool,
) -> Result<(), Failure> {
    let texts: Vec<String> = finished.iter().map(|one| one.text.clone()).collect();
    let lines: Vec<ReductionRow> = finished.iter().flat_map(|one| rows(&one.document)).collect();
    let figure = finished[0].chart.clone();
    let mut documents: Vec<serde_json::Value> = finished.into_iter().map(|one| one.document).collect();
    documents.iter_mut().for_each(|document| document["rider_file"] = rider_file.clone().into());
    let config = serde_json::json!({"bicycle": documents[0]["bicycle"], "config": documents[0]["config"]});
    let document = if many {
        let tool = Tool::this();
        serde_json::to_value(IdentifyManyDocument {
            schema: SCHEMA,
            tool,
            records: documents,
            refused,
            rider_file,
        })?
    } else {
        documents.remove(0)
    };
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || texts.join("\n"),
        table: || table::table(&config, &lines),
        figure: || figure::chart(&figure),
    })
}

/// Identifies the rider of one record, or takes it from the finished ones.
fn one(
    args: &RiderArgs,
    bicycle: &Bicycle,
    map: Option<&Map>,
    file: &Path,
    store: Option<&Store>,
    begins: &(impl Fn(Stage) + Sync),
) -> Result<Finished, Failure> {
    let name = file.display().to_string();
    let recording = read(file, &args.recording.options())?;
    let map = map.map_or_else(|| Map::of_perturbation(&recording), |map| Ok(map.clone()))?;
    let signals = perturbed(&recording, &map).map_err(|remark| remark.to_string())?;
    let settings = Settings { signals: args.fit.clone(), hold: args.hold, speed_m_s: args.speed };
    let mut prepared = prepare(&signals, &settings)?;
    let concerning = recording.remarks.iter().filter(|remark| map.concerns_perturbation(remark));
    prepared.remarks.splice(0..0, concerning.map(ToString::to_string));
    prepared.remarks.iter().for_each(|remark| complain(&format!("{name}: {remark}")));
    let (problem, plan) = problem(args, bicycle, &prepared);
    let record = RecordEntry { sha256: sha256(&std::fs::read(file)?), ..entry(&name, &prepared) };
    let config = config(args, &problem, &plan);
    if let Some(done) = store.and_then(|store| store.finished(file, &record, &config, bicycle)) {
        complain(&format!("{name}: finished before; not fitted again"));
        return Ok(done);
    }
    let found = identify(problem, &plan, begins, &interrupt::stopped)?;
    let document = IdentifyDocument::new(record, ResolvedBicycle::new(bicycle), config, &found);
    document.warnings.iter().for_each(|warning| complain(&format!("{name}: warning: {warning}")));
    let rider = table_of(&name, bicycle, &found)?;
    let reported = args.report.is_some() || store.is_some();
    let page = || page(&document, &found, &command_line(), &rider.to_toml());
    let finished = Finished {
        page: if reported { page() } else { String::new() },
        text: text(&document),
        chart: chart(&document, &found),
        rider,
        document: serde_json::to_value(&document)?,
    };
    store.map_or(Ok(()), |store| store.keep(file, &finished))?;
    Ok(finished)
}

fn problem(args: &RiderArgs, bicycle: &Bicycle, prepared: &Prepared) -> (Problem, Plan) {
    let linear = Linear::new(&bicycle.parameters);
    let (delay_s, estimate_delay) = match args.delay {
        Delay::Given(delay_s) => (delay_s, false),
        Delay::Estimate => (START_DELAY_S, true),
    };
    let profile = args.delay_profile.0.clone();
    let delays_s = if profile.is_empty() && estimate_delay { default_delays() } else { profile };
    let mut gains = args.feedback.clone();
    gains.sort_unstable();
    let gains = if gains.is_empty() { (0..GAINS).collect() } else { gains };
    let model = GrayBox {
        bicycle: linear,
        force_input: linear.lateral_force_input(args.force_at).into(),
        neuromuscular: args.neuromuscular.unwrap_or(Neuromuscular::SHOULDERS),
        speed_m_s: prepared.speed_m_s,
        delay_s,
    };
    let problem = Problem {
        record: prepared.record.clone(),
        model,
        drift: args.drift,
        skip_s: args.skip,
        seed: args.seed,
    };
    let plan = Plan {
        gains,
        reduce_until: args.reduce_until.0,
        select: args.select,
        delays_s,
        estimate_delay,
        nonlinear: (!args.linear).then(|| Pushed {
            bicycle: Geometry::new(&bicycle.parameters),
            point: args.force_at,
            speeds_m_s: prepared.speeds_m_s.clone(),
        }),
        filter: args.filter,
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

fn config(args: &RiderArgs, problem: &Problem, plan: &Plan) -> ResolvedIdentify {
    ResolvedIdentify {
        map: args.recording.map_name(),
        force_at: args.force_at,
        fit: args.fit.clone(),
        feedback: plan.gains.iter().map(|i| symbols()[*i]).collect(),
        neuromuscular: problem.model.neuromuscular,
        delay_s: (!plan.estimate_delay).then_some(problem.model.delay_s),
        delay_profile_s: plan.delays_s.clone(),
        drift: drift_name(args.drift),
        skip_s: args.skip,
        hold: args.hold,
        filter: args.filter,
        linear: args.linear,
        select: select_name(args.select),
        reduce_until: plan.reduce_until,
        seed: args.seed,
    }
}

/// The rider's table with one row.
fn table_of(name: &str, bicycle: &Bicycle, found: &Identified) -> Result<RiderTable, Failure> {
    let fit = found.fit();
    let model = &found.problem.model;
    let row = Row {
        speed_m_s: model.speed_m_s,
        run: None,
        group: 1,
        vaf: Some(100.0 * fit.mean_vaf()),
        gains: Gains::of_states(&fit.gains),
        covariance: found.has_errors().then(|| Covariance::new(&fit.covariance, &fit.active)).transpose()?,
    };
    Ok(RiderTable {
        name: "identified".into(),
        source: Some(format!("identified from {name}")),
        note: (!found.has_errors())
            .then(|| "not refined on the nonlinear bicycle: the gains' errors are not known".into()),
        bicycle: Some(bicycle.name.clone()),
        delay_s: model.delay_s,
        neuromuscular: model.neuromuscular,
        best_runs: None,
        regression: None,
        columns: fit.active.clone(),
        rows: vec![row],
    })
}
