//! `sim-host replay`: replays recorded rides through the firmware's control code.

use super::interrupt;
use super::outputs::{Further, OutputArgs, Outputs, Results, complain, complain_once};
use super::scenario_error::failure;
use super::{Ended, Failure, UsageError};
use crate::commands::CommandError;
use crate::commands::replay::{Replay, ReplayChoice, ReplayedRecording, is_frames};
use crate::recording::CAN_LOGS;
use crate::replay::{CauseRecord, Press, Resample, SHIPPED, Summary};
use crate::report::figure::{self, ReplayFigure};
use crate::report::replay::{ReplayResult, ReplaysDocument, summary_text, text};
use crate::report::table;
use crate::report::tool::SCHEMA;
use crate::report::tool::Tool;
use crate::scenario::{Preset, Scenario, seed};
use control::wire::encode_frame;
use std::path::{Path, PathBuf};

/// What the files and maps can be, and examples.
pub(super) fn help() -> String {
    let (logs, maps) = (CAN_LOGS.join(", "), SHIPPED.map(|(name, _)| name).join(", "));
    format!(
        "\
FILE is a table of samples with named columns (also gzipped), such as the output of `monitor --csv`, a recording of \
CAN frames ({logs}) with its DBC, or frames of `ride --frames` (81 bytes each). The table of `ride --csv` has no \
samples. A map assigns the columns to sensors; see docs/replay.md. Built-in maps: {maps}. \
Replay is open loop: the computed torque did not act on the recorded bicycle.

{EXAMPLES}"
    )
}

const EXAMPLES: &str = "\
Exit codes: 0 ran, 1 bad input or nothing usable, 2 usage, 130 interrupted; alarms are a result.

Examples:
  sim-host replay ride.csv --map extract --json
  sim-host replay robot/*.csv.gz --map robot-bicycle
  sim-host replay ride.csv --map my.toml --fault gyro:flip@2s --svg ride.svg
  sim-host replay can.log --dbc bicycle.dbc --map can.toml --set permit.fallen_rad=0.9
  sim-host replay border.frames --frames again.frames";

/// Options of `replay`.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Assignment of the columns: the name of a built-in map, or a FILE [default: by the columns]
    #[arg(long, value_name = "NAME|FILE")]
    map: Option<String>,
    /// Database that decodes CAN frames; may be repeated
    #[arg(long, value_name = "FILE")]
    dbc: Vec<PathBuf>,
    /// Reject a recording at the first unusable line, instead of using the rest
    #[arg(long)]
    strict: bool,
    /// Between two samples: hold the older, or interpolate [default: the map's]
    #[arg(long)]
    resample: Option<Resample>,
    /// Longest time between two samples that is interpolated, in seconds [default: 0.5]
    #[arg(long, value_name = "S", value_parser = positive)]
    longest_gap: Option<f64>,
    /// When to press the switch in a recording without one [default: again]
    #[arg(long)]
    press: Option<Press>,
    /// Defaults of the parameters
    #[arg(long, default_value = "product")]
    preset: Preset,
    /// Roll-rate law, as in `ride` [default: product: h-cut; thesis: h]
    #[arg(long)]
    law: Option<String>,
    /// Bicycle whose geometry the firmware is configured with: built-in, FILE, or FILE#NAME
    #[arg(long, value_name = "NAME|FILE")]
    bicycle: Option<String>,
    /// Law and parameters from a file, as written by `param export`; --law and --set have precedence
    #[arg(long, value_name = "FILE")]
    parameters: Option<PathBuf>,
    /// Any parameter of the firmware, for example cross.yaw_rad_s=1; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Inject a fault into the recorded data, for example gyro:flip@2s; may be repeated. CHANNEL and KIND are those of `ride`
    /// (`ride --help`) except motor; a CHANNEL alone lists its kinds
    #[arg(long, value_name = "CHANNEL:KIND@FROM..TO", allow_hyphen_values = true)]
    fault: Vec<String>,
    /// Seed of the faults' noise and dropouts
    #[arg(long, value_name = "N", default_value_t = 0, requires = "fault", value_parser = seed)]
    seed: u64,
    /// Time between two rows of the table, in seconds
    #[arg(long, value_name = "S", default_value_t = 0.01, value_parser = positive)]
    every: f64,
    /// Write the frames that the firmware received, 81 bytes each, for the chip; one recording only
    #[arg(long, value_name = "FILE")]
    frames: Option<PathBuf>,
    #[command(flatten)]
    outputs: OutputArgs,
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if (1e-6..=3600.0).contains(&value) {
        Ok(value)
    } else {
        Err(format!("{text} is outside 0.000001 to 3600"))
    }
}

/// The given options that act on recordings of samples only.
fn of_samples(args: &Args) -> Vec<&'static str> {
    let all = [
        ("--map", args.map.is_some()),
        ("--dbc", !args.dbc.is_empty()),
        ("--strict", args.strict),
        ("--resample", args.resample.is_some()),
        ("--longest-gap", args.longest_gap.is_some()),
        ("--press", args.press.is_some()),
        ("--fault", !args.fault.is_empty()),
    ];
    all.into_iter().filter_map(|(option, given)| given.then_some(option)).collect()
}

/// Rejects options that have no effect on any recording; of those that have none on some, tells which.
fn refuse_idle(args: &Args) -> Result<(), UsageError> {
    let given = of_samples(args);
    let Some(option) = given.first() else { return Ok(()) };
    let (framed, sampled): (Vec<&PathBuf>, Vec<_>) = args.files.iter().partition(|file| is_frames(file));
    let bit_for_bit = |file: &Path| format!("{} has frames, which are replayed bit for bit", file.display());
    match framed.first() {
        Some(file) if sampled.is_empty() => {
            let frames = bit_for_bit(file);
            return Err(UsageError(format!("{option} acts on recordings of samples; {frames}")));
        }
        _ => {}
    }
    for file in framed {
        let (frames, options) = (bit_for_bit(file), given.join(", "));
        complain(&format!("warning: {frames}, without effect of {options}"));
    }
    Ok(())
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    refuse_idle(args)?;
    if args.files.len() > 1 {
        args.outputs.refuse_figures("a figure is of one recording only")?;
        if args.frames.is_some() {
            return Err("--frames: frames are of one recording only".into());
        }
    }
    let named = |error| failure(&Scenario::default(), error);
    let replay = Replay::new(choice(args)).map_err(named)?;
    replay.remarks.iter().for_each(|remark| complain_once(remark));
    let one = |file: &PathBuf| {
        let done = replay.file(file).map_err(of_recording)?;
        let ReplayResult { file, without_effect, .. } = &done.result;
        without_effect.iter().for_each(|warning| complain(&format!("warning: {file}: {warning}")));
        Ok::<_, Failure>(done)
    };
    let outputs = args.outputs.open(Further { frames: args.frames.as_deref(), ..Further::default() })?;
    if let [file] = args.files.as_slice() {
        let done = one(file)?;
        return write_one(args, &outputs, &done);
    }
    interrupt::install_saying("the finished recordings are reported");
    let (mut all, mut unusable) = (Vec::new(), Vec::new());
    for file in &args.files {
        if interrupt::stopped() {
            break;
        }
        match one(file) {
            Ok(done) => all.push(done),
            Err(error) => {
                complain(&format!("error: {error}"));
                unusable.push(error.to_string());
            }
        }
    }
    let ended = if interrupt::stopped() { Ended::Interrupted } else { Ended::Done };
    write_many(&replay, &outputs, all, unusable)?;
    Ok(ended)
}

/// The choices of the options.
fn choice(args: &Args) -> ReplayChoice {
    let defaults = ReplayChoice::default();
    ReplayChoice {
        map: args.map.clone(),
        dbc: args.dbc.clone(),
        strict: args.strict,
        resample: args.resample,
        longest_gap_s: args.longest_gap,
        press: args.press.unwrap_or(defaults.press),
        preset: args.preset,
        law: args.law.clone(),
        bicycle: args.bicycle.clone(),
        parameters: args.parameters.clone(),
        set: args.set.clone(),
        faults: args.fault.clone(),
        seed: args.seed,
        every_s: args.every,
    }
}

/// An error of a recording; that of an option with the option.
fn of_recording(error: Box<dyn std::error::Error + Send + Sync>) -> Failure {
    match error.downcast::<CommandError>() {
        Ok(error) => failure(&Scenario::default(), *error),
        Err(error) => error,
    }
}

fn write_one(args: &Args, outputs: &Outputs, done: &ReplayedRecording) -> Result<Ended, Failure> {
    let ReplayedRecording { result, config, frames } = done;
    let replayed = &result.replayed;
    let document = done.document();
    let figure = ReplayFigure {
        title: &result.file,
        rows: &replayed.rows,
        modes: &replayed.modes,
        causes: &replayed.causes,
    };
    let framed = match args.frames {
        Some(_) => outputs.write_frames(|| frames.iter().flat_map(encode_frame).collect()),
        None => Ok(()),
    };
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || text(result),
        table: || table::table(&config, &replayed.rows),
        figure: || figure::replay(&figure),
    })?;
    framed.map(|()| Ended::Done)
}

fn write_many(
    replay: &Replay,
    outputs: &Outputs,
    all: Vec<ReplayedRecording>,
    unusable: Vec<String>,
) -> Result<(), Failure> {
    let Some(first) = all.first() else { return Err("none of the recordings can be used".into()) };
    let config = first.config.clone();
    let fault_s = replay.faults.iter().map(|fault| fault.from_s).reduce(f64::min);
    let summary = Summary::new(all.iter().map(|done| &done.result.replayed), fault_s);
    let failed = unusable.len();
    let results: Vec<_> = all.into_iter().map(|done| done.result).collect();
    let rows: Vec<_> = results
        .iter()
        .flat_map(|result| result.replayed.causes.iter().map(|cause| (result.file.clone(), cause.clone())))
        .collect();
    let text = summary_text(&results, &summary);
    let document = ReplaysDocument {
        schema: SCHEMA,
        tool: Tool::this(),
        config: config.clone(),
        recordings: results,
        unusable,
        summary,
    };
    let table = || {
        let header = ["file", "number", "name", "first_s", "count", "total_s", "alarms"].map(str::to_owned);
        let row = |(file, c): &(String, CauseRecord)| {
            (file.clone(), c.number, c.name, c.first_s, c.count, c.total_s, c.alarms)
        };
        table::rows(&config, &header, rows.iter().map(row))
    };
    outputs.write_data(&document, table, || text)?;
    if failed > 0 { Err(format!("{failed} of the recordings could not be used").into()) } else { Ok(()) }
}
