//! `sim-host identify`: identification of riders, the weave and sensors from recordings.

use super::outputs::{Further, Outputs, Results, complain};
use super::weave_args::WeaveArgs;
use super::{
    Ended, Failure, identify_files, identify_loop, identify_rider, identify_rider_args, identify_sensor, warn,
};
use crate::bicycle::catalogue;
use crate::report::figure;
use crate::report::output::Output;
use crate::report::resolved::ResolvedBicycle;
use crate::report::table;
use crate::report::tool::{SCHEMA, Tool};
use crate::report::weave::{ResolvedWeave, WeaveDocument, chart, rows, text};
use crate::study::balance_assist::{self, RIDERLESS};
use crate::study::{motor_fit, published_weave};
use crate::weave::measured::beside_name;
use serde_json::json;

pub(super) const EXAMPLES: &str = "\
A perturbation record has a lateral force or a steer torque that disturbs a rider at constant speed, and the steer angle: \
docs/identify.md. `sim-host record` makes synthetic ones.

Examples:
  sim-host identify run1.csv --bicycle rigid_jason --delay 30ms --out rider.toml
  sim-host identify run*.csv --delay estimate --fit steer,roll-rate --select bic --results found
  sim-host identify run1.csv --delay-profile 0:120:5 --svg run1.svg --json
  sim-host identify weave gain*_speed*kmh_*.csv --svg weave.svg
  sim-host identify weave ride.csv --speed 3.9 --gain 8 --json
  sim-host identify sensor ride.csv --map extract --sensor gyro --out gyro.toml
  sim-host identify loop ride.csv --map robot-bicycle";

/// Options of `identify`.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    rider: identify_rider_args::RiderArgs,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Frequency and decay of the weave after a disturbance, beside the linear model's
    Weave(Box<WeaveArgs>),
    /// A model of a real sensor: noise, quantisation, timing and vibration, for --sensor of `ride` and others
    Sensor(Box<identify_sensor::Args>),
    /// Steer angle scale, control law, and inertia and friction of the steer axis, from a ride with a controller
    Loop(Box<identify_loop::Args>),
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    match &args.command {
        Some(Command::Weave(args)) => weave(args),
        Some(Command::Sensor(args)) => identify_sensor::run(args),
        Some(Command::Loop(args)) => identify_loop::run(args),
        None => identify_rider::run(&args.rider),
    }
}

fn weave(args: &WeaveArgs) -> Result<Ended, Failure> {
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
        return Err("no file could be used".into());
    }
    let published = published_weave::published();
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
fn open(args: &WeaveArgs) -> Result<(Outputs, Option<Output>), Failure> {
    let outputs = args.outputs.open(Further::default())?;
    let kept = args.toml.as_deref().map(Output::create).transpose()?;
    if let Some(kept) = &kept {
        outputs.refuse_place_of("--toml", kept)?;
    }
    Ok((outputs, kept))
}
