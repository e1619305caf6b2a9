//! The options for bicycle, rider, law and conditions, common to `ride` and `basin`.

use super::fall_arg::FallArg;
use super::outputs::complain_once;
use super::parameter_file::ParameterFile;
use super::plant_args::{LONGEST_S, PlantArgs, whole_ticks};
use super::rider_args::{RiderArgs, step};
use super::{Failure, cut_files, law, warn};
use crate::bicycle::onboard::fit;
use crate::bicycle::{Geometry, catalogue};
use crate::parameters;
use crate::range::time;
use crate::report::resolved::{ResolvedConfig, ResolvedLaw, ResolvedRider};
use crate::ride::{Assist, Conditions, Imu, ScheduleSpeed};
use crate::rider::compatibility_warnings;
use clap::ValueEnum;
use control::param::ParamSpec;
use control::{Config, Law, Limits, Taper, Wheel};
use std::path::PathBuf;

/// Source of the defaults.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum Preset {
    /// The published conditions: law h, every limit off.
    Thesis,
    /// The flashed configuration: law h-cut, torque and rate limit, taper.
    Product,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum AssistKind {
    /// The firmware's control crate: f32, sampled, with all limits.
    Firmware,
    /// The law alone in f64, continuous, without limits.
    Ideal,
}

/// An optional value; `none` on the command line is `None`.
#[derive(Clone, Copy)]
struct Limit<T>(Option<T>);

#[derive(clap::Args)]
pub(super) struct ConditionArgs {
    /// Built-in bicycle (see `bicycle list`), FILE, or FILE#NAME of a collection
    #[arg(long, default_value = "rigid_jason", value_name = "NAME|FILE")]
    bicycle: String,
    /// Changes one of the bicycle's parameters, SI units, for example lam=0.3; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    bicycle_set: Vec<String>,
    #[command(flatten)]
    rider: RiderArgs,
    /// Roll-rate law: none, h, h-cut, f, g, cl1, cl2:K, balance-assist:K, or a table FILE [default: h; none with a rider; product: h-cut]
    #[arg(long)]
    law: Option<String>,
    /// Defaults of the options below
    #[arg(long, default_value = "thesis")]
    preset: Preset,
    /// What computes the torque
    #[arg(long, default_value = "firmware")]
    assist: AssistKind,
    /// Speed that schedules the gain
    #[arg(long, default_value = "front")]
    schedule_speed: ScheduleSpeed,
    /// Largest torque in N m, or none [default: none; product: 7]
    #[arg(long, value_name = "NM|none", value_parser = limit_nm, allow_hyphen_values = true)]
    torque_limit: Option<Limit<f32>>,
    /// Largest change of torque in N m/s, or none [default: none; product: 100]
    #[arg(long, value_name = "NM/S|none", value_parser = limit_nm, allow_hyphen_values = true)]
    rate_limit: Option<Limit<f32>>,
    /// Taper: torque zero at the first, full at the second speed in m/s, or none [default: none; product: 0.5:1.5]
    #[arg(long, value_name = "ZERO:FULL|none", value_parser = taper, allow_hyphen_values = true)]
    taper: Option<Limit<(f32, f32)>>,
    /// Delay of the simulated sensors, for example 20ms; a whole number of control periods
    #[arg(long, value_name = "TIME", default_value = "0ms", value_parser = seconds, allow_hyphen_values = true)]
    sensor_delay: f64,
    #[command(flatten)]
    plant: PlantArgs,
    /// Law and parameters of the firmware from a file, as written by `param export`; other options have precedence
    #[arg(long, value_name = "FILE")]
    parameters: Option<PathBuf>,
    /// Any parameter of the firmware, for example limits.rise_nm_s=50 or limits.end_stop=on; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Roll rate that the gyro measures: derivative of the roll angle, or angular rate about the frame's axis
    #[arg(long, default_value = "euler")]
    imu: Imu,
    #[command(flatten)]
    fall: FallArg,
    /// Duration of a ride that does not fall, in seconds
    #[arg(long, default_value_t = 6.0, value_name = "S", allow_negative_numbers = true)]
    time_limit: f64,
    /// A ride has recovered if roll and steer end below this fraction of their maxima
    #[arg(long, default_value_t = 0.1, value_name = "FRACTION", allow_negative_numbers = true)]
    recovered_below: f64,
}

fn limit_nm(text: &str) -> Result<Limit<f32>, String> {
    if text == "none" {
        return Ok(Limit(None));
    }
    text.parse().map(|x| Limit(Some(x))).map_err(|_| format!("`{text}` is neither a number nor none"))
}

fn taper(text: &str) -> Result<Limit<(f32, f32)>, String> {
    if text == "none" {
        return Ok(Limit(None));
    }
    let speeds = text.split_once(':').and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    speeds.map(|s| Limit(Some(s))).ok_or_else(|| format!("`{text}` is neither ZERO:FULL in m/s nor none"))
}

fn seconds(text: &str) -> Result<f64, String> {
    time(text, 3600.0)
}

/// The option that sets a parameter of the control crate.
fn option_of(parameter: &ParamSpec) -> Option<&'static str> {
    match (parameter.group, parameter.name) {
        ("limits", "max_torque_nm") => Some("--torque-limit"),
        ("limits", "rise_nm_s" | "fall_nm_s") => Some("--rate-limit"),
        ("limits.taper", _) => Some("--taper"),
        _ => None,
    }
}

/// The conditions from the options.
pub(super) struct Setup {
    pub(super) conditions: Conditions,
    pub(super) config: ResolvedConfig,
    pub(super) parameters: crate::bicycle::Parameters,
    pub(super) measured: Option<crate::bicycle::uncertain::Measured>,
}

impl ConditionArgs {
    /// Whether a rider is requested.
    pub(super) fn ridden(&self) -> bool {
        self.rider.name().is_some()
    }

    /// Applies `--set`.
    fn set_parameters(&self, config: &mut Config) -> Result<(), String> {
        self.set.iter().try_for_each(|word| {
            let (key, value) = word.split_once('=').ok_or(format!("--set {word}: expected KEY=VALUE"))?;
            parameters::set(config, key, value).map_err(|error| format!("--set {word}: {error}"))
        })
    }

    /// Option values that can name a file, except the bicycle.
    fn files(&self) -> impl Iterator<Item = &str> {
        let parameters = self.parameters.as_deref().and_then(std::path::Path::to_str);
        [self.law.as_deref(), self.rider.name(), parameters].into_iter().flatten().chain(self.plant.files())
    }

    /// Loads and checks all conditions; warnings go to standard error.
    pub(super) fn setup(&self) -> Result<Setup, Failure> {
        let bicycle = catalogue::load(&self.bicycle)?.varied(&self.bicycle_set)?;
        warn(&bicycle);
        let base = match self.preset {
            Preset::Thesis => Config::thesis(Law::H { cut: false }),
            Preset::Product => Config::product(),
        };
        let product = self.preset == Preset::Product;
        let rider = self.rider.load()?;
        let file = self.parameters.as_deref().map(ParameterFile::read).transpose()?;
        let (law_name, law) = match (&self.law, file.as_ref().and_then(|file| file.law.clone())) {
            (None, Some(law)) => (law.to_string(), law),
            (name, _) => {
                let name = name.as_deref().unwrap_or(match (product, &rider) {
                    (true, _) => "h-cut",
                    (false, Some(_)) => "none",
                    (false, None) => "h",
                });
                (name.to_owned(), law::parse(name)?)
            }
        };
        let mut config = Config { law: law.clone(), ..base };
        config.input = config.input.scheduled_by(match self.schedule_speed {
            ScheduleSpeed::Front | ScheduleSpeed::Initial => Wheel::Front,
            ScheduleSpeed::Rear => Wheel::Rear,
        });
        if let Some(file) = &file {
            file.apply(&mut config)?;
        }
        // The simulated bicycle is assembled correctly.
        config.calibration.polarity_checked = true;
        if let Some(Limit(limit)) = self.torque_limit {
            config.limits.max_torque_nm = limit;
            if limit.is_none() {
                // Both limits are relative to the torque limit.
                (config.limits.rider_torque, config.limits.limp_fraction) = (None, None);
            }
        }
        if let Some(Limit(limit)) = self.rate_limit {
            config.limits.rise_nm_s = limit;
            config.limits.fall_nm_s = limit;
        }
        if let Some(Limit(taper)) = self.taper {
            config.limits.taper = taper.map(|(zero_m_s, full_m_s)| Taper { zero_m_s, full_m_s });
        }
        self.set_parameters(&mut config)?;
        let period_s = 1.0 / f64::from(config.rate_hz);
        let flashed = law != Law::None && self.assist == AssistKind::Firmware;
        let step_s = match &rider {
            Some((rider, ..)) => step(rider.delay_s, period_s, flashed)?,
            None => period_s,
        };
        let plant = self.plant.plant(step_s)?;
        if flashed {
            let off = fit(&mut config, &Geometry::new(&bicycle.parameters), plant.sensors.imu.point_m);
            for reason in off {
                complain_once(&format!("note: {}: for the flashed code {reason}", self.bicycle));
            }
            self.set_parameters(&mut config)?;
        }
        // A single wheel sensor measures its own wheel's speed.
        let schedule_speed = match (config.input.front_wheel.fitted, config.input.rear_wheel.fitted) {
            _ if !flashed || self.schedule_speed == ScheduleSpeed::Initial => self.schedule_speed,
            (true, false) => ScheduleSpeed::Front,
            (false, true) => ScheduleSpeed::Rear,
            _ => self.schedule_speed,
        };
        let limited = config.limits != Limits::default();
        let plan = config.plan().map_err(|e| match option_of(&e.leaf) {
            Some("--torque-limit") if self.torque_limit.is_none() => e.to_string(),
            Some(option) => format!("{option}: {e}"),
            None if flashed && e.leaf.group.starts_with("estimate") => format!(
                "{}: for the flashed code {e}, and capsize, predict and track need it; --assist ideal leaves the flashed code out",
                self.bicycle
            ),
            None => e.to_string(),
        })?;
        if self.assist == AssistKind::Ideal && (limited || self.sensor_delay > 0.0) {
            let reason = "limits and sensor delay act on --assist firmware only; the ideal law has none";
            return Err(reason.into());
        }
        let assist = match self.assist {
            _ if law == Law::None => Assist::None,
            AssistKind::Firmware => Assist::Firmware(Box::new(plan)),
            AssistKind::Ideal => Assist::Ideal(Box::new(law.clone())),
        };
        let sensor_delay_ticks = whole_ticks("--sensor-delay", self.sensor_delay, step_s, LONGEST_S)?;
        let mut doubts =
            rider.as_ref().map_or(Vec::new(), |(_, table, _)| compatibility_warnings(&bicycle, table));
        doubts.extend(cut_files::doubts(self.files()));
        doubts.iter().for_each(|doubt| complain_once(&format!("warning: {doubt}")));
        let resolved = rider.as_ref().map(|(rider, table, fit)| ResolvedRider::new(table, *fit, rider));
        let conditions = Conditions {
            rider: rider.map(|(rider, ..)| rider),
            schedule_speed,
            imu: self.imu,
            sensor_delay_ticks,
            plant,
            fall: self.fall.fall,
            time_limit_s: self.time_limit,
            step_s,
            recovered_below: self.recovered_below,
            ..Conditions::thesis(Geometry::new(&bicycle.parameters), assist)
        };
        conditions.check()?;
        let preset = if product { "product" } else { "thesis" };
        let law = ResolvedLaw::new(&law_name, &law);
        let resolved = ResolvedConfig::new(preset, &bicycle, resolved, law, &conditions);
        let config = ResolvedConfig { warnings: doubts, ..resolved };
        Ok(Setup { conditions, config, parameters: bicycle.parameters, measured: bicycle.measured })
    }
}
