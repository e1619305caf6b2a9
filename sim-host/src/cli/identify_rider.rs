//! `sim-host identify RECORD`: the gains of a rider from perturbation records.

use super::command_line::command_line;
use super::identify_rider_args::RiderArgs;
use super::identify_rider_results::{Finished, Store};
use super::inputs::once;
use super::interrupt;
use super::outputs::{Further, Outputs, Results, complain};
use super::progress::{print_wait, progress};
use super::{Ended, Failure, warn};
use crate::bicycle::catalogue::Bicycle;
use crate::commands::identify::{FoundRider, IdentifyChoice, ready};
use crate::identify::{FitError, Stage, symbols};
use crate::recording::RecordingError;
use crate::report::figure;
use crate::report::identify::{IdentifyManyDocument, ReductionRow, chart, page, rows, text};
use crate::report::output::Output;
use crate::report::table;
use crate::report::tool::{SCHEMA, Tool};
use crate::rider::{Neuromuscular, RiderTable, merge};
use crate::sweep::Reminder;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;
use std::time::Duration;

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
    let choice = choice(args, bicycle)?;
    let many = args.files.len() > 1;
    if many || args.results.is_some() {
        args.outputs.refuse_figures(
            "a figure shows one record; with --results each record has a page with figures",
        )?;
    }
    if many && args.report.is_some() {
        return Err("--report: a report is of one record; give one, or --results".into());
    }
    let (outputs, out, report) = places(args)?;
    let store = args.results.as_deref().map(|folder| Store::open(folder, &args.files)).transpose()?;
    interrupt::install_saying(if many {
        "the record under way is given up, finished ones are written"
    } else {
        "the record under way is given up"
    });
    let (finished, refused) = each(args, &choice, store.as_ref(), outputs.shows_progress())?;
    if finished.is_empty() {
        if interrupt::stopped() {
            complain("interrupted: no record is finished, nothing is written");
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

/// The places of documents, rider and page, which are distinct.
fn places(args: &RiderArgs) -> Result<(Outputs, Option<Output>, Option<Output>), Failure> {
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
    Ok((outputs, out, report))
}

/// Identifies every record, or as many as are finished when Ctrl-C is pressed; of several records, those that can't be used are
/// left out and returned with the reason.
fn each(
    args: &RiderArgs,
    choice: &IdentifyChoice,
    store: Option<&Store>,
    shows_progress: bool,
) -> Result<(Vec<Finished>, BTreeMap<String, String>), Failure> {
    let bar = progress(shows_progress, "identify", 4 * args.files.len(), "stages");
    let (mut finished, mut refused) = (BTreeMap::new(), BTreeMap::new());
    let mut open: VecDeque<usize> = (0..args.files.len()).collect();
    // Records that other processes with the same folder of results identify.
    let (mut elsewhere, mut reminder) = (VecDeque::new(), Reminder::default());
    while !interrupt::stopped() {
        let Some(i) = open.pop_front() else {
            if elsewhere.is_empty() {
                break;
            }
            open = std::mem::take(&mut elsewhere);
            if let Some(store) = store.filter(|_| reminder.is_due()) {
                let wait = store.wait(open.iter().map(|i| args.files[*i].as_path()));
                print_wait(shows_progress, &bar, &wait);
            }
            std::thread::sleep(LOOK);
            continue;
        };
        let file = &args.files[i];
        let begins = |_: Stage| bar.inc(1);
        let of_this = || one(args, choice, file, store, &begins);
        let of_one = match store {
            None => of_this(),
            Some(store) => match store.alone(file, of_this)? {
                Some(of_one) => of_one,
                None => {
                    elsewhere.push_back(i);
                    continue;
                }
            },
        };
        reminder.over();
        match of_one {
            Ok(one) => drop(finished.insert(i, one)),
            Err(error) if error.downcast_ref() == Some(&FitError::Interrupted) => break,
            Err(error) if args.files.len() > 1 => {
                let reason = reason(file, error.as_ref());
                complain(&format!("{}: not used: {reason}", file.display()));
                refused.insert(file.display().to_string(), reason);
            }
            Err(error) => return Err(format!("{}: {}", file.display(), reason(file, error.as_ref())).into()),
        }
    }
    bar.finish_and_clear();
    Ok((finished.into_values().collect(), refused))
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
    choice: &IdentifyChoice,
    file: &Path,
    store: Option<&Store>,
    begins: &(impl Fn(Stage) + Sync),
) -> Result<Finished, Failure> {
    let name = file.display().to_string();
    let ready = ready(choice, file).map_err(|error| -> Failure { error })?;
    ready.record.remarks.iter().for_each(|remark| complain(&format!("{name}: {remark}")));
    let finished_before = |store: &Store| store.finished(file, &ready.record, &ready.config, &choice.bicycle);
    if let Some(done) = store.and_then(finished_before) {
        complain(&format!("{name}: finished before; not fitted again"));
        return Ok(done);
    }
    let found = ready.identify(&choice.bicycle, begins, &interrupt::stopped);
    let FoundRider { document, found, rider } = found.map_err(|error| -> Failure { error })?;
    document.warnings.iter().for_each(|warning| complain(&format!("{name}: warning: {warning}")));
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

/// The choices of the options.
fn choice(args: &RiderArgs, bicycle: Bicycle) -> Result<IdentifyChoice, Failure> {
    Ok(IdentifyChoice {
        map: args.recording.map()?,
        map_name: args.recording.map_name(),
        read: args.recording.options(),
        speed_m_s: args.speed,
        force_at: args.force_at,
        fit: args.fit.clone(),
        gains: args.feedback.clone(),
        neuromuscular: args.neuromuscular.unwrap_or(Neuromuscular::SHOULDERS),
        delay: args.delay,
        delays_s: args.delay_profile.0.clone(),
        drift: args.drift,
        skip_s: args.skip,
        hold: args.hold,
        filter: args.filter,
        linear: args.linear,
        select: args.select,
        reduce_until: args.reduce_until.0,
        seed: args.seed,
        ..IdentifyChoice::new(bicycle)
    })
}
