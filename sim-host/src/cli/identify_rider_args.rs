//! Options of `identify RECORD`.

use super::bicycle_args::BicycleArgs;
use super::outputs::OutputArgs;
use super::record::point;
use super::recording_args::RecordingArgs;
use crate::bicycle::ForcePoint;
use crate::commands::identify::Delay;
use crate::commands::identify_text::{ChoiceTextError, drift, percent, select};
use crate::identify::{Drift, Hold, Select, Signal, symbols};
use crate::range::{TimeError, time, within};
use crate::rider::{MAX_DELAY_S, Neuromuscular};
use crate::scenario::seed;
use std::path::PathBuf;

/// Options of `identify RECORD`.
#[derive(clap::Args)]
pub(super) struct RiderArgs {
    /// Perturbation records: time_s, lateral_force_n or steer_torque_nm, steer_rad, optionally roll_rad, roll_rate_rad_s,
    /// speed_m_s; CSV, MDF4, or CAN with --dbc
    #[arg(value_name = "RECORD", required = true)]
    pub(super) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) bicycle: BicycleArgs,
    /// Neural delay for which the gains are fitted, 0 to 1 s, for example 30ms, or `estimate`: the likeliest one of the record
    #[arg(long, value_name = "TIME|estimate", default_value = "30ms", value_parser = delay)]
    pub(super) delay: Delay,
    /// Delays whose likelihood is computed, in ms: FROM:TO:STEP from 0 to 1000, or none
    #[arg(long, value_name = "RANGE", default_value = "none", value_parser = delays)]
    pub(super) delay_profile: Delays,
    /// Forward speed in m/s [default: the mean of the recorded one]
    #[arg(long, value_name = "M/S", allow_negative_numbers = true)]
    pub(super) speed: Option<f64>,
    /// Point of the rear frame where the lateral force acts, in m: ahead of the rear contact, above the ground
    #[arg(long, value_name = "AHEAD,HEIGHT", default_value_t = ForcePoint::SADDLE, value_parser = force_point, allow_hyphen_values = true)]
    pub(super) force_at: ForcePoint,
    /// Signals to fit, with weights by their noise
    #[arg(long, value_name = "SIGNALS", value_delimiter = ',', default_value = "steer")]
    pub(super) fit: Vec<Signal>,
    /// Gains of the full fit [default: all eight]
    #[arg(long, value_name = "GAINS", value_delimiter = ',', value_parser = gain)]
    pub(super) feedback: Vec<usize>,
    /// Neuromuscular dynamics: frequency in Hz and damping ratio
    #[arg(long, value_name = "HZ,RATIO", value_parser = neuromuscular)]
    pub(super) neuromuscular: Option<Neuromuscular>,
    /// Slow motion that is no response, estimated with the gains: none, offset, or all below a frequency, for example 0.05Hz
    #[arg(long, value_name = "DRIFT", default_value = "offset", value_parser = drift)]
    pub(super) drift: Drift,
    /// Time from the start that is not fitted: the model starts from rest
    #[arg(long, value_name = "TIME", default_value = "2s", value_parser = moment)]
    pub(super) skip: f64,
    /// Course of the disturbance between two samples
    #[arg(long, default_value = "zero")]
    pub(super) hold: Hold,
    /// Fit the output of the impulse response in place of the measured signals
    #[arg(long)]
    pub(super) filter: bool,
    /// Keep the gains of the linear bicycle: without this option the selected ones are refined on the nonlinear bicycle
    #[arg(long)]
    pub(super) linear: bool,
    /// Variance accounted for in % at which the reduction ends; `none` for no reduction
    #[arg(long, value_name = "PERCENT", default_value = "50", value_parser = until)]
    pub(super) reduce_until: Until,
    /// Gains to select: full (all), vaf:PERCENT (the fewest that account for it), onset:PERCENT (the same within 1 s of the
    /// perturbations' onsets), aic, bic, or held (best for data that was not fitted)
    #[arg(long, value_name = "CRITERION", default_value = "full", value_parser = select)]
    pub(super) select: Select,
    #[command(flatten)]
    pub(super) recording: RecordingArgs,
    /// Seed of the global search
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = seed)]
    pub(super) seed: u64,
    /// Write the rider as a file for --rider, one row per record
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Write a report of the record as a self-contained HTML page: gains, signals, residuals, impulse response, reduction, delay
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// Write each record's document, rider, report and text to FOLDER as soon as it is finished; a record that is finished there with
    /// the same options is not fitted again
    #[arg(long, value_name = "FOLDER")]
    pub(super) results: Option<PathBuf>,
    #[command(flatten)]
    pub(super) outputs: OutputArgs,
}

/// Delays of a profile \[s\].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Delays(pub(super) Vec<f64>);

/// End of the reduction: a fraction of the variance, or `None` for no reduction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Until(pub(super) Option<f64>);

/// A point from 3 m behind the rear contact to 5 m ahead, up to 5 m above the ground.
fn force_point(text: &str) -> Result<ForcePoint, String> {
    let at = point(text)?;
    within("AHEAD (m)", at.ahead_m, -3.0, 5.0).map_err(|e| e.to_string())?;
    within("HEIGHT (m)", at.height_m, 0.0, 5.0).map_err(|e| e.to_string())?;
    Ok(at)
}

fn delay(text: &str) -> Result<Delay, TimeError> {
    if text == "estimate" { Ok(Delay::Estimate) } else { time(text, MAX_DELAY_S).map(Delay::Given) }
}

fn delays(text: &str) -> Result<Delays, String> {
    if text == "none" {
        return Ok(Delays(Vec::new()));
    }
    let wrong = || "expected FROM:TO:STEP in ms, for example 0:120:5, or none".to_owned();
    let numbers: Vec<f64> = text.split(':').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
    let [from, to, step] = numbers[..] else { return Err(wrong()) };
    within("FROM (ms)", from, 0.0, 1e3 * MAX_DELAY_S).map_err(|e| e.to_string())?;
    within("TO (ms)", to, from, 1e3 * MAX_DELAY_S).map_err(|e| e.to_string())?;
    within("STEP (ms)", step, 0.1, 100.0).map_err(|e| e.to_string())?;
    let count = ((to - from) / step + 1e-9) as usize;
    within("number of delays", count as f64 + 1.0, 3.0, 1000.0).map_err(|e| e.to_string())?;
    Ok(Delays((0..=count).map(|i| (from + step * i as f64) * 1e-3).collect()))
}

fn gain(text: &str) -> Result<usize, String> {
    let place = symbols().iter().position(|symbol| *symbol == text);
    place.ok_or_else(|| format!("expected gains of {}", symbols().join(", ")))
}

fn neuromuscular(text: &str) -> Result<Neuromuscular, String> {
    let numbers = text.split_once(',').map(|(hz, ratio)| (hz.trim().parse::<f64>(), ratio.trim().parse()));
    let Some((Ok(hz), Ok(zeta))) = numbers else {
        return Err("expected HZ,RATIO, for example 2.17,0.707".into());
    };
    let muscles = Neuromuscular { omega_rad_s: hz * std::f64::consts::TAU, zeta };
    muscles.check().map_err(|e| e.to_string())?;
    Ok(muscles)
}

fn moment(text: &str) -> Result<f64, TimeError> {
    time(text, 3600.0)
}

fn until(text: &str) -> Result<Until, ChoiceTextError> {
    if text == "none" { Ok(Until(None)) } else { percent(text).map(|x| Until(Some(x))) }
}
