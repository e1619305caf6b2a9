//! `sim-host identify`: identification of the weave and of sensors from recordings.

use super::outputs::{OutputArgs, Outputs, Results, complain};
use super::{Ended, Failure, identify_files, identify_sensor, warn};
use crate::bicycle::catalogue;
use crate::range::time;
use crate::report::figure;
use crate::report::output::Output;
use crate::report::resolved::ResolvedBicycle;
use crate::report::table;
use crate::report::tool::{SCHEMA, Tool};
use crate::report::weave::{ResolvedWeave, WeaveDocument, chart, rows, text};
use crate::study::balance_assist::{self, RIDERLESS};
use crate::study::motor_fit;
use crate::weave::measured::beside_name;
use crate::weave::record::{Columns, Unit};
use crate::weave::segment::Settings;
use crate::weave::shape::Beside;
use serde_json::json;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  sim-host identify weave gain*_speed*kmh_*.csv --svg weave.svg
  sim-host identify weave ride.csv --speed 3.9 --gain 8 --json
  sim-host identify sensor ride.csv --map extract --sensor gyro --out gyro.toml";

const WEAVE_EXAMPLES: &str = "\
A file is a CSV table with a column of time stamps (seconds, or dates with a time) and columns of
the gyro's rates, recorded after a disturbance of a bicycle rolling without a rider. Repeats at one
gain and speed are pooled.

Examples:
  sim-host identify weave gain*_speed*kmh_*.csv --svg weave.svg
  sim-host identify weave ride.csv --speed 3.9 --gain 8 --json
  sim-host identify weave 'v4 k9.csv' --label 'v{speed_m_s} k{gain}' --column roll --unit deg/s
  sim-host identify weave push.csv --speed 5 --law none --bicycle benchmark --from 2.5s --csv -";

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Frequency and decay of the weave after a disturbance, beside the linear model's
    Weave(Box<Args>),
    /// A model of a real sensor: noise, quantisation, timing and vibration, for --sensor of `ride` and others
    Sensor(Box<identify_sensor::Args>),
}

/// Options of `identify weave`.
#[derive(clap::Args)]
#[command(after_help = WEAVE_EXAMPLES)]
pub(super) struct Args {
    /// CSV files, one disturbance each
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,
    /// Column of the time stamps: seconds, or dates with a time [default: the first one found of Time, time, t, time_s]
    #[arg(long, value_name = "NAME")]
    time_column: Option<String>,
    /// Column of a rate to fit; may be repeated, with common decay and frequency [default: gyro_x and gyro_z]
    #[arg(long = "column", value_name = "NAME")]
    columns: Vec<String>,
    /// Unit of the rates
    #[arg(long, default_value = "rad/s", value_parser = ["rad/s", "deg/s"])]
    unit: String,
    /// Pattern of the files' names without extension: {gain}, {speed_kmh} or {speed_m_s}; a repeat's number as in the
    /// default
    #[arg(long, value_name = "PATTERN", default_value = "gain{gain}_speed{speed_kmh}kmh_{n}")]
    pub(super) label: String,
    /// Forward speed of all files in m/s, in place of the one in their names
    #[arg(long, value_name = "M/S", allow_negative_numbers = true)]
    pub(super) speed: Option<f64>,
    /// The controller's gain in all files, in place of the one in their names
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(super) gain: Option<f64>,
    /// Start of the window after the first sample, for example 0.5s [default: the largest rate after the disturbance]
    #[arg(long, value_name = "TIME", value_parser = moment)]
    from: Option<f64>,
    /// End of the window [default: where the weave falls below the noise]
    #[arg(long, value_name = "TIME", value_parser = moment)]
    to: Option<f64>,
    /// Fitted in addition to the weave: an offset with a decaying real mode (the caster mode), or an offset only
    #[arg(long, default_value = "mode", value_parser = ["mode", "offset"])]
    beside: String,
    /// Bicycle of the prediction: built-in, FILE, or FILE#NAME of a collection
    #[arg(long, default_value = RIDERLESS, value_name = "NAME|FILE")]
    bicycle: String,
    /// Law of the prediction; {gain} is replaced by the file's gain
    #[arg(long, default_value = "balance-assist:{gain}")]
    pub(super) law: String,
    /// Write the pooled repeats as TOML
    #[arg(long, value_name = "FILE")]
    toml: Option<PathBuf>,
    /// Origin of the recordings, for --toml
    #[arg(long, value_name = "TEXT", default_value = "not given", hide_default_value = true)]
    source: String,
    #[command(flatten)]
    outputs: OutputArgs,
}

fn moment(text: &str) -> Result<f64, String> {
    time(text, 3600.0)
}

impl Args {
    pub(super) fn columns(&self) -> Columns {
        let unit = if self.unit == "deg/s" { Unit::Degree } else { Unit::Radian };
        Columns { time: self.time_column.clone(), rates: self.columns.clone(), unit }
    }

    pub(super) fn settings(&self) -> Settings {
        let beside = if self.beside == "offset" { Beside::Offset } else { Beside::Mode };
        Settings { beside, from_s: self.from, to_s: self.to }
    }
}

pub(super) fn run(command: &Command) -> Result<Ended, Failure> {
    match command {
        Command::Weave(args) => weave(args),
        Command::Sensor(args) => identify_sensor::run(args),
    }
}

fn weave(args: &Args) -> Result<Ended, Failure> {
    if let (Some(from), Some(to)) = (args.from, args.to)
        && to <= from
    {
        return Err(format!("--to: {to} s is not after --from, {from} s").into());
    }
    let bicycle = catalogue::load(&args.bicycle)?;
    warn(&bicycle);
    let (outputs, kept) = open(args)?;
    let (recordings, refused) = identify_files::identify(args)?;
    for entry in &recordings {
        entry.left_out.iter().for_each(|note| complain(&format!("{}: {note}", entry.file)));
    }
    refused.iter().for_each(|entry| complain(&format!("{}: not used: {}", entry.file, entry.why)));
    if recordings.is_empty() {
        return Err(format!("none of the {} files could be used", refused.len()).into());
    }
    let published = balance_assist::published();
    let prototype = catalogue::load(RIDERLESS)?.parameters;
    let motor = balance_assist::best(&motor_fit::fits(&prototype, &published.weave)).actuator;
    let model = identify_files::Models { bicycle: &bicycle.parameters, law: &args.law, motor };
    let columns = recordings[0].weave.axes.iter().map(|axis| axis.column.clone()).collect();
    let beside = beside_name(args.settings().beside);
    let document = WeaveDocument {
        schema: SCHEMA,
        tool: Tool::this(),
        bicycle: ResolvedBicycle::new(&bicycle),
        config: ResolvedWeave { law: args.law.clone(), columns, beside, motor },
        weave: identify_files::together(&recordings, &refused, &model)?,
        recordings,
        refused,
    };
    let curves = identify_files::curves(&document.weave, &model)?;
    let config = json!({"bicycle": document.bicycle, "config": document.config});
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || text(&document),
        table: || table::table(&config, &rows(&document)),
        figure: || figure::chart(&chart(&document, &curves)),
    })?;
    if let Some(output) = kept {
        output.finish(document.measured(&args.source).to_toml().as_bytes())?;
    }
    Ok(Ended::Done)
}

/// All outputs, checked; the one of `--toml` separately.
fn open(args: &Args) -> Result<(Outputs, Option<Output>), Failure> {
    let outputs = args.outputs.open(None)?;
    let kept = args.toml.as_deref().map(Output::create).transpose()?;
    if let Some(kept) = &kept {
        outputs.refuse_place_of("--toml", kept)?;
    }
    Ok((outputs, kept))
}
