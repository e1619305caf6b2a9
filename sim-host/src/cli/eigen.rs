//! `sim-host eigen`.

use super::outputs::{OutputArgs, Results};
use super::{Ended, Failure, law, speeds, warn};
use crate::bicycle::catalogue;
use crate::bicycle::linear::Linear;
use crate::eigen::{CriticalSpeeds, critical_speeds, eigenvalues};
use crate::report::document::{EigenDocument, SCHEMA};
use crate::report::figure::{self, EigenFigure};
use crate::report::resolved::{ResolvedBicycle, ResolvedLaw, Tool};
use crate::report::{table, terminal};
use serde_json::json;
use std::fmt::Write;

const EXAMPLES: &str = "\
Examples:
  sim-host eigen --bicycle benchmark
  sim-host eigen --law h --speeds 0:10:0.05 --svg eigen.svg
  sim-host eigen --law cl2:4 --json";

/// Options of `eigen`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Shipped bicycle, FILE, or FILE#NAME of a collection
    #[arg(long, default_value = "rigid_jason", value_name = "NAME|FILE")]
    bicycle: String,
    /// Roll-rate law: none, h, h-cut, f, g, cl1, cl2:K, or a table FILE
    #[arg(long, default_value = "none")]
    law: String,
    /// Forward speeds in m/s: A:B:STEP, B included, or one
    #[arg(long, default_value = "0:10:0.1", value_parser = speeds::parse, value_name = "A:B:STEP", allow_hyphen_values = true)]
    speeds: std::vec::Vec<f64>,
    #[command(flatten)]
    outputs: OutputArgs,
}

/// One line of the table: real and imaginary parts of the four eigenvalues.
#[derive(serde::Serialize)]
struct Row {
    speed_m_s: f64,
    re1: f64,
    im1: f64,
    re2: f64,
    im2: f64,
    re3: f64,
    im3: f64,
    re4: f64,
    im4: f64,
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let bicycle = catalogue::load(&args.bicycle)?;
    warn(&bicycle);
    let law = law::parse(&args.law)?;
    let outputs = args.outputs.open(None)?;
    let linear = Linear::new(&bicycle.parameters);
    let critical = critical_speeds(&linear, &law);
    let values: Vec<_> = args.speeds.iter().map(|&v| eigenvalues(&linear, &law, v)).collect();
    let CriticalSpeeds { v_d, v_w, v_c } = critical;
    let document = EigenDocument {
        schema: SCHEMA,
        tool: Tool::this(),
        bicycle: ResolvedBicycle::new(&bicycle),
        law: ResolvedLaw::new(&args.law, &law),
        v_d,
        v_w,
        v_c,
        speeds: args.speeds.clone(),
        eigenvalues: values.iter().map(|four| four.map(|e| [e.re, e.im])).collect(),
    };
    let rows = || {
        let row = |(&speed_m_s, [a, b, c, d]): (&f64, &[nalgebra::Complex<f64>; 4])| Row {
            speed_m_s,
            re1: a.re,
            im1: a.im,
            re2: b.re,
            im2: b.im,
            re3: c.re,
            im3: c.im,
            re4: d.re,
            im4: d.im,
        };
        args.speeds.iter().zip(&values).map(row).collect::<Vec<_>>()
    };
    let title = format!("Eigenvalues: {}, law {}", bicycle.name, args.law);
    let figure = EigenFigure { speeds: &args.speeds, eigenvalues: &values, critical, title: &title };
    let config = json!({"bicycle": document.bicycle, "law": document.law});
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || terminal::eigen(&figure, 80) + &summary(&critical),
        table: || table::table(&config, &rows()),
        figure: || figure::eigen(&figure),
    })?;
    Ok(Ended::Done)
}

fn summary(critical: &CriticalSpeeds) -> String {
    let mut text = String::new();
    for (name, what, speed) in [
        ("v_d", "weave pair forms", critical.v_d),
        ("v_w", "weave becomes stable", critical.v_w),
        ("v_c", "capsize becomes unstable", critical.v_c),
    ] {
        let _ = match speed {
            Some(v) => writeln!(text, "{name} = {v:.4} m/s ({what})"),
            None => writeln!(text, "{name}: none up to {} m/s ({what})", crate::eigen::SEARCH_TO_M_S),
        };
    }
    text
}
