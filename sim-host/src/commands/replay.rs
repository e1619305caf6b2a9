//! Recorded rides through the flashed code.

use super::CommandError;
use crate::bicycle::onboard::fit;
use crate::bicycle::{Geometry, catalogue};
use crate::parameters;
use crate::plant::{Channel, Fault, ImuMount};
use crate::range::within_key;
use crate::recording::{ReadOptions, read};
use crate::replay::{
    Feed, FeedOptions, Fitted, Map, Press, Resample, RunOptions, Samples, fitted, frames, run as run_through,
    samples,
};
use crate::report::replay::{ReplayConfig, ReplayDocument, ReplayResult};
use crate::report::tool::{SCHEMA, Tool};
use crate::ride::frame_of;
use crate::scenario::{ParameterFile, Preset, law};
use control::{Config, Law, SensorFrame};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Longest time between two samples that is interpolated, unless another is chosen \[s\].
pub const LONGEST_GAP_S: f64 = 0.5;

/// Why a longest gap has no effect.
const HELD: &str = "is for interpolation (--resample interpolate): nothing is interpolated";

/// Choices of a replay.
#[derive(Clone, Debug)]
pub struct ReplayChoice {
    /// Assignment of the columns: the name of a built-in map, or a file; `None`: by the columns.
    pub map: Option<String>,
    /// Databases that decode CAN frames.
    pub dbc: Vec<PathBuf>,
    /// Whether a recording is rejected at the first unusable line.
    pub strict: bool,
    /// Between two samples; `None`: the map's.
    pub resample: Option<Resample>,
    /// Longest time between two samples that is interpolated \[s\]; `None`: [`LONGEST_GAP_S`].
    pub longest_gap_s: Option<f64>,
    /// When the switch is pressed in a recording without one.
    pub press: Press,
    /// Defaults of the parameters.
    pub preset: Preset,
    /// Roll-rate law; `None`: the preset's.
    pub law: Option<String>,
    /// Bicycle whose geometry the firmware is configured with.
    pub bicycle: Option<String>,
    /// Law and parameters from a file.
    pub parameters: Option<PathBuf>,
    /// Parameters of the firmware, as KEY=VALUE.
    pub set: Vec<String>,
    /// Faults to inject.
    pub faults: Vec<String>,
    /// Seed of the faults' noise and dropouts.
    pub seed: u64,
    /// Time between two rows of the table \[s\].
    pub every_s: f64,
}

impl Default for ReplayChoice {
    /// The flashed configuration, a row every 10 ms.
    fn default() -> Self {
        Self {
            map: None,
            dbc: Vec::new(),
            strict: false,
            resample: None,
            longest_gap_s: None,
            press: Press::Again,
            preset: Preset::Product,
            law: None,
            bicycle: None,
            parameters: None,
            set: Vec::new(),
            faults: Vec::new(),
            seed: 0,
            every_s: 0.01,
        }
    }
}

/// A replay of recordings, with what is common to all.
#[derive(Clone, Debug)]
pub struct Replay {
    choice: ReplayChoice,
    config: Config,
    law_name: String,
    file: Option<ParameterFile>,
    /// The injected faults.
    pub faults: Vec<Fault>,
    map: Option<Map>,
    /// Doubts about the bicycle and what is off for it, as text.
    pub remarks: Vec<String>,
}

/// Result of one recording.
#[derive(Clone, Debug)]
pub struct ReplayedRecording {
    /// The result.
    pub result: ReplayResult,
    /// Configuration of the replay.
    pub config: ReplayConfig,
    /// The frames that the firmware received.
    pub frames: Vec<SensorFrame>,
}

impl ReplayedRecording {
    /// The document.
    pub fn document(&self) -> ReplayDocument {
        let (config, result) = (self.config.clone(), self.result.clone());
        ReplayDocument { schema: SCHEMA, tool: Tool::this(), config, result }
    }
}

/// An error of a recording.
type Failure = Box<dyn Error + Send + Sync>;

impl Replay {
    /// Loads what is common to all recordings.
    ///
    /// # Errors
    /// A wrong choice, with its name.
    pub fn new(choice: ReplayChoice) -> Result<Self, CommandError> {
        let longest_gap_s = choice.longest_gap_s.unwrap_or(LONGEST_GAP_S);
        for (name, key, time_s) in
            [("longest-gap", "longest_gap_s", longest_gap_s), ("every", "every_s", choice.every_s)]
        {
            within_key(key, "time (s)", time_s, 1e-6, 3600.0).map_err(|e| CommandError::choice(name, e))?;
        }
        let base = base(choice.preset);
        let file = choice.parameters.as_deref().map(ParameterFile::read).transpose();
        let file = file.map_err(|e| CommandError::Scenario(e.into()))?;
        let law = match (&choice.law, file.as_ref().and_then(|file| file.law.clone())) {
            (Some(name), _) => law::parse(name).map_err(|e| CommandError::Scenario(e.into()))?,
            (None, Some(law)) => law,
            (None, None) => base.law.clone(),
        };
        let faults = choice.faults.iter().map(|text| text.parse::<Fault>());
        let faults: Vec<_> =
            faults.collect::<Result<_, _>>().map_err(|e| CommandError::choice("fault", e))?;
        if faults.iter().any(|fault| fault.channel == Channel::Motor) {
            let reason =
                "motor faults have no effect: the motor of a recorded ride does not receive the command";
            return Err(CommandError::Idle { name: "fault", reason });
        }
        let map = choice.map.as_deref().map(Map::load).transpose();
        let map = map.map_err(|e| CommandError::choice("map", e))?;
        let held = choice.resample.or(map.as_ref().map(|map| map.resample)) == Some(Resample::Hold);
        if held && choice.longest_gap_s.is_some() {
            return Err(CommandError::Idle { name: "longest-gap", reason: HELD });
        }
        let law_name = law.to_string();
        let mut config = Config { law, ..base };
        let mut remarks = Vec::new();
        if let Some(name) = &choice.bicycle {
            let bicycle = catalogue::load(name).map_err(|e| CommandError::Scenario(e.into()))?;
            remarks
                .extend(bicycle.warnings.iter().map(|doubt| format!("warning: {}: {doubt}", bicycle.name)));
            let off = fit(&mut config, &Geometry::new(&bicycle.parameters), ImuMount::default().point_m);
            remarks.extend(off.iter().map(|reason| format!("note: {name}: for the flashed code {reason}")));
        }
        Ok(Self { choice, config, law_name, file, faults, map, remarks })
    }

    /// The plan for a recording with these samples.
    fn plan(&self, recorded: Option<(&Samples, &Map)>) -> Result<(control::Plan, Fitted), Failure> {
        let mut config = self.config.clone();
        config.calibration.polarity_checked = true;
        let fitted = match recorded {
            Some((samples, map)) => {
                fitted(&mut config, samples, map).map_err(|error| CommandError::choice("map", error))?
            }
            None => Fitted::default(),
        };
        if let Some(file) = &self.file {
            file.apply(&mut config)?;
        }
        for word in &self.choice.set {
            let wrong = |reason: String| CommandError::choice("set", format!("{word}: {reason}"));
            let (key, value) = word.split_once('=').ok_or_else(|| wrong("expected KEY=VALUE".into()))?;
            parameters::set(&mut config, key, value).map_err(|error| wrong(error.to_string()))?;
        }
        Ok((config.plan()?, fitted))
    }

    /// Replays a recording.
    ///
    /// # Errors
    /// The file, or the part of it that can't be used.
    pub fn file(&self, path: &Path) -> Result<ReplayedRecording, Failure> {
        self.file_until(path, &|| false)
    }

    /// As [`Self::file`]; `stop` is called in every control period, and the replay ends once it returns true.
    ///
    /// # Errors
    /// As of [`Self::file`].
    pub fn file_until(&self, path: &Path, stop: &dyn Fn() -> bool) -> Result<ReplayedRecording, Failure> {
        let name = path.display().to_string();
        if is_frames(path) {
            return self.frames(path, name, stop);
        }
        let choice = &self.choice;
        let options = ReadOptions { strict: choice.strict, dbc: choice.dbc.clone() };
        let recording = read(path, &options)?;
        let map = match &self.map {
            Some(map) => map.clone(),
            None => Map::by_columns(&recording).map_err(|error| format!("{name}: {error}"))?,
        };
        let period_s = 1.0 / f64::from(self.config.rate_hz);
        let samples = samples(&recording, &map, period_s).map_err(|remark| format!("{name}: {remark}"))?;
        if let (true, Some(remark)) = (choice.strict, samples.remarks.first()) {
            return Err(format!("{name}: {remark}").into());
        }
        let (plan, fitted) = self.plan(Some((&samples, &map)))?;
        let resample = choice.resample.unwrap_or(map.resample);
        let feed = FeedOptions {
            period_s: 1.0 / f64::from(plan.config().rate_hz),
            resample,
            longest_gap_s: choice.longest_gap_s.unwrap_or(LONGEST_GAP_S),
            faults: &self.faults,
            seed: choice.seed,
        };
        let mut feed = Feed::new(&samples, feed).map_err(|error| format!("{name}: {error}"))?;
        let mut without_effect = self.idle_faults(&samples, &plan, feed.len());
        if resample == Resample::Hold && choice.longest_gap_s.is_some() {
            without_effect.push(format!("the longest gap {HELD}"));
        }
        let mut kept = Vec::new();
        let options = RunOptions {
            press: choice.press,
            every_s: choice.every_s,
            roll_rad: &samples.roll_rad,
            torque_nm: &samples.torque_nm,
        };
        let replayed = run_through(&plan, &options, |pressed| {
            let (t_s, measured) = feed.next(pressed).filter(|_| !stop())?;
            let frame = frame_of(&plan, &measured);
            kept.push(frame);
            Some((t_s, frame))
        });
        let resample = match resample {
            Resample::Hold => "hold",
            Resample::Interpolate => "interpolate",
        };
        let config = self.resolved(&plan, Some(resample));
        let remarks = samples.remarks.iter().map(ToString::to_string).collect();
        let result = ReplayResult { file: name, remarks, without_effect, fitted, replayed };
        Ok(ReplayedRecording { result, config, frames: kept })
    }

    /// Warnings about the faults without effect on a recording of these samples and control instants.
    fn idle_faults(&self, samples: &Samples, plan: &control::Plan, instants: u64) -> Vec<String> {
        let config = plan.config();
        let idle = |fault: &Fault| match fault.channel {
            Channel::Sensor(sensor) if samples.track(sensor).is_none() => {
                Some("the recording has no such sensor".into())
            }
            _ => fault.idle(&config.input, instants, 1.0 / f64::from(config.rate_hz)),
        };
        let told = |fault: &Fault| idle(fault).map(|why| format!("the fault {fault} has no effect: {why}"));
        self.faults.iter().filter_map(told).collect()
    }

    /// Replays recorded frames bit for bit, with the switch that they contain.
    fn frames(
        &self,
        path: &Path,
        name: String,
        stop: &dyn Fn() -> bool,
    ) -> Result<ReplayedRecording, Failure> {
        if !self.faults.is_empty() {
            return Err(format!("{name}: --fault acts on recordings of samples, not on frames").into());
        }
        let bytes = crate::input_file::bytes(path, crate::input_file::LARGEST_RECORDING)
            .map_err(|error| format!("can't read {name}: {error}"))?;
        let all = frames(&bytes).map_err(|error| format!("{name}: {error}"))?;
        let (plan, fitted) = self.plan(None)?;
        let choice = &self.choice;
        let options =
            RunOptions { press: choice.press, every_s: choice.every_s, roll_rad: &[], torque_nm: &[] };
        let mut each = all.iter().copied();
        let replayed = run_through(&plan, &options, |_| each.next().filter(|_| !stop()));
        let config = self.resolved(&plan, None);
        let (remarks, without_effect) = (Vec::new(), Vec::new());
        let result = ReplayResult { file: name, remarks, without_effect, fitted, replayed };
        let frames = all.into_iter().map(|(_, frame)| frame).collect();
        Ok(ReplayedRecording { result, config, frames })
    }

    fn resolved(&self, plan: &control::Plan, resample: Option<&'static str>) -> ReplayConfig {
        let choice = &self.choice;
        let preset = match choice.preset {
            Preset::Thesis => "thesis",
            Preset::Product => "product",
        };
        ReplayConfig {
            preset,
            law: self.law_name.clone(),
            map: resample.map(|_| choice.map.clone().unwrap_or_else(|| "by the columns".into())),
            resample,
            faults: choice.faults.clone(),
            parameters: parameters::departing(plan.config(), &base(choice.preset)).into_iter().collect(),
        }
    }
}

/// Whether a recording is one of frames, by its name, not of samples.
pub fn is_frames(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "frames")
}

/// The configuration that a preset starts from.
fn base(preset: Preset) -> Config {
    match preset {
        Preset::Thesis => Config::thesis(Law::H { cut: false }),
        Preset::Product => Config::product(),
    }
}
