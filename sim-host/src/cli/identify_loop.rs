//! `sim-host identify loop`: steer angle scale, control law and steer axis from recordings of a closed loop.

use super::inputs::once;
use super::outputs::{Further, OutputArgs, complain};
use super::recording_args::RecordingArgs;
use super::{Ended, Failure, warn};
use crate::bicycle::catalogue;
use crate::closed_loop::{Geometry, StatedLaw, geometry, identify, record, within};
use crate::range::{TimeError, time};
use crate::recording::read;
use crate::replay::{Map, samples};
use crate::report::closed_loop::{LoopDocument, LoopEntry, RefusedLoop, ResolvedLoop, rows, text};
use crate::report::table;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
FILE is any recording that `replay` reads in which a controller steered, with its torque as \
`reference.torque` or `motor` of the map. Numbers that a closed loop does not determine are left \
out, with the reason.

Examples:
  sim-host identify loop robot/*.csv.gz --map robot-bicycle
  sim-host identify loop ride.csv --map sbw-bicycle --stated data/stated_laws/sbw-bicycle.toml
  sim-host identify loop ride.csv --map extract --bicycle mine.toml --from 12s --to 30s --json";

/// The control period, unit of the ages in a recording \[s\].
const PERIOD_S: f64 = 1e-3;

/// Options of `identify loop`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Recordings; each is identified on its own
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    recording: RecordingArgs,
    /// Bicycle whose wheelbase and steer axis tilt are used [default: those of the map]
    #[arg(long, value_name = "NAME|FILE")]
    bicycle: Option<String>,
    /// The law that the controller's source states, as TOML, to compare with
    #[arg(long, value_name = "FILE")]
    stated: Option<PathBuf>,
    /// Start of the used part, for example 12s [default: the recording's]
    #[arg(long, value_name = "TIME", value_parser = moment)]
    from: Option<f64>,
    /// End of the used part [default: the recording's]
    #[arg(long, value_name = "TIME", value_parser = moment)]
    to: Option<f64>,
    #[command(flatten)]
    outputs: OutputArgs,
}

fn moment(text: &str) -> Result<f64, TimeError> {
    time(text, 20_000.0)
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    args.outputs.refuse_figures("the identification of a loop has no figure")?;
    if let (Some(from), Some(to)) = (args.from, args.to)
        && to <= from
    {
        return Err(format!("--to: {to} s is not after --from, {from} s").into());
    }
    once(&args.files)?;
    let map = args.recording.map()?;
    let stated = args.stated.as_deref().map(StatedLaw::load).transpose();
    let stated = stated.map_err(|error| format!("--stated {error}"))?;
    let bicycle = args.bicycle.as_deref().map(catalogue::load).transpose()?;
    bicycle.iter().for_each(warn);
    let given = bicycle
        .map(|bicycle| Geometry { wheelbase_m: bicycle.parameters.w, tilt_rad: bicycle.parameters.lam });
    let outputs = args.outputs.open(Further::default())?;
    let of_file = |path: &PathBuf| {
        one(args, map.as_ref(), given, stated.as_ref(), path)
            .map_err(|why| RefusedLoop { file: path.display().to_string(), why })
    };
    let done: Vec<Result<LoopEntry, RefusedLoop>> = args.files.par_iter().map(of_file).collect();
    let (mut recordings, mut refused) = (Vec::new(), Vec::new());
    for entry in done {
        match entry {
            Ok(entry) => recordings.push(entry),
            Err(entry) => refused.push(entry),
        }
    }
    refused.iter().for_each(|entry| complain(&format!("{}: not used: {}", entry.file, entry.why)));
    if recordings.is_empty() {
        return Err("no file could be used".into());
    }
    let config = ResolvedLoop {
        map: args.recording.map_name(),
        bicycle: args.bicycle.clone(),
        stated: stated.map(|stated| stated.source),
        from_s: args.from,
        to_s: args.to,
    };
    let document = LoopDocument::new(config, recordings, refused);
    let table = || table::table(&document.config, &rows(&document));
    outputs.write_data(&document, table, || text(&document))?;
    Ok(Ended::Done)
}

fn one(
    args: &Args,
    map: Option<&Map>,
    given: Option<Geometry>,
    stated: Option<&StatedLaw>,
    path: &Path,
) -> Result<LoopEntry, String> {
    let recording = read(path, &args.recording.options()).map_err(|error| error.beside(path))?;
    let map =
        map.cloned().map_or_else(|| Map::by_columns(&recording), Ok).map_err(|error| error.to_string())?;
    let samples = samples(&recording, &map, PERIOD_S).map_err(|remark| remark.to_string())?;
    samples.remarks.iter().for_each(|remark| complain(&format!("{}: {remark}", path.display())));
    let record = within(&record(&samples).map_err(|error| error.to_string())?, args.from, args.to);
    let geometry = given.or_else(|| geometry(&map));
    let identified = identify(&record, geometry.as_ref()).map_err(|error| error.to_string())?;
    let compared = stated.map_or_else(Vec::new, |stated| stated.beside(&identified));
    Ok(LoopEntry { file: path.display().to_string(), geometry, identified, compared })
}
