//! `sim-host replay`: replays recorded rides through the firmware's control code.

use super::interrupt;
use super::outputs::{Further, OutputArgs, Outputs, Results, complain, complain_once};
use super::{Ended, Failure, warn};
use crate::bicycle::onboard::fit;
use crate::bicycle::{Geometry, catalogue};
use crate::parameters;
use crate::plant::{Fault, ImuMount};
use crate::recording::{ReadOptions, read};
use crate::replay::{
    CauseRecord, Feed, FeedOptions, Fitted, Map, Press, Resample, RunOptions, Samples, Summary, fitted,
    frames, run as run_through, samples,
};
use crate::report::figure::{self, ReplayFigure};
use crate::report::replay::{
    ReplayConfig, ReplayDocument, ReplayResult, ReplaysDocument, summary_text, text,
};
use crate::report::table;
use crate::report::tool::SCHEMA;
use crate::report::tool::Tool;
use crate::ride::frame_of;
use crate::scenario::{ParameterFile, Preset, law};
use control::wire::encode_frame;
use control::{Config, Law, SensorFrame};
use std::path::{Path, PathBuf};

pub(super) const EXAMPLES: &str = "\
FILE is a table of samples with named columns (also gzipped), such as the output of `monitor --csv`, a recording of
CAN frames (candump, ASC, MDF4) with its DBC, or frames of `ride --frames` (81 bytes each).
A map assigns the columns to sensors; see docs/replay.md. Built-in maps: extract, monitor, robot-bicycle, can-bicycle.
Replay is open loop: the computed torque did not act on the recorded bicycle.

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
    /// Longest time between two samples that is interpolated, in seconds
    #[arg(long, value_name = "S", default_value_t = 0.5, value_parser = positive)]
    longest_gap: f64,
    /// When to press the switch in a recording without one
    #[arg(long, default_value = "again")]
    press: Press,
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
    /// Inject a fault into the recorded data, for example gyro:flip@2s; may be repeated
    #[arg(long, value_name = "CHANNEL:KIND@FROM..TO", allow_hyphen_values = true)]
    fault: Vec<String>,
    /// Seed of the faults' noise and dropouts
    #[arg(long, value_name = "N", default_value_t = 0)]
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

/// Data common to all recordings.
struct Common {
    config: Config,
    law_name: String,
    file: Option<ParameterFile>,
    faults: Vec<Fault>,
    map: Option<Map>,
}

/// Result of one recording.
struct Done {
    result: ReplayResult,
    config: ReplayConfig,
    frames: Vec<SensorFrame>,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    if args.files.len() > 1 {
        args.outputs.refuse_figures("a figure is of one recording only")?;
        if args.frames.is_some() {
            return Err("--frames: frames are of one recording only".into());
        }
    }
    let common = common(args)?;
    let outputs = args.outputs.open(Further { frames: args.frames.as_deref(), ..Further::default() })?;
    if let [file] = args.files.as_slice() {
        let done = one(args, &common, file)?;
        return write_one(args, &outputs, &done);
    }
    interrupt::install_saying("the finished recordings are reported");
    let (mut all, mut unusable) = (Vec::new(), Vec::new());
    for file in &args.files {
        if interrupt::stopped() {
            break;
        }
        match one(args, &common, file) {
            Ok(done) => all.push(done),
            Err(error) => {
                complain(&format!("error: {error}"));
                unusable.push(error.to_string());
            }
        }
    }
    let ended = if interrupt::stopped() { Ended::Interrupted } else { Ended::Done };
    write_many(&common, &outputs, all, unusable)?;
    Ok(ended)
}

fn common(args: &Args) -> Result<Common, Failure> {
    let base = match args.preset {
        Preset::Thesis => Config::thesis(Law::H { cut: false }),
        Preset::Product => Config::product(),
    };
    let file = args.parameters.as_deref().map(ParameterFile::read).transpose()?;
    let law = match (&args.law, file.as_ref().and_then(|file| file.law.clone())) {
        (Some(name), _) => law::parse(name)?,
        (None, Some(law)) => law,
        (None, None) => base.law.clone(),
    };
    let faults = args.fault.iter().map(|text| text.parse::<Fault>());
    let faults = faults.collect::<Result<_, _>>().map_err(|e| format!("--fault: {e}"))?;
    let map = args.map.as_deref().map(Map::load).transpose().map_err(|error| format!("--map {error}"))?;
    let law_name = law.to_string();
    let mut config = Config { law, ..base };
    if let Some(name) = &args.bicycle {
        let bicycle = catalogue::load(name)?;
        warn(&bicycle);
        for reason in fit(&mut config, &Geometry::new(&bicycle.parameters), ImuMount::default().point_m) {
            complain_once(&format!("note: {name}: for the flashed code {reason}"));
        }
    }
    Ok(Common { config, law_name, file, faults, map })
}

impl Common {
    /// The plan for a recording with these samples.
    fn plan(
        &self,
        args: &Args,
        recorded: Option<(&Samples, &Map)>,
    ) -> Result<(control::Plan, Fitted), Failure> {
        let mut config = self.config.clone();
        config.calibration.polarity_checked = true;
        let fitted = match recorded {
            Some((samples, map)) => {
                fitted(&mut config, samples, map).map_err(|error| format!("--map: {error}"))?
            }
            None => Fitted::default(),
        };
        if let Some(file) = &self.file {
            file.apply(&mut config)?;
        }
        for word in &args.set {
            let (key, value) = word.split_once('=').ok_or(format!("--set {word}: expected KEY=VALUE"))?;
            parameters::set(&mut config, key, value).map_err(|error| format!("--set {word}: {error}"))?;
        }
        Ok((config.plan()?, fitted))
    }
}

fn one(args: &Args, common: &Common, path: &Path) -> Result<Done, Failure> {
    let name = path.display().to_string();
    let framed = path.extension().is_some_and(|extension| extension == "frames");
    if framed {
        return replay_frames(args, common, path, name);
    }
    let options = ReadOptions { strict: args.strict, dbc: args.dbc.clone() };
    let recording = read(path, &options)?;
    let map = match &common.map {
        Some(map) => map.clone(),
        None => Map::by_columns(&recording)
            .ok_or(format!("{name}: no built-in map has these columns; give one with --map"))?,
    };
    let period_s = 1.0 / f64::from(common.config.rate_hz);
    let samples = samples(&recording, &map, period_s).map_err(|remark| format!("{name}: {remark}"))?;
    if let (true, Some(remark)) = (args.strict, samples.remarks.first()) {
        return Err(format!("{name}: {remark}").into());
    }
    let (plan, fitted) = common.plan(args, Some((&samples, &map)))?;
    let resample = args.resample.unwrap_or(map.resample);
    let feed = FeedOptions {
        period_s: 1.0 / f64::from(plan.config().rate_hz),
        resample,
        longest_gap_s: args.longest_gap,
        faults: &common.faults,
        seed: args.seed,
    };
    let mut feed = Feed::new(&samples, feed).map_err(|error| format!("{name}: {error}"))?;
    let mut kept = Vec::new();
    let options = RunOptions {
        press: args.press,
        every_s: args.every,
        roll_rad: &samples.roll_rad,
        torque_nm: &samples.torque_nm,
    };
    let replayed = run_through(&plan, &options, |pressed| {
        let (t_s, measured) = feed.next(pressed)?;
        let frame = frame_of(&plan, &measured);
        if args.frames.is_some() {
            kept.push(frame);
        }
        Some((t_s, frame))
    });
    let resample = match resample {
        Resample::Hold => "hold",
        Resample::Interpolate => "interpolate",
    };
    let config = resolved(args, common, &plan, Some(resample));
    let remarks = samples.remarks.iter().map(ToString::to_string).collect();
    let result = ReplayResult { file: name, remarks, fitted, replayed };
    Ok(Done { result, config, frames: kept })
}

/// Replays recorded frames bit for bit, with the switch that they contain.
fn replay_frames(args: &Args, common: &Common, path: &Path, name: String) -> Result<Done, Failure> {
    if !common.faults.is_empty() {
        return Err(format!("{name}: --fault acts on recordings of samples, not on frames").into());
    }
    let bytes = std::fs::read(path).map_err(|error| format!("can't read {name}: {error}"))?;
    let all = frames(&bytes).map_err(|error| format!("{name}: {error}"))?;
    let (plan, fitted) = common.plan(args, None)?;
    let options = RunOptions { press: args.press, every_s: args.every, roll_rad: &[], torque_nm: &[] };
    let mut each = all.iter().copied();
    let replayed = run_through(&plan, &options, |_| each.next());
    let config = resolved(args, common, &plan, None);
    let result = ReplayResult { file: name, remarks: Vec::new(), fitted, replayed };
    let frames = all.into_iter().map(|(_, frame)| frame).collect();
    Ok(Done { result, config, frames })
}

fn resolved(
    args: &Args,
    common: &Common,
    plan: &control::Plan,
    resample: Option<&'static str>,
) -> ReplayConfig {
    let (preset, base) = match args.preset {
        Preset::Thesis => ("thesis", Config::thesis(Law::H { cut: false })),
        Preset::Product => ("product", Config::product()),
    };
    ReplayConfig {
        preset,
        law: common.law_name.clone(),
        map: resample.map(|_| args.map.clone().unwrap_or_else(|| "by the columns".into())),
        resample,
        faults: args.fault.clone(),
        parameters: parameters::departing(plan.config(), &base).into_iter().collect(),
    }
}

fn write_one(args: &Args, outputs: &Outputs, done: &Done) -> Result<Ended, Failure> {
    let Done { result, config, frames } = done;
    let replayed = &result.replayed;
    let document =
        ReplayDocument { schema: SCHEMA, tool: Tool::this(), config: config.clone(), result: result.clone() };
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
    common: &Common,
    outputs: &Outputs,
    all: Vec<Done>,
    unusable: Vec<String>,
) -> Result<(), Failure> {
    let Some(first) = all.first() else { return Err("none of the recordings can be used".into()) };
    let config = first.config.clone();
    let fault_s = common.faults.iter().map(|fault| fault.from_s).reduce(f64::min);
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
