//! `sim-host design`: optimises a gain schedule and evaluates it.

use super::options::{Fall, Options};
use super::outputs::{Further, OutputArgs, Results, complain};
use super::progress::print_wait;
use super::threads::ThreadArgs;
use super::{Ended, Failure, interrupt};
use crate::basin::{Axis, Method, Search};
use crate::design::document::{Design, DesignDocument, figure, law_file};
use crate::design::{Knots, Plan, Progress, competitors, evaluate, evaluate_in, optimise, scenarios};
use crate::report::figure;
use crate::report::output::Output;
use crate::report::table;
use crate::scenario::{law, seed};
use crate::sweep;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const EXAMPLES: &str = "\
Examples:
  sim-host design --budget 10min --law-file mine.toml --json mine.json --svg mine.svg
  sim-host design --start mine.toml --seed 2 --law-file better.toml     going on from there
  sim-host design --start mine.toml --evaluations 1 --results judged    only its evaluation, shared
  sim-host design --budget 30s --judge none --law-file look.toml        a quick look";

/// Options of `design`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Longest time of the search, for example 90s, 10min or 2h; the evaluation follows
    #[arg(long, default_value = "10min", value_name = "TIME", value_parser = budget, allow_hyphen_values = true)]
    budget: Duration,
    /// Largest number of evaluated schedules
    #[arg(long, default_value_t = 400, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    evaluations: u32,
    /// Seed of the restarted simplices
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = seed)]
    seed: u64,
    /// Points of the schedule between 2 and 7.5 m/s, 2 to 8
    #[arg(long, default_value_t = 6, value_name = "N", value_parser = clap::value_parser!(u8).range(2..=8))]
    knots: u8,
    /// Weight of the smoothness penalty, in rad m/s^2 per (N m s/rad)^2
    #[arg(long, default_value_t = 0.0, value_name = "WEIGHT", allow_negative_numbers = true)]
    smoothness: f64,
    #[command(flatten)]
    fall: Options<Fall>,
    /// Initial law, as in --law
    #[arg(long, default_value = "h-cut", value_name = "LAW")]
    start: String,
    /// Step of the speeds during the search, in m/s
    #[arg(long, default_value_t = 1.1, value_name = "M/S", allow_negative_numbers = true)]
    coarse: f64,
    /// Step of the speeds in the evaluation beside the known laws, in m/s, or none
    #[arg(long, default_value = "0.25", value_name = "M/S|none", value_parser = evaluation_step, allow_hyphen_values = true)]
    judge: EvaluationStep,
    /// Keep the evaluation in DIR as a sweep, which is continued and shared by several processes
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    /// Write the law as a file for --law
    #[arg(long, value_name = "FILE")]
    law_file: Option<PathBuf>,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    outputs: OutputArgs,
}

/// Step of the speeds in the evaluation; `None` for no evaluation.
#[derive(Clone, Copy)]
struct EvaluationStep(Option<f64>);

fn evaluation_step(text: &str) -> Result<EvaluationStep, String> {
    if text == "none" {
        return Ok(EvaluationStep(None));
    }
    text.parse()
        .map(|step| EvaluationStep(Some(step)))
        .map_err(|_| format!("`{text}` is neither a number nor none"))
}

fn budget(text: &str) -> Result<Duration, String> {
    let wrong =
        || format!("`{text}` is not a time; expected a number with its unit, for example 90s, 10min or 2h");
    let units = [("min", 60.0), ("ms", 1e-3), ("h", 3600.0), ("s", 1.0)];
    let unit = units.iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)));
    let (number, seconds) = unit.ok_or_else(wrong)?;
    let time = number.trim().parse::<f64>().map_err(|_| wrong())? * seconds;
    if (1e-3..=1e6).contains(&time) {
        Ok(Duration::from_secs_f64(time))
    } else {
        Err(format!("{text} is outside 1 ms to 1000000 s"))
    }
}

/// A search over 2 to 7.5 m/s.
fn search(option: &str, step: f64, scan_step: f64, tolerance: f64) -> Result<Search, Failure> {
    if !(0.01..=5.5).contains(&step) {
        return Err(format!("{option} {step} is outside 0.01 to 5.5 m/s").into());
    }
    // The last speed is 7.5 m/s even if the step does not divide the range.
    let steps = (5.5 / step - 1e-9).ceil() as usize;
    let speeds = (0..=steps).map(|i| ((2.0 + i as f64 * step).min(7.5) * 1e9).round() / 1e9).collect();
    let search = Search {
        speeds,
        axis: Axis::SteerRate,
        max_rate: 20.0,
        scan_step,
        tolerance,
        method: Method::Fast,
        efforts: false,
    };
    search.check()?;
    Ok(search)
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let start = law::parse(&args.start)?;
    if !(0.0..=10.0).contains(&args.smoothness) {
        return Err(format!("--smoothness {} is outside 0 to 10", args.smoothness).into());
    }
    let plan = Plan {
        knots: Knots::new(args.knots.into())?,
        start,
        search: search("--coarse", args.coarse, 1.0, 0.15)?,
        smoothness: args.smoothness,
        seed: args.seed,
        evaluations: args.evaluations,
    };
    let fine = search("--judge", args.judge.0.unwrap_or(0.25), 0.25, 0.02)?;
    let scenarios = scenarios(args.fall.fall()?);
    let outputs = args.outputs.open(Further::default())?;
    let law_output = args.law_file.as_deref().map(Output::create).transpose()?;
    if let Some(output) = &law_output {
        outputs.refuse_place_of("--law-file", output)?;
    }
    interrupt::install();
    let pool = args.threads.pool()?;
    let begin = Instant::now();
    let late = || begin.elapsed() >= args.budget;
    let stop = || interrupt::stopped() || late();
    let bar = progress(outputs.shows_progress(), "design", u64::from(plan.evaluations));
    let advanced = |now: Progress| {
        let by_time = begin.elapsed().as_secs_f64() / args.budget.as_secs_f64();
        let part = f64::from(now.evaluations) / f64::from(plan.evaluations);
        // The limit that is reached first determines the bar, which computes the remaining time.
        bar.set_position((part.max(by_time).min(1.0) * f64::from(plan.evaluations)) as u64);
        bar.set_message(format!("{} tried, least area {:.3}", now.evaluations, now.best));
    };
    let found = pool.install(|| optimise(&scenarios.training, &plan, &advanced, &stop));
    bar.finish_and_clear();
    let Some(found) = found? else {
        let early = "stopped before the first schedule was tried, nothing is written";
        if !interrupt::stopped() {
            return Err(format!("--budget {:?}: {early}", args.budget).into());
        }
        complain(early);
        return Ok(Ended::Interrupted);
    };
    let law = plan.knots.law(&found.gains)?;
    let mut laws = competitors();
    laws.push(("design".into(), law.clone()));
    let mut evaluation = None;
    if args.judge.0.is_some() && !interrupt::stopped() {
        let columns = (scenarios.training.len() + scenarios.held_out.len()) * laws.len() * fine.speeds.len();
        let bar = progress(outputs.shows_progress(), "judge", columns as u64);
        let advanced = || bar.inc(1);
        let waits = |wait: &sweep::Wait| print_wait(outputs.shows_progress(), &bar, wait);
        let steps = sweep::Progress { advanced: &advanced, waits: &waits, stop: &interrupt::stopped };
        evaluation = pool.install(|| match &args.results {
            Some(folder) => evaluate_in(folder, &scenarios, &laws, &fine, &steps),
            None => Ok(evaluate(&scenarios, &laws, &fine, &advanced, &interrupt::stopped)?),
        })?;
        bar.finish_and_clear();
    }
    let design = Design {
        plan: &plan,
        start: &args.start,
        found: &found,
        law: &law,
        scenarios: &scenarios,
        fine: &fine,
        laws: &laws,
        evaluation: evaluation.as_ref(),
    };
    if let Some(output) = &law_output {
        output.finish(law_file(&design).as_bytes())?;
    }
    let document = DesignDocument::new(&design, begin.elapsed().as_secs_f64());
    let config = json!({"seed": document.seed, "evaluations": document.evaluations, "complete": document.complete,
        "start": document.start, "schedule": document.schedule, "smoothness": document.smoothness, "fall": document.fall,
        "coarse": document.coarse, "fine": document.fine});
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || document.summary(),
        table: || table::rows(&config, &document.columns(), document.rows()),
        figure: || figure::chart(&figure(&document, &laws)),
    })?;
    if interrupt::stopped() {
        complain("interrupted: the best so far is kept");
        return Ok(Ended::Interrupted);
    }
    Ok(Ended::Done)
}

/// A progress bar with the remaining time, on standard error if it is a terminal.
fn progress(shown: bool, what: &str, count: u64) -> ProgressBar {
    if !shown {
        return ProgressBar::hidden();
    }
    let template = format!("{what} {{bar:40}} {{elapsed}} gone, {{eta}} left {{msg}}");
    let style = ProgressStyle::with_template(&template);
    ProgressBar::new(count).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
