//! `sim-host identify sensor`: identifies a sensor model from recordings.

use super::inputs::once;
use super::outputs::{Further, OutputArgs, complain};
use super::recording_args::RecordingArgs;
use super::{Ended, Failure};
use crate::plant::Sensor;
use crate::plant::sensor_file::SensorFile;
use crate::recording::read;
use crate::replay::{Map, over_time, samples};
use crate::report::output::Output;
use crate::report::sensor::{ResolvedSensors, SensorDocument, rows, text};
use crate::report::table;
use crate::sensor_fit::{Recording, fit, to_toml};
use std::fmt::Write;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
FILE is any recording that `replay` reads, with a gyro and a wheel speed; --map assigns its columns. Standing \
and riding are distinguished by the speed. Values that the recordings do not determine are left out, with the reason.

Examples:
  sim-host identify sensor robot/*.csv.gz --map robot-bicycle --sensor gyro --sensor accel --out imu.toml
  sim-host identify sensor ride.csv --map extract --sensor rear-wheel --distance rear_dist
  sim-host ride --preset product --speed 4 --steer-rate 1 --sensor imu.toml";

/// The control period, unit of the ages in a recording \[s\].
const PERIOD_S: f64 = 1e-3;

/// Options of `identify sensor`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Recordings of the same sensors
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Sensor: gyro, accel, steer, steer-rate, front-wheel, rear-wheel, rider-torque, motor-report; may be repeated
    #[arg(long = "sensor", value_name = "NAME", required = true, value_parser = sensor)]
    sensors: Vec<Sensor>,
    #[command(flatten)]
    recording: RecordingArgs,
    /// Column of the distance in m from the wheel sensor, to find the averaging time of its speed
    #[arg(long, value_name = "COLUMN")]
    distance: Option<String>,
    /// Write the model as TOML, for --sensor of `ride` and others
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Identity of the sensors and origin of the recordings, for --out
    #[arg(long, value_name = "TEXT", default_value = "not given", hide_default_value = true)]
    source: String,
    /// Licence of the recordings, for --out
    #[arg(long, value_name = "TEXT", default_value = "not given", hide_default_value = true)]
    licence: String,
    #[command(flatten)]
    outputs: OutputArgs,
}

/// A sensor that has a model.
fn sensor(name: &str) -> Result<Sensor, String> {
    let modelled = |sensor: &Sensor| *sensor != Sensor::Path;
    let known = Sensor::ALL.into_iter().filter(modelled).find(|sensor| sensor.name() == name);
    known.ok_or_else(|| {
        let names: Vec<_> = Sensor::ALL.into_iter().filter(modelled).map(Sensor::name).collect();
        format!("expected one of {}", names.join(", "))
    })
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    args.outputs.refuse_figures("a sensor's model has no figure")?;
    once(&args.files)?;
    let map = args.recording.map()?;
    let outputs = args.outputs.open(Further::default())?;
    let out = args.out.as_deref().map(Output::create).transpose()?;
    if let Some(out) = &out {
        outputs.refuse_place_of("--out", out)?;
    }
    let recordings: Vec<Recording> =
        args.files.iter().map(|file| recording(args, map.as_ref(), file)).collect::<Result<_, _>>()?;
    let mut file = SensorFile {
        source: args.source.clone(),
        licence: args.licence.clone(),
        command: command(args),
        ..SensorFile::default()
    };
    for sensor in &args.sensors {
        let table = file.of_mut(*sensor).ok_or("this sensor has no model")?;
        if table.is_some() {
            return Err(format!("--sensor {}: a model of it is there already", sensor.name()).into());
        }
        *table = Some(fit(*sensor, &recordings)?);
    }
    let config = ResolvedSensors {
        files: args.files.iter().map(|file| file.display().to_string()).collect(),
        map: args.recording.map_name(),
        distance: args.distance.clone(),
    };
    let document = SensorDocument::new(config, &file);
    let table = || table::table(&document.config, &rows(&file));
    outputs.write_data(&document, table, || text(&file))?;
    if let Some(out) = out {
        out.finish(to_toml(&file).as_bytes())?;
    }
    Ok(Ended::Done)
}

fn recording(args: &Args, map: Option<&Map>, path: &Path) -> Result<Recording, Failure> {
    let name = path.display();
    let recording = read(path, &args.recording.options())?;
    let map = match map {
        Some(map) => map.clone(),
        None => Map::by_columns(&recording).map_err(|error| format!("{name}: {error}"))?,
    };
    let samples = samples(&recording, &map, PERIOD_S).map_err(|remark| format!("{name}: {remark}"))?;
    samples.remarks.iter().for_each(|remark| complain(&format!("{name}: {remark}")));
    let distance = args.distance.as_deref().map(|column| over_time(&recording, &map, column));
    let distance_m = distance.transpose().map_err(|remark| format!("{name}: {remark}"))?.unwrap_or_default();
    Ok(Recording { samples, distance_m })
}

/// The command that reproduces the file, independent of the recordings' folder.
fn command(args: &Args) -> String {
    let mut text = String::from("sim-host identify sensor");
    let mut word = |word: &str| {
        let word = shlex::try_quote(word).map_or_else(|_| word.into(), std::borrow::Cow::into_owned);
        let _ = write!(text, " {word}");
    };
    for file in &args.files {
        word(&file.file_name().unwrap_or_default().to_string_lossy());
    }
    if let Some(map) = &args.recording.map {
        word("--map");
        word(map);
    }
    for sensor in &args.sensors {
        word("--sensor");
        word(sensor.name());
    }
    if let Some(distance) = &args.distance {
        word("--distance");
        word(distance);
    }
    text
}
