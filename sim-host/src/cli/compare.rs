//! `sim-host basin compare`: compares basins of several cases.

use super::conditions::setup;
use super::options::{self, Options, Search as SearchOptions};
use super::outputs::{Further, OutputArgs, Results, complain};
use super::progress::progress;
use super::scenario_error::named as named_option;
use super::threads::ThreadArgs;
use super::{Ended, Failure, interrupt};
use crate::basin::{Basin, Bound, Column, Search, Work, basin};
use crate::bicycle::linear::Linear;
use crate::commands::Setup;
use crate::eigen::critical_speeds;
use crate::report::compare::{Case, CaseEntry, CompareDocument};
use crate::report::figure::{self, BasinFigure};
use crate::report::resolved::ResolvedSearch;
use crate::report::table;
use crate::scenario::{Scenario, SearchChoice, Speeds};
use control::Law;
use serde_json::{Value, json};
use std::fmt::Write;

const EXAMPLES: &str = "\
Examples:
  sim-host basin compare 'young=--rider young' 'naive=--rider young --delay 60ms' 'smart=--rider smart'
  sim-host basin compare 'rider=--rider smart' 'with h=--rider smart --law h' --svg assist.svg
  sim-host basin --law h --json h.json && sim-host basin compare h.json 'f=--law f' --csv laws.csv";

/// Options of `basin compare`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Case: LABEL=OPTIONS with the options of `basin` for bicycle, rider, law and conditions, `--scenario` included, or
    /// the FILE of a `basin --json`
    #[arg(required = true, num_args = 1..=24, value_name = "LABEL=OPTIONS|FILE")]
    cases: Vec<String>,
    #[command(flatten)]
    search: Options<SearchOptions>,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    outputs: OutputArgs,
}

/// A case before its computation.
enum RequestedCase {
    Compute(String, Box<Setup>),
    /// A case from a file, with the file's axis.
    Done(Case, String),
}

impl RequestedCase {
    fn label(&self) -> &str {
        match self {
            Self::Compute(label, _) => label,
            Self::Done(case, _) => &case.label,
        }
    }
}

pub(super) fn run(args: &Args) -> Result<Ended, Failure> {
    let (requested, ridden) = requested(&args.cases)?;
    let mut scenario = Scenario { search: common_search(&requested)?, ..Scenario::default() };
    args.search.apply(&mut scenario)?;
    let search = scenario.search.resolve(ridden).map_err(|e| named_option(&scenario, &e))?;
    let search = Search { efforts: false, ..search };
    let own_search = SearchChoice { speeds: Some(Speeds::List(search.speeds.clone())), ..scenario.search };
    let resolved = ResolvedSearch::new(&search);
    check(&requested, &resolved.axis)?;
    let outputs = args.outputs.open(Further::default())?;
    interrupt::install();
    let pool = args.threads.pool()?;
    let to_compute = requested.iter().filter(|a| matches!(a, RequestedCase::Compute(..))).count();
    let bar = progress(outputs.shows_progress(), "basin", to_compute * search.speeds.len(), "columns");
    let (mut cases, mut missing, mut stable, mut complete) = (Vec::new(), Vec::new(), None, true);
    for one in requested {
        let case = match one {
            RequestedCase::Done(case, _) => case,
            RequestedCase::Compute(label, setup) => {
                let uncontrolled = critical_speeds(&Linear::new(&setup.parameters), &Law::None);
                stable = stable.or(uncontrolled.v_w.zip(uncontrolled.v_c));
                let found =
                    pool.install(|| basin(&setup.conditions, &search, |_| bar.inc(1), interrupt::stopped));
                let config = json!(setup.config);
                let own = Scenario {
                    search: own_search.clone(),
                    uncertain: None,
                    rider_draws: None,
                    ..setup.scenario
                };
                let scenario = json!(own);
                let basin = found?;
                let complete = basin.columns.len() == search.speeds.len();
                Case { label, config, scenario, basin, complete }
            }
        };
        complete &= !interrupt::stopped();
        match case.basin.columns.is_empty() {
            true => missing.push(case.label),
            false => cases.push(case),
        }
    }
    bar.finish_and_clear();
    if cases.is_empty() {
        complain("interrupted: no speed is done, nothing is written");
        return Ok(Ended::Interrupted);
    }
    let document = CompareDocument::new(resolved, &cases, complete, missing);
    let series: Vec<(&str, &Basin)> = cases.iter().map(|c| (c.label.as_str(), &c.basin)).collect();
    let title = if complete { "Basins of attraction" } else { "Basins of attraction, interrupted" };
    let figure = BasinFigure {
        series: &series,
        self_stable: stable,
        axis: search.axis,
        cap: search.max_rate,
        title,
        band: None,
    };
    let configs: Vec<_> =
        document.cases.iter().map(|c| json!({"label": c.label, "config": c.config})).collect();
    let config = json!({"cases": configs, "search": document.search, "complete": complete});
    outputs.write(Results {
        document: &document,
        config: &config,
        summary: || summary(&document),
        table: || heights(&config, &cases),
        figure: || figure::basin(&figure),
    })?;
    if complete {
        return Ok(Ended::Done);
    }
    complain("interrupted: finished results are kept");
    Ok(Ended::Interrupted)
}

/// The cases as given, and whether a rider steers one that is to be computed.
fn requested(cases: &[String]) -> Result<(Vec<RequestedCase>, bool), Failure> {
    let mut requested = Vec::new();
    let mut ridden = false;
    for text in cases {
        match text.split_once('=').filter(|_| !std::path::Path::new(text).is_file()) {
            Some((label, options)) => {
                let case = options::parsed(options).map_err(|e| named(label, e))?;
                ridden |= case.is_ridden();
                let setup = setup(&case).map_err(|e| named(label, e))?;
                requested.push(RequestedCase::Compute(label.into(), Box::new(setup)));
            }
            None => {
                let (case, axis) = read(text)?;
                requested.push(RequestedCase::Done(case, axis));
            }
        }
    }
    Ok((requested, ridden))
}

/// Rejects a case of a file with another axis, and labels that are not distinct columns of the table.
fn check(requested: &[RequestedCase], chosen: &str) -> Result<(), Failure> {
    for (i, one) in requested.iter().enumerate() {
        if let RequestedCase::Done(case, axis) = one
            && axis != chosen
        {
            return Err(format!("{}: its axis is {axis}, --axis is {chosen}", case.label).into());
        }
        let (label, capped) = (one.label(), format!("{}{CAPPED}", one.label()));
        if requested[..i].iter().any(|other| other.label() == label) {
            return Err(format!("two cases are called `{label}`; each needs a label of its own").into());
        }
        if requested.iter().any(|other| other.label() == capped) {
            return Err(format!(
                "`{capped}` is a column of the case `{label}` in the table; choose another label"
            )
            .into());
        }
    }
    Ok(())
}

/// The search of the scenarios of the cases, if they have one; it must be the same in all that have one.
fn common_search(cases: &[RequestedCase]) -> Result<SearchChoice, Failure> {
    let searches = cases.iter().filter_map(|case| match case {
        // A comparison is at common speeds.
        RequestedCase::Compute(label, setup) => {
            Some((label, SearchChoice { adaptive_speeds: None, ..setup.scenario.search.clone() }))
        }
        RequestedCase::Done(..) => None,
    });
    let mut own = searches.filter(|(_, search)| *search != SearchChoice::default());
    let Some((first, search)) = own.next() else { return Ok(SearchChoice::default()) };
    match own.find(|(_, other)| *other != search) {
        Some((label, _)) => Err(format!(
            "the scenarios of the cases `{first}` and `{label}` have different searches; a comparison has one"
        )
        .into()),
        None => Ok(search),
    }
}

fn named(label: &str, error: impl std::fmt::Display) -> Failure {
    format!("case `{label}`: {error}").into()
}

/// Reads the outline from a file of `basin --json`.
fn read(path: &str) -> Result<(Case, String), Failure> {
    let text = crate::input_file::text(std::path::Path::new(path))
        .map_err(|e| format!("`{path}` is neither LABEL=OPTIONS nor a file that can be read: {e}"))?;
    let document: Value = serde_json::from_str(&text).map_err(|e| format!("{path}: {e}"))?;
    let wrong = |what: &str| format!("{path}: no `{what}`; expected the document of `sim-host basin --json`");
    let list = |value: &Value| value.as_array().cloned();
    let speeds = list(&document["speeds"]).ok_or_else(|| wrong("speeds"))?;
    let upper = list(&document["height"]["upper"]).ok_or_else(|| wrong("height.upper"))?;
    let capped = list(&document["capped"]).ok_or_else(|| wrong("capped"))?;
    let axis = document["search"]["axis"].as_str().ok_or_else(|| wrong("search.axis"))?;
    if upper.len() != speeds.len() || capped.len() != speeds.len() {
        return Err(format!("{path}: `speeds`, `height.upper` and `capped` differ in length").into());
    }
    let mut columns = Vec::new();
    for ((speed, upper), capped) in speeds.iter().zip(&upper).zip(&capped) {
        let speed = speed.as_f64().ok_or_else(|| wrong("speeds of numbers"))?;
        // An interrupted basin has missing speeds.
        let Some(upper) = upper.as_f64() else { continue };
        let capped =
            capped.as_bool().ok_or_else(|| wrong("capped` of true and false beside the heights, `"))?;
        let (islands, scan) = (Vec::new(), Vec::new());
        columns.push(Column {
            speed,
            upper,
            capped,
            islands,
            scan,
            outcome: None,
            border: None,
            beyond: None,
            work: Work::default(),
        });
    }
    if columns.is_empty() {
        return Err(format!("{path}: no speed of it is computed").into());
    }
    if columns.len() < speeds.len() {
        let (done, all) = (columns.len(), speeds.len());
        complain(&format!("warning: {path} is of an interrupted search: {done} of {all} speeds are in it"));
    }
    let label =
        std::path::Path::new(path).file_stem().map_or(path.into(), |s| s.to_string_lossy().into_owned());
    let [config, scenario] = ["config", "scenario"].map(|key| document[key].clone());
    let complete = columns.len() == speeds.len();
    let case = Case { label, config, scenario, basin: Basin { columns }, complete };
    Ok((case, axis.into()))
}

/// Suffix of a case's label in the table, for the column that marks lower bounds.
const CAPPED: &str = "_capped";

/// The heights by speed, a column per case; then whether they are lower bounds, a column per case.
fn heights(config: &Value, cases: &[Case]) -> Result<Vec<u8>, csv::Error> {
    let mut speeds: Vec<f64> = cases.iter().flat_map(|c| &c.basin.columns).map(|c| c.speed).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup_by(|b, a| (*b - *a).abs() < 1e-9);
    let labels = || cases.iter().map(|c| c.label.clone());
    let capped = labels().map(|label| label + CAPPED);
    let names: Vec<String> = std::iter::once("speed_m_s".into()).chain(labels()).chain(capped).collect();
    let rows = speeds.into_iter().map(|v| {
        let columns: Vec<Option<&Column>> =
            cases.iter().map(|c| c.basin.columns.iter().find(|c| (c.speed - v).abs() < 1e-9)).collect();
        let heights = columns.iter().map(|c| c.map_or(String::new(), |c| c.upper.to_string()));
        let capped = columns.iter().map(|c| c.map_or(String::new(), |c| c.capped.to_string()));
        std::iter::once(v.to_string()).chain(heights).chain(capped).collect::<Vec<_>>()
    });
    table::rows(config, &names, rows)
}

fn summary(document: &CompareDocument) -> String {
    let cases = &document.cases;
    let width = cases.iter().map(|c| c.label.chars().count()).max().unwrap_or(0).max(4);
    let mut text = format!("{:width$}  area rad m/s^2   mean rad/s  of the first  RMSE rad/s to", "case");
    for i in 1..=cases.len() {
        let _ = write!(text, " {i:>8}");
    }
    text.push('\n');
    let one_speed = document.one_speed();
    for ((case, distances), bounds) in cases.iter().zip(&document.rmse).zip(&document.rmse_is) {
        let sign = Bound::of(case.area_capped).sign();
        let area = case.area.map_or("-".into(), |area| format!("{sign}{area:.3}"));
        let mean = case.mean_height.map_or("-".into(), |m| format!("{sign}{m:.3}"));
        let part = if one_speed { case.relative_height } else { case.relative_area };
        let part = part.map_or("-".into(), |r| format!("{}{:.1} %", case.relative_is.sign(), 100.0 * r));
        let _ = write!(text, "{:width$}  {area:>14}  {mean:>11}  {part:>12}  {:13}", case.label, "");
        for (d, bound) in distances.iter().zip(bounds) {
            let sign = bound.map_or("", Bound::sign);
            let _ = write!(text, " {:>8}", d.map_or("-".into(), |d| format!("{sign}{d:.3}")));
        }
        text.push('\n');
    }
    for case in cases.iter().filter(|case| !case.complete) {
        let (label, done) = (&case.label, case.speeds.len());
        let _ = writeln!(text, "`{label}` is incomplete ({done} speeds): no area and no mean height");
    }
    for label in &document.missing {
        let _ = writeln!(text, "`{label}` is missing: none of its speeds is done");
    }
    if one_speed {
        text += "one speed: no area; compared by height\n";
    }
    if cases.iter().any(|c| c.area_capped) {
        text += ">= and <=: at least and at most; nothing fell up to the largest rate tried at some speeds\n";
    }
    if cases.iter().any(|c| c.relative_is == Bound::Unknown) {
        text += "~: which of two such areas is larger is not known; a larger --max-rate tells\n";
    }
    if !document.same_speeds {
        let ends = |case: &CaseEntry| (case.speeds.first().copied(), case.speeds.last().copied());
        text += match cases.windows(2).all(|pair| ends(&pair[0]) == ends(&pair[1])) {
            true => "the cases have different speeds of the same range, and common ones for the RMSE\n",
            false => "the cases cover different speeds: their areas and means can't be compared\n",
        };
    }
    text
}
