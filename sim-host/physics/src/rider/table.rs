//! Tables of measured gains: one set per row, sets of similar speed in a group.

use super::{Covariance, Gains, KEYS, Line, Neuromuscular};

/// Version of the files' schema.
pub(super) const SCHEMA: u32 = 1;

/// One measured set of gains.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// Number of the experiment.
    pub run: Option<u32>,
    /// Group number: equal for sets of similar speed, increasing with speed.
    pub group: u32,
    /// Variance accounted for \[%\].
    pub vaf: Option<f64>,
    /// The gains; zero for those without a column.
    pub gains: Gains,
    /// Covariance of the gains that have a column, if known.
    pub covariance: Option<Covariance>,
}

/// A rider's measured gains and the conditions of their identification.
#[derive(Clone, Debug, PartialEq)]
pub struct RiderTable {
    /// Name, or FILE as given.
    pub name: String,
    /// Origin of the values.
    pub source: Option<String>,
    /// A remark.
    pub note: Option<String>,
    /// Name of the bicycle for which the gains are made, as for `--bicycle`, if any.
    pub bicycle: Option<String>,
    /// Effective neural delay of the identification \[s\].
    pub delay_s: f64,
    /// Neuromuscular dynamics of the identification.
    pub neuromuscular: Neuromuscular,
    /// Run of each group that counts as its best; if absent, the one with the highest VAF.
    pub best_runs: Option<Vec<u32>>,
    /// The published regression, if the rows do not reproduce it to all digits.
    pub regression: Option<Line>,
    /// Indices in [`KEYS`] of the gains that have a column.
    pub columns: Vec<usize>,
    /// The sets, in order of non-decreasing speed.
    pub rows: Vec<Row>,
}

impl RiderTable {
    /// The groups, in order of increasing speed.
    pub fn groups(&self) -> impl Iterator<Item = &[Row]> {
        self.rows.chunk_by(|a, b| a.group == b.group)
    }

    /// The table as a file, with nested loops multiplied out. Parsing it gives the same table except for its
    /// name.
    pub fn to_toml(&self) -> String {
        let text = |key, value: &Option<String>| {
            value.as_ref().map_or(String::new(), |v| format!("{key} = {}\n", toml::Value::from(v.as_str())))
        };
        let has = |is: fn(&Row) -> bool| self.rows.iter().any(is);
        let (run, vaf) = (has(|r| r.run.is_some()), has(|r| r.vaf.is_some()));
        let mut columns = vec!["speed_m_s", "group"];
        columns.extend(run.then_some("run"));
        columns.extend(vaf.then_some("vaf"));
        columns.extend(self.columns.iter().map(|&i| KEYS[i]));
        let rows = self.rows.iter().map(|r| {
            let mut cells = vec![format!("{:?}", r.speed_m_s), r.group.to_string()];
            cells.extend(run.then(|| r.run.map_or("nan".into(), |run| run.to_string())));
            cells.extend(vaf.then(|| r.vaf.map_or("nan".into(), |vaf| format!("{vaf:?}"))));
            cells.extend(self.columns.iter().map(|&i| format!("{:?}", r.gains.0[i])));
            format!("  [{}],\n", cells.join(", "))
        });
        let covariances = if has(|r| r.covariance.is_some()) {
            format!("covariances = [\n{}]\n", self.rows.iter().map(covariance_line).collect::<String>())
        } else {
            String::new()
        };
        let lines = self.regression.iter().flat_map(|line| {
            let pair = |i: &usize| (KEYS[*i], line.slope.0[*i], line.intercept.0[*i]);
            self.columns.iter().map(pair).map(|(key, a, b)| format!("{key} = [{a:?}, {b:?}]\n"))
        });
        let lines: String = lines.collect();
        format!(
            "schema = {SCHEMA}\n{}{}{}delay_ms = {:?}\nneuromuscular = {{ omega_rad_s = {:?}, zeta = {:?} }}\n{}\
             columns = {columns:?}\nrows = [\n{}]\n{covariances}{}{lines}",
            text("source", &self.source),
            text("note", &self.note),
            text("bicycle", &self.bicycle),
            self.delay_s * 1e3,
            self.neuromuscular.omega_rad_s,
            self.neuromuscular.zeta,
            self.best_runs.as_ref().map_or(String::new(), |runs| format!("best_runs = {runs:?}\n")),
            rows.collect::<String>(),
            if lines.is_empty() { "" } else { "\n[regression]\n" },
        )
    }
}

/// A row's covariance as a line of the file's `covariances`.
fn covariance_line(row: &Row) -> String {
    let rows: Vec<Vec<f64>> = row.covariance.iter().flat_map(Covariance::rows).collect();
    format!("  {rows:?},\n")
}
