//! Parses riders' files: TOML with `columns` and `rows` (`docs/riders.md`).

use super::table::{RiderTable, Row, SCHEMA};
use super::{
    Covariance, CovarianceError, Fit, Gains, KEYS, Line, MAX_DELAY_S, Neuromuscular, Outside, RiderError,
    RowError, TableError,
};
use crate::range::within;
use nalgebra::DMatrix;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::path::Path;

/// Columns that are not gains.
const ROW_KEYS: [&str; 4] = ["speed_m_s", "run", "group", "vaf"];
/// Gains of nested loops, innermost first.
const NESTED_KEYS: [&str; 5] = ["k_delta", "k_phidot", "k_phi", "k_psi", "k_y"];
/// Gains that result from nested loops, as indices of [`KEYS`].
const NESTED_GAINS: [usize; 5] = [4, 2, 0, 8, 9];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    schema: u32,
    source: Option<String>,
    note: Option<String>,
    bicycle: Option<String>,
    delay_ms: f64,
    neuromuscular: Option<NeuromuscularFile>,
    #[serde(default)]
    feedback: Feedback,
    best_runs: Option<Vec<u32>>,
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
    /// For each row, the covariance of its gains in the order of their columns, or an empty list.
    covariances: Option<Vec<Vec<Vec<f64>>>>,
    /// For each gain, its slope per m/s and its value at zero speed.
    regression: Option<BTreeMap<String, [f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NeuromuscularFile {
    omega_rad_s: f64,
    zeta: f64,
}

/// Signals that the columns of gains multiply.
#[derive(Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Feedback {
    /// Each gain multiplies its own signal.
    #[default]
    States,
    /// Each gain multiplies the error of the loop inside it.
    Nested,
}

/// State gains of `U = k_delta (k_phidot (k_phi (k_psi (-k_y y - psi) - phi) - phi') - delta)`, with all
/// commands zero.
fn multiplied_out([k_delta, k_phidot, k_phi, k_psi, k_y]: [f64; 5]) -> [f64; 5] {
    let roll_rate = -k_delta * k_phidot;
    let roll = roll_rate * k_phi;
    let heading = roll * k_psi;
    [-k_delta, roll_rate, roll, heading, heading * k_y]
}

impl Serialize for RiderTable {
    /// The content of the table's file, with its name.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut content: toml::Table = self.to_toml().parse().map_err(serde::ser::Error::custom)?;
        content.insert(NAME.into(), self.name.as_str().into());
        content.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for RiderTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut content = toml::Table::deserialize(deserializer)?;
        let name = content.remove(NAME);
        let name = name.as_ref().and_then(toml::Value::as_str).unwrap_or("in the scenario");
        File::deserialize(content).map_err(D::Error::custom)?.table(name).map_err(D::Error::custom)
    }
}

/// Key of a table's name where its content stands in a scenario.
const NAME: &str = "name";

impl RiderTable {
    /// Parses a table from a file's text.
    ///
    /// # Errors
    /// States file, key, row, value and allowed range.
    pub fn from_text(name: &str, text: &str, path: &Path) -> Result<Self, RiderError> {
        let file: File = toml::from_str(text)
            .map_err(|e| RiderError::Syntax { path: path.into(), reason: e.to_string().trim().into() })?;
        file.table(name).map_err(|reason| RiderError::Table { path: path.into(), reason })
    }

    /// Checks `best_runs` against the rows.
    fn check_best(&self) -> Result<(), TableError> {
        let Some(best) = &self.best_runs else { return Ok(()) };
        if let Some(run) = best.iter().find(|b| !self.rows.iter().any(|r| r.run == Some(**b))) {
            return Err(TableError::BestRun(*run));
        }
        for group in self.groups() {
            let n = group.iter().filter(|r| r.run.is_some_and(|run| best.contains(&run))).count();
            if n != 1 {
                return Err(TableError::BestRuns { rows: n, speed_m_s: group[0].speed_m_s });
            }
        }
        Ok(())
    }
}

impl File {
    fn table(self, name: &str) -> Result<RiderTable, TableError> {
        if self.schema != SCHEMA {
            return Err(TableError::Schema(self.schema));
        }
        within("`delay_ms`", self.delay_ms, 0.0, MAX_DELAY_S * 1e3)?;
        let neuromuscular = self
            .neuromuscular
            .as_ref()
            .map_or(Neuromuscular::SHOULDERS, |m| Neuromuscular { omega_rad_s: m.omega_rad_s, zeta: m.zeta });
        neuromuscular.check().map_err(TableError::Neuromuscular)?;
        let columns = self.gain_columns()?;
        within("number of `rows`", self.rows.len() as f64, 1.0, 1000.0)?;
        let covariances = self.checked_covariances()?;
        let mut rows: Vec<Row> = Vec::new();
        for (i, cells) in self.rows.iter().enumerate() {
            let wrong = |error| TableError::Row { row: i + 1, error };
            let covariance = match &covariances {
                Some(all) => self.covariance(&all[i], &columns).map_err(|e| wrong(e.into()))?,
                None => None,
            };
            rows.push(Row { covariance, ..self.row(cells, rows.last()).map_err(wrong)? });
        }
        let regression = self.line(&columns)?;
        let table = RiderTable {
            name: name.into(),
            source: self.source,
            note: self.note,
            bicycle: self.bicycle,
            delay_s: self.delay_ms / 1e3,
            neuromuscular,
            regression,
            best_runs: self.best_runs,
            columns,
            rows,
        };
        table.check_best()?;
        table.schedule(Fit::Mean, Outside::default()).map_err(TableError::Means)?;
        Ok(table)
    }

    /// Indices of the gains that have a column; checks the columns.
    fn gain_columns(&self) -> Result<Vec<usize>, TableError> {
        let keys = self.gain_keys();
        for (i, column) in self.columns.iter().enumerate() {
            let column = column.as_str();
            if !ROW_KEYS.contains(&column) && !keys.contains(&column) {
                let known = [&ROW_KEYS, keys].concat().join(", ");
                return Err(TableError::UnknownColumn { column: column.into(), known });
            }
            if self.columns[..i].iter().any(|c| c == column) {
                return Err(TableError::RepeatedColumn(column.into()));
            }
        }
        let has = |key: &str| self.columns.iter().any(|c| c == key);
        if !has("speed_m_s") {
            return Err(TableError::NoSpeed);
        }
        let present = (0..keys.len()).filter(|&i| has(keys[i]));
        let mut gains: Vec<usize> = match self.feedback {
            Feedback::States => present.collect(),
            Feedback::Nested => present.map(|i| NESTED_GAINS[i]).collect(),
        };
        gains.sort_unstable();
        if gains.is_empty() {
            return Err(TableError::NoGains { known: keys.join(", ") });
        }
        Ok(gains)
    }

    /// The published regression from the file: one line for each gain that has a column, and no others.
    fn line(&self, columns: &[usize]) -> Result<Option<Line>, TableError> {
        let Some(lines) = &self.regression else { return Ok(None) };
        let gains: Vec<&str> = columns.iter().map(|&i| KEYS[i]).collect();
        if let Some(key) = lines.keys().find(|key| !gains.contains(&key.as_str())) {
            return Err(TableError::RegressionKey { key: key.clone(), gains: gains.join(", ") });
        }
        let mut line = Line { slope: Gains::default(), intercept: Gains::default() };
        for &i in columns {
            let [slope, rest] = lines.get(KEYS[i]).ok_or(TableError::RegressionMissing(KEYS[i]))?;
            within(&format!("`regression`: slope of `{}`", KEYS[i]), *slope, -1e5, 1e5)?;
            within(&format!("`regression`: `{}` at rest", KEYS[i]), *rest, -1e5, 1e5)?;
            (line.slope.0[i], line.intercept.0[i]) = (*slope, *rest);
        }
        Ok(Some(line))
    }

    /// `covariances`, one for each row, if given.
    fn checked_covariances(&self) -> Result<Option<&[Vec<Vec<f64>>]>, TableError> {
        let Some(all) = &self.covariances else { return Ok(None) };
        if self.feedback == Feedback::Nested {
            return Err(TableError::NestedCovariances);
        }
        if all.len() != self.rows.len() {
            return Err(TableError::Covariances { matrices: all.len(), rows: self.rows.len() });
        }
        Ok(Some(all))
    }

    /// A row's covariance in the order of `columns`, from lists in the order of the file's columns; none from an
    /// empty list.
    fn covariance(
        &self,
        lists: &[Vec<f64>],
        columns: &[usize],
    ) -> Result<Option<Covariance>, CovarianceError> {
        if lists.is_empty() {
            return Ok(None);
        }
        let gains = columns.len();
        if let Some(list) = lists.iter().find(|list| lists.len() != gains || list.len() != gains) {
            return Err(CovarianceError::Shape { gains, rows: lists.len(), columns: list.len() });
        }
        let listed: Vec<&String> = self.columns.iter().filter(|c| KEYS.contains(&c.as_str())).collect();
        let place = |i: usize| listed.iter().position(|c| *c == KEYS[columns[i]]).unwrap_or(i);
        let matrix = DMatrix::from_fn(gains, gains, |i, j| lists[place(i)][place(j)]);
        Covariance::new(&matrix, columns).map(Some)
    }

    fn gain_keys(&self) -> &'static [&'static str] {
        match self.feedback {
            Feedback::States => &KEYS,
            Feedback::Nested => &NESTED_KEYS,
        }
    }

    fn row(&self, cells: &[f64], before: Option<&Row>) -> Result<Row, RowError> {
        let (n, m) = (cells.len(), self.columns.len());
        if n != m {
            return Err(RowError::Length { values: n, columns: m, names: self.columns.join(", ") });
        }
        let cell = |key: &str| self.columns.iter().position(|c| c == key).map(|i| cells[i]);
        let whole = |key: &str, max: f64| match cell(key) {
            None => Ok(None),
            Some(x) if x.is_nan() && key == "run" => Ok(None),
            Some(x) => {
                within(&format!("`{key}`"), x, 1.0, max)?;
                if x.fract() != 0.0 {
                    return Err(RowError::NotWhole { key: key.into(), value: x });
                }
                Ok(Some(x as u32))
            }
        };
        let speed_m_s = cell("speed_m_s").unwrap_or_default();
        within("`speed_m_s`", speed_m_s, 0.0, 30.0)?;
        if let Some(before) = before.filter(|b| b.speed_m_s > speed_m_s) {
            return Err(RowError::Speed { speed_m_s, before_m_s: before.speed_m_s });
        }
        let same = before.is_some_and(|b| b.speed_m_s == speed_m_s);
        let last = before.map_or(0, |b| b.group);
        let group = whole("group", 1e6)?.unwrap_or(if same { last } else { last + 1 });
        if group < last {
            return Err(RowError::Group { group, before: last });
        }
        let run = whole("run", 1e9)?;
        let vaf = cell("vaf").filter(|x| !x.is_nan());
        if let Some(vaf) = vaf {
            within("`vaf`", vaf, -1000.0, 100.0)?;
        }
        let mut gains = [0.0; KEYS.len()];
        let keys = self.gain_keys();
        let mut read = Vec::new();
        for key in keys {
            let gain = cell(key).unwrap_or(0.0);
            within(&format!("`{key}`"), gain, -1e5, 1e5)?;
            read.push(gain);
        }
        match self.feedback {
            Feedback::States => gains.copy_from_slice(&read),
            Feedback::Nested => {
                let nested = multiplied_out([read[0], read[1], read[2], read[3], read[4]]);
                for (i, gain) in NESTED_GAINS.into_iter().zip(nested) {
                    within(&format!("{} of the nested gains", KEYS[i]), gain, -1e5, 1e5)?;
                    // Plus zero, so that an omitted loop gives no -0.
                    gains[i] = gain + 0.0;
                }
            }
        }
        Ok(Row { speed_m_s, run, group, vaf, gains: Gains(gains), covariance: None })
    }
}
