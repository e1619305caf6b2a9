//! Options of `identify weave`.

use super::outputs::OutputArgs;
use crate::range::{TimeError, time};
use crate::study::balance_assist::RIDERLESS;
use crate::weave::record::{Columns, Unit};
use crate::weave::segment::Settings;
use crate::weave::shape::Beside;
use std::path::PathBuf;

const WEAVE_EXAMPLES: &str = "\
A file is a CSV table with a column of time stamps (seconds, or dates with a time) and columns of \
the gyro's rates, recorded after a disturbance of a bicycle rolling without a rider. Repeats at one \
gain and speed are pooled.

Examples:
  sim-host identify weave gain*_speed*kmh_*.csv --svg weave.svg
  sim-host identify weave ride.csv --speed 3.9 --gain 8 --json
  sim-host identify weave 'v4 k9.csv' --label 'v{speed_m_s} k{gain}' --column roll --unit deg/s
  sim-host identify weave push.csv --speed 5 --law none --bicycle benchmark --from 2.5s --csv -";

/// Options of `identify weave`.
#[derive(clap::Args)]
#[command(after_help = WEAVE_EXAMPLES)]
pub(super) struct WeaveArgs {
    /// CSV files, one disturbance each
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,
    /// Column of the time stamps: seconds, or dates with a time [default: the first one found of Time, time, t, time_s]
    #[arg(long, value_name = "NAME")]
    pub(super) time_column: Option<String>,
    /// Column of a rate to fit; may be repeated, with common decay and frequency [default: gyro_x and gyro_z]
    #[arg(long = "column", value_name = "NAME")]
    pub(super) columns: Vec<String>,
    /// Unit of the rates
    #[arg(long, default_value = "rad/s", value_parser = ["rad/s", "deg/s"])]
    pub(super) unit: String,
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
    pub(super) from: Option<f64>,
    /// End of the window [default: where the weave falls below the noise]
    #[arg(long, value_name = "TIME", value_parser = moment)]
    pub(super) to: Option<f64>,
    /// Fitted in addition to the weave: an offset with a decaying real mode (the caster mode), or an offset only
    #[arg(long, default_value = "mode", value_parser = ["mode", "offset"])]
    pub(super) beside: String,
    /// Bicycle of the prediction: built-in, FILE, or FILE#NAME of a collection
    #[arg(long, default_value = RIDERLESS, value_name = "NAME|FILE")]
    pub(super) bicycle: String,
    /// Law of the prediction; {gain} is replaced by the file's gain
    #[arg(long, default_value = "balance-assist:{gain}")]
    pub(super) law: String,
    /// Write the pooled repeats as TOML
    #[arg(long, value_name = "FILE")]
    pub(super) toml: Option<PathBuf>,
    /// Origin of the recordings, for --toml
    #[arg(long, value_name = "TEXT", default_value = "not given", hide_default_value = true)]
    pub(super) source: String,
    #[command(flatten)]
    pub(super) outputs: OutputArgs,
}

fn moment(text: &str) -> Result<f64, TimeError> {
    time(text, 3600.0)
}

impl WeaveArgs {
    pub(super) fn columns(&self) -> Columns {
        let unit = if self.unit == "deg/s" { Unit::Degree } else { Unit::Radian };
        Columns { time: self.time_column.clone(), rates: self.columns.clone(), unit }
    }

    pub(super) fn settings(&self) -> Settings {
        let beside = if self.beside == "offset" { Beside::Offset } else { Beside::Mode };
        Settings { beside, from_s: self.from, to_s: self.to }
    }
}
