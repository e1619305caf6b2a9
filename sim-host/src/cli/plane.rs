//! `sim-host basin plane`: a basin over steer rate and roll rate at one speed.

use super::conditions::{printed, setup};
use super::options::{Chosen, Plane as PlaneOptions};
use super::outputs::{Further, OutputArgs, Results, complain};
use super::progress::progress;
use super::ride::laid_flat;
use super::scenario_error::named;
use super::threads::ThreadArgs;
use super::{Ended, Failure, interrupt};
use crate::basin::Plane;
use crate::commands::{Hooks, plane};
use crate::counted::counted;
use crate::report::figure::{self, PlaneFigure};
use crate::report::plane::{PlaneDocument, plane_rows};
use crate::report::{netcdf, table};
use crate::ride::FallCause;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  sim-host basin plane --speed 4 --svg plane.svg
  sim-host basin plane --speed 4.3 --rider smart --law h --json plane.json
  sim-host basin plane --speed 7 --law none --max-roll-rate 2 --rays 180 --csv plane.csv";

/// Options of `basin plane`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    #[command(flatten)]
    scenario: Chosen<PlaneOptions>,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Write a NetCDF file with CF conventions; a name that ends with .nc4 gives NetCDF-4; - is standard output
    #[arg(long, value_name = "FILE")]
    netcdf: Option<PathBuf>,
    #[command(flatten)]
    outputs: OutputArgs,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let scenario = args.scenario.scenario()?;
    let search = plane::search(&scenario).map_err(|e| named(&scenario, &e))?;
    if let Some(ended) = printed(&args.scenario, &scenario)? {
        return Ok(ended);
    }
    let setup = setup(&scenario)?;
    plane::check_mirrored(&setup)?;
    let outputs = args.outputs.open(Further { netcdf: args.netcdf.as_deref(), ..Further::default() })?;
    interrupt::install();
    let pool = args.threads.pool()?;
    let bar = progress(outputs.shows_progress(), "basin", search.rays, "rays");
    let hooks = Hooks { finished: &|| bar.inc(1), added: &|_| (), stop: &interrupt::stopped };
    let found = pool.install(|| plane::plane(&setup, hooks));
    bar.finish_and_clear();
    let found = found?;
    if found.plane.rays.is_empty() {
        complain("interrupted: no ray is done, nothing is written");
        return Ok(Ended::Interrupted);
    }
    let label = setup.config.label();
    let document = found.document(&setup);
    let found = found.plane;
    let cut = if document.complete { "" } else { ", interrupted" };
    let title = format!("Basin of attraction at {} m/s: {label}{cut}", search.speed);
    let config = json!({"config": document.config, "search": search, "complete": document.complete});
    let written = outputs
        .write_netcdf(|| netcdf::plane(&title, netcdf::provenance(&config, &document.scenario), &found));
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || summary(&document, &found),
        table: || table::table(&config, &plane_rows(&found)),
        figure: || figure::plane(&PlaneFigure { title: &title, plane: &found }),
    })?;
    written?;
    if document.complete {
        return Ok(Ended::Done);
    }
    complain(&format!("interrupted: {} of {} rays are done and kept", found.rays.len(), search.rays));
    Ok(Ended::Interrupted)
}

fn summary(document: &PlaneDocument, plane: &Plane) -> String {
    let mut text = String::new();
    if let Some(area) = document.area {
        let at_least = if document.area_capped { "at least " } else { "" };
        let _ = writeln!(text, "area {at_least}{area:.3} rad^2/s^2");
    }
    if document.complete {
        let outline = plane.outline();
        let most = |of: fn(&(f64, f64)) -> f64| outline.iter().map(of).fold(0.0, f64::max);
        let _ = writeln!(
            text,
            "reaches {:.3} rad/s of steer rate and {:.3} rad/s of roll rate",
            most(|p| p.0),
            most(|p| p.1)
        );
    } else {
        let (done, all) = (plane.rays.len(), document.search.rays);
        let _ = writeln!(text, "incomplete, {done} of {all} rays: no area");
    }
    let count = |is: fn(&crate::basin::Ray) -> bool| plane.rays.iter().filter(|ray| is(ray)).count();
    let flat = count(|ray| matches!(ray.column.beyond, Some(FallCause::LaidFlat | FallCause::TooQuick)));
    if flat > 0 {
        let _ = writeln!(
            text,
            "beyond the border of {flat} rays rides lie flat: {}",
            laid_flat(&document.config.fall)
        );
    }
    let _ = writeln!(
        text,
        "{}, {} with islands beyond, {} without a fall to their end; {}, {:.2} s",
        counted(plane.rays.len(), "ray", "rays"),
        count(|ray| !ray.column.islands.is_empty()),
        count(|ray| ray.column.capped),
        counted(document.work.rides, "ride", "rides"),
        document.seconds
    );
    text
}
