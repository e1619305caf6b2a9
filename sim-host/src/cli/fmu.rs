//! `sim-host fmu`: FMUs for other simulators.

use super::conditions::{printed, setup};
use super::options::{Chosen, Fmu};
use super::outputs::{complain, print};
use super::{Ended, Failure};
use crate::commands::Setup;
use crate::fmu::{Part, Version, archive, library, model, with_speed};
use crate::report::output::Output;
use crate::scenario::Scenario;
use serde_json::Value;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  sim-host fmu export controller
  sim-host fmu export bicycle --speed 4 --steer-rate 5 --out bicycle.fmu
  sim-host fmu export rider --rider smart --fmi 2
  sim-host fmu export controller --preset product --torque-limit 5

Step them at 1 kHz; in FMPy that is output_interval=0.001 (docs/fmi.md).";

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Writes an FMU for co-simulation
    #[command(after_help = EXAMPLES)]
    Export(Box<Args>),
}

#[derive(clap::Args)]
pub(super) struct Args {
    /// What the FMU is
    #[arg(value_name = "PART")]
    part: Part,
    /// Version of the interface
    #[arg(long, value_name = "VERSION", default_value = "3")]
    fmi: Version,
    /// Write the FMU to FILE [default: PART.fmu]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The crate fmi's dynamic library [default: the one beside this program]
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
    #[command(flatten)]
    scenario: Chosen<Fmu>,
}

/// The model of a part, as in its FMU; `None` if the scenario has none.
fn model_of(part: Part, scenario: &Scenario) -> Option<Value> {
    let setup = Setup::new(&with_speed(scenario.clone())).ok()?;
    serde_json::to_value(model(part, &setup).ok()?).ok()
}

pub(super) fn run(command: &Command) -> Result<Ended, Failure> {
    let Command::Export(args) = command;
    let scenario = with_speed(args.scenario.scenario()?);
    if let Some(ended) = printed(&args.scenario, &scenario)? {
        return Ok(ended);
    }
    let setup = setup(&scenario)?;
    let model = model(args.part, &setup)?;
    let made = |scenario: &Scenario| model_of(args.part, scenario);
    let judged = |name: &str| !args.part.options().contains(&name);
    for name in args.scenario.idle(judged, made)? {
        complain(&format!("warning: --{name} has no effect on the FMU {}", args.part.name()));
    }
    let path = args.out.clone().unwrap_or_else(|| format!("{}.fmu", args.part.name()).into());
    let output = Output::create(&path)?;
    let fmu = archive(args.fmi, args.part, (&model, &setup.scenario), &library(args.library.as_deref())?)?;
    output.finish(&fmu)?;
    if output.is_standard() {
        return Ok(Ended::Done);
    }
    let (variables, step_s) = (model.table()?.variables().len(), model.step_s()?);
    print(&format!("{}: {} variables, time step {step_s} s\n", path.display(), variables))?;
    Ok(Ended::Done)
}
