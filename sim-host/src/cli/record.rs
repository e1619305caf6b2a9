//! `sim-host record`: a synthetic perturbation record.

use super::options::{Options, Ridden};
use super::outputs::{complain_once, print, write_json};
use super::scenario_error::named;
use super::{Ended, Failure, warn};
use crate::bicycle::ForcePoint;
use crate::perturbation::{Drift, Experiment, Pulses, Remnant, SensorNoise, record};
use crate::report::output::Output;
use crate::report::perturbation::PerturbationDocument;
use crate::report::table::csv_text;
use crate::ride::ScheduleSpeed;
use crate::scenario::{Scenario, seed};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
The experiment of a rider identification, with a rider that is known. Columns: time_s, \
lateral_force_n, steer_torque_nm (with --steer-pulse), steer_rad, roll_rad, roll_rate_rad_s, \
speed_m_s. Right is positive; force and torque act from their line to the next. Without options \
for noise and drift there is none.

Examples:
  sim-host record --rider young --speed 5 --out young.csv
  sim-host record --rider smart --speed 4 --pulse 60 --force-at 0,1 --out smart.csv --json smart.json
  sim-host record --rider young --speed 5 --remnant 0.5 --steer-noise 0.001 --roll-rate-noise 0.01
  sim-host record --rider young --speed 5 --treadmill-drift 0.05 --steer-drift 0.01 --seed 2";

/// Options of `record`.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    ridden: Options<Ridden>,
    /// Forward speed, 0.1 to 30 m/s
    #[arg(long, value_name = "M/S", allow_negative_numbers = true)]
    speed: f64,
    /// Duration, 1 to 3600 s
    #[arg(long, value_name = "S", default_value_t = 60.0, allow_negative_numbers = true)]
    duration: f64,
    /// Samples per second, 10 to 1000 Hz
    #[arg(long, value_name = "HZ", default_value_t = 200.0, allow_negative_numbers = true)]
    rate: f64,
    /// Point of the rear frame where the lateral force acts, in m: ahead of the rear contact, above the ground
    #[arg(long, value_name = "AHEAD,HEIGHT", default_value_t = ForcePoint::SADDLE, value_parser = point, allow_hyphen_values = true)]
    force_at: ForcePoint,
    /// Lateral force of a pulse in N; 0 for none
    #[arg(long, value_name = "N", default_value_t = 40.0, allow_negative_numbers = true)]
    pulse: f64,
    /// Steer torque of further pulses in N m, at random times of their own; 0 for none
    #[arg(long, value_name = "NM", default_value_t = 0.0, allow_negative_numbers = true)]
    steer_pulse: f64,
    /// Duration of a pulse in s, rounded to whole samples
    #[arg(long, value_name = "S", default_value_t = 0.25, allow_negative_numbers = true)]
    pulse_duration: f64,
    /// Mean pause between pulses in s; each is from half to one and a half times it
    #[arg(long, value_name = "S", default_value_t = 5.0, allow_negative_numbers = true)]
    pulse_interval: f64,
    /// Standard deviation of the noise of the rider's torque (remnant) in N m
    #[arg(long, value_name = "NM", default_value_t = 0.0, allow_negative_numbers = true)]
    remnant: f64,
    /// Corner frequency of the remnant's low-pass filter in rad/s
    #[arg(long, value_name = "RAD/S", default_value_t = Remnant::default().corner_rad_s, allow_negative_numbers = true)]
    remnant_corner: f64,
    /// Standard deviation of the noise of the steer angle in rad
    #[arg(long, value_name = "RAD", default_value_t = 0.0, allow_negative_numbers = true)]
    steer_noise: f64,
    /// Standard deviation of the noise of the roll angle in rad
    #[arg(long, value_name = "RAD", default_value_t = 0.0, allow_negative_numbers = true)]
    roll_noise: f64,
    /// Standard deviation of the noise of the roll rate in rad/s
    #[arg(long, value_name = "RAD/S", default_value_t = 0.0, allow_negative_numbers = true)]
    roll_rate_noise: f64,
    /// Standard deviation of slow changes of the belt's speed in m/s, with a time constant of 20 s
    #[arg(long, value_name = "M/S", default_value_t = 0.0, allow_negative_numbers = true)]
    treadmill_drift: f64,
    /// Standard deviation of slow changes of the steer sensor's offset in rad, with a time constant of 20 s
    #[arg(long, value_name = "RAD", default_value_t = 0.0, allow_negative_numbers = true)]
    steer_drift: f64,
    /// Seed of pulses, noise and drift
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = seed)]
    seed: u64,
    /// After a fall, write the record up to it; without, a fall is an error and nothing is written
    #[arg(long)]
    until_fall: bool,
    /// Write the record, CSV without comments, to FILE; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// Write a JSON document of bicycle, rider, true gains, experiment and largest angles to FILE, or to standard output
    /// (also -)
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// No text
    #[arg(long, short)]
    quiet: bool,
}

/// Parses `AHEAD,HEIGHT` \[m\].
pub(super) fn point(text: &str) -> Result<ForcePoint, String> {
    let numbers = text.split_once(',').map(|(ahead, height)| (ahead.trim().parse(), height.trim().parse()));
    match numbers {
        Some((Ok(ahead_m), Ok(height_m))) => Ok(ForcePoint { ahead_m, height_m }),
        _ => Err("expected AHEAD,HEIGHT in m, for example 0.2,0.9".into()),
    }
}

impl Args {
    fn experiment(&self) -> Experiment {
        let pulses = |amplitude| Pulses {
            amplitude,
            duration_s: self.pulse_duration,
            interval_s: self.pulse_interval,
        };
        Experiment {
            speed_m_s: self.speed,
            duration_s: self.duration,
            rate_hz: self.rate,
            point: self.force_at,
            force: pulses(self.pulse),
            steer_torque: pulses(self.steer_pulse),
            remnant: Remnant { std_nm: self.remnant, corner_rad_s: self.remnant_corner },
            noise: SensorNoise {
                steer_rad: self.steer_noise,
                roll_rad: self.roll_noise,
                roll_rate_rad_s: self.roll_rate_noise,
            },
            drift: Drift { speed_m_s: self.treadmill_drift, steer_rad: self.steer_drift },
            seed: self.seed,
        }
    }

    /// Both outputs, checked.
    fn open(&self) -> Result<(Output, Option<Output>), Failure> {
        let out = Output::create(&self.out)?;
        let json = self.json.as_deref().map(Output::create).transpose()?;
        if json.as_ref().is_some_and(|json| json.collides(&out)) {
            return Err("--json and --out have the same place to write to".into());
        }
        Ok((out, json))
    }
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    // The notes are about the step, which a record chooses itself.
    // Constant gains are those that an identification should find.
    let schedule_speed = ScheduleSpeed::Initial;
    let mut scenario = Scenario { law: Some("none".into()), schedule_speed, ..Scenario::default() };
    args.ridden.apply(&mut scenario)?;
    let resolved = scenario.resolve().map_err(|e| named(&scenario, &e))?;
    warn(&resolved.bicycle);
    resolved.warnings.iter().for_each(|warning| complain_once(&format!("warning: {warning}")));
    let (out, json) = args.open()?;
    let experiment = args.experiment();
    let made = record(&resolved.conditions, &experiment)?;
    let made = if args.until_fall { made } else { made.upright()? };
    let document = PerturbationDocument::new(
        &resolved.bicycle,
        resolved.rider.as_ref(),
        resolved.warnings,
        &experiment,
        &made,
    );
    out.finish(csv_text(&made.samples)?.as_bytes())?;
    if let Some(json) = &json {
        write_json(json, &document)?;
    }
    if !args.quiet && !out.is_standard() && !json.is_some_and(|json| json.is_standard()) {
        print(&document.text())?;
    }
    Ok(Ended::Done)
}
