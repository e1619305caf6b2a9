//! Document, table, figure and law file of `design`.

use super::{Evaluation, Found, Plan, Scenarios};
use crate::basin::Bound;
use crate::counted::counted;
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::report::resolved::ResolvedSearch;
use crate::report::tool::{SCHEMA, Tool};
use crate::ride::FallCriterion;
use crate::scenario::Scenario;
use control::Law;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// `design`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DesignDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The initial law of the search, as given.
    pub start: String,
    /// Seed of the restarted simplices.
    pub seed: u64,
    /// Requested number of evaluated schedules.
    pub evaluations_asked: u32,
    /// Number of evaluated schedules; the result is a function of it and the seed.
    pub evaluations: u32,
    /// False if time ran out or after an interruption: the result is then the best so far.
    pub complete: bool,
    /// Weight of the smoothness penalty \[rad m/s^2 per (N m s/rad)^2\].
    pub smoothness: f64,
    /// Torque limit \[N m\].
    pub torque_limit_nm: Option<f32>,
    /// Limit of the torque's rise \[N m/s\]; its fall has the product's limit, 200 N m/s.
    pub rate_limit_nm_s: Option<f32>,
    /// When a ride counts as fallen.
    pub fall: FallCriterion,
    /// The schedule: speed \[m/s\] and gain \[N m s/rad\].
    pub schedule: Vec<(f32, f32)>,
    /// Smallest area over the design scenarios, from the coarse search \[rad m/s^2\].
    pub worst_area: f64,
    /// Whether it is a lower bound because nothing fell up to the largest rate tried at some speed.
    pub worst_area_capped: bool,
    /// Smallest area of the initial law \[rad m/s^2\].
    pub start_worst_area: f64,
    /// Whether that is a lower bound.
    pub start_worst_area_capped: bool,
    /// Every improvement: number of evaluated schedules, smallest area.
    pub history: Vec<(u32, f64)>,
    /// Search of areas during the optimisation.
    pub coarse: SearchEntry,
    /// Search of areas in the trials below.
    pub fine: SearchEntry,
    /// The compared laws, by their names on the command line; the last is "design".
    pub laws: Vec<String>,
    /// All trials; empty if they were switched off or interrupted.
    pub trials: Vec<TrialEntry>,
    /// Computing time \[s\].
    pub seconds: f64,
}

/// Search of areas.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SearchEntry {
    /// Forward speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// The search at each speed.
    #[serde(flatten)]
    pub search: ResolvedSearch,
}

/// The laws in one trial.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct TrialEntry {
    /// Rider and bicycle.
    pub label: String,
    /// Its scenario; the law is that of each comparison.
    pub scenario: Scenario,
    /// Whether it is a design scenario (true) or a hold-out scenario.
    pub designed_with: bool,
    /// Area of the basin under each of `laws`, trapezoidal rule \[rad m/s^2\].
    pub area: Vec<f64>,
    /// Whether these are lower bounds because nothing fell up to the largest rate tried at some speed.
    pub area_capped: Vec<bool>,
}

impl SearchEntry {
    /// The entry of a search.
    pub fn new(search: &crate::basin::Search) -> Self {
        Self { speeds: search.speeds.clone(), search: ResolvedSearch::new(search) }
    }
}

/// A design and its evaluation.
#[derive(Clone, Copy, Debug)]
pub struct Design<'a> {
    /// Configuration of the optimisation.
    pub plan: &'a Plan,
    /// The initial law, as given.
    pub start: &'a str,
    /// Result of the optimisation.
    pub found: &'a Found,
    /// The resulting law.
    pub law: &'a Law,
    /// The design and hold-out scenarios.
    pub scenarios: &'a Scenarios,
    /// Search of areas for the evaluation.
    pub fine: &'a crate::basin::Search,
    /// The compared laws; the designed one is the last.
    pub laws: &'a [(String, Law)],
    /// Their areas, if evaluated.
    pub evaluation: Option<&'a Evaluation>,
}

impl DesignDocument {
    /// The document of a design with its computing time `seconds`.
    pub fn new(d: &Design, seconds: f64) -> Self {
        let trials = d.scenarios.training.iter().map(|t| (t, true));
        let trials: Vec<_> = trials.chain(d.scenarios.held_out.iter().map(|t| (t, false))).collect();
        let entries = |evaluation: &Evaluation| {
            let found = evaluation.areas.iter().zip(&evaluation.capped);
            let entries =
                trials.iter().zip(found).map(|((trial, designed_with), (area, capped))| TrialEntry {
                    label: trial.label.clone(),
                    scenario: trial.scenario.clone(),
                    designed_with: *designed_with,
                    area: area.clone(),
                    area_capped: capped.clone(),
                });
            entries.collect()
        };
        let limits = d.scenarios.limits;
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            start: d.start.into(),
            seed: d.plan.seed,
            evaluations_asked: d.plan.evaluations,
            evaluations: d.found.evaluations,
            complete: d.found.complete,
            smoothness: d.plan.smoothness,
            torque_limit_nm: limits.max_torque_nm,
            rate_limit_nm_s: limits.rise_nm_s,
            fall: d.scenarios.fall,
            schedule: points(d.law),
            worst_area: d.found.worst_area,
            worst_area_capped: d.found.worst_capped,
            start_worst_area: d.found.start_area,
            start_worst_area_capped: d.found.start_capped,
            history: d.found.history.clone(),
            coarse: SearchEntry::new(&d.plan.search),
            fine: SearchEntry::new(d.fine),
            laws: d.laws.iter().map(|(name, _)| name.clone()).collect(),
            trials: d.evaluation.map_or(Vec::new(), entries),
            seconds,
        }
    }

    /// The result as text.
    pub fn summary(&self) -> String {
        let mut text = format!(
            "{} tried, least area {}{:.3} rad m/s^2 (coarse; {} has {}{:.3})\n",
            counted(self.evaluations, "schedule", "schedules"),
            Bound::of(self.worst_area_capped).sign(),
            self.worst_area,
            self.start,
            Bound::of(self.start_worst_area_capped).sign(),
            self.start_worst_area
        );
        for (speed, gain) in &self.schedule {
            let _ = writeln!(text, "  {speed:5.2} m/s  {gain:7.2} N m s/rad");
        }
        if self.trials.is_empty() {
            return text;
        }
        let row = |label: &str, cells: Vec<String>| {
            format!("{label:<54} {}\n", cells.iter().map(|c| format!("{c:>8}")).collect::<String>())
        };
        let short = |name: &String| name.replace("balance-assist", "ba");
        text += &row("area [rad m/s^2]", self.laws.iter().map(short).collect());
        for (designed_with, title) in [(true, "designed with"), (false, "held out")] {
            let trials: Vec<&TrialEntry> =
                self.trials.iter().filter(|t| t.designed_with == designed_with).collect();
            let cell = |trial: &TrialEntry, i: usize| {
                format!("{}{:.2}", Bound::of(trial.area_capped[i]).sign().trim(), trial.area[i])
            };
            for trial in &trials {
                text += &row(&trial.label, (0..self.laws.len()).map(|i| cell(trial, i)).collect());
            }
            let least = |i: usize| trials.iter().min_by(|a, b| a.area[i].total_cmp(&b.area[i]));
            let least = (0..self.laws.len()).map(|i| least(i).map_or("-".into(), |t| cell(t, i))).collect();
            text += &row(&format!("least, {title}"), least);
        }
        if self.trials.iter().flat_map(|t| &t.area_capped).any(|capped| *capped) {
            text += ">=: at least; nothing fell up to the largest rate tried at some speeds\n";
        }
        text
    }

    /// Columns of the table: the trial's number, whether it is a design scenario, each law's area, and whether that is
    /// a lower bound.
    pub fn columns(&self) -> Vec<String> {
        let capped = self.laws.iter().map(|law| format!("{law}_capped"));
        let head = ["trial".to_owned(), "designed_with".to_owned()].into_iter();
        head.chain(self.laws.clone()).chain(capped).collect()
    }

    /// The table's rows.
    pub fn rows(&self) -> impl Iterator<Item = Vec<Option<f64>>> {
        self.trials.iter().enumerate().map(|(i, t)| {
            let head = [i as f64 + 1.0, f64::from(u8::from(t.designed_with))];
            let capped = t.area_capped.iter().map(|c| f64::from(u8::from(*c)));
            head.into_iter().chain(t.area.iter().copied()).chain(capped).map(Some).collect()
        })
    }
}

fn points(law: &Law) -> Vec<(f32, f32)> {
    let Law::Table(table) = law else { return Vec::new() };
    table.points().to_vec()
}

/// The law in the file format of `--law`.
pub fn law_file(d: &Design) -> String {
    let Tool { name, version, commit } = Tool::this();
    let source = format!(
        "{name} {version} commit {commit}: design, seed {}, {} tried from {}, least area {:.3} rad m/s^2",
        d.plan.seed,
        counted(d.found.evaluations, "schedule", "schedules"),
        d.start,
        d.found.worst_area
    );
    let (speeds, gains): (Vec<f32>, Vec<f32>) = points(d.law).into_iter().unzip();
    let source = toml::Value::from(source);
    format!("source = {source}\nspeed_m_s = {speeds:?}\ngain_nm_s_rad = {gains:?}\n")
}

/// Figure of the gains of the laws over speed, and of their areas in each trial.
pub fn figure(document: &DesignDocument, laws: &[(String, Law)]) -> Chart {
    let speeds: Vec<f64> = (0..=180).map(|i| 0.05 * f64::from(i)).collect();
    let assisting = || laws.iter().enumerate().filter(|(_, (_, law))| *law != Law::None);
    let gains = assisting().map(|(i, (name, law))| {
        let line = if i + 1 == laws.len() { Line::Solid } else { Line::Dashed };
        Series::new(name, Look::line(i, line), speeds.iter().map(|v| (*v, law.gain(*v))).collect())
    });
    let schedule = Plot {
        title: "Gain".into(),
        x: Axis::new("Forward speed v [m/s]"),
        y: Axis::new("Gain [N m s/rad]").over(-12.0, 45.0),
        series: gains.collect(),
        ..Plot::default()
    };
    let areas = laws.iter().enumerate().map(|(i, (name, _))| {
        let points = document.trials.iter().enumerate();
        let points = points.map(|(n, trial)| (n as f64 + 1.0, trial.area[i])).collect();
        Series::new(
            name,
            Look::marks(i, if i + 1 == laws.len() { Marker::Square } else { Marker::Ring }),
            points,
        )
    });
    let evaluation = Plot {
        title: "Area of the basin; right of the line: held out".into(),
        x: Axis::new("Trial"),
        y: Axis::new("Area [rad m/s²]"),
        series: areas.collect(),
        verticals: vec![document.trials.iter().filter(|t| t.designed_with).count() as f64 + 0.5],
        ..Plot::default()
    };
    let plots = if document.trials.is_empty() { vec![schedule] } else { vec![schedule, evaluation] };
    Chart { title: "A designed law beside the known ones".into(), columns: 2, plots, shaded: String::new() }
}
