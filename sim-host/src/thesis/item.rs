//! The content of a reproduced item of the thesis.

use super::published::{self, Bound, Cell};
use crate::report::figure::Picture;

/// Differences up to this need no explanation \[%\].
pub const ACCEPTED_PERCENT: f64 = 2.0;

/// One reproduced table, figure or equation.
#[derive(Debug, Default)]
pub struct Item {
    /// Computed numbers beside the printed ones.
    pub values: Vec<Value>,
    /// Tables of numbers that the thesis does not print.
    pub tables: Vec<Table>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// Remarks for the reader.
    pub notes: Vec<String>,
}

/// A figure and its data.
#[derive(Debug)]
pub struct Figure {
    /// Name of its files.
    pub name: String,
    /// The caption.
    pub caption: String,
    /// The figure.
    pub picture: Picture,
    /// The data as a CSV table.
    pub csv: String,
}

/// A table of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The title.
    pub title: String,
    /// Headings of the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<String>>,
}

/// A computed number beside the printed one.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Row, column, unit and the printed number.
    pub cell: Cell,
    /// Computed as exactly as the settings allow; `None` if there is no such number.
    pub exact: Option<f64>,
    /// Computed on the grid of disturbances the thesis probably used.
    pub coarse: Option<f64>,
    /// The name of that grid.
    pub grid: &'static str,
    /// Results under other readings of the thesis.
    pub experiments: Vec<Experiment>,
    /// Whether it derives from a basin with a height that is a lower bound.
    pub capped: bool,
}

/// A number under another reading of the thesis.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The difference in the reading.
    pub name: String,
    /// The resulting number.
    pub value: f64,
}

/// Explanation of a difference from the print.
#[derive(Clone, Debug, PartialEq)]
pub enum Explanation {
    /// No number is printed or none computed, or the difference is within [`ACCEPTED_PERCENT`], the rounding of the
    /// print or the printed bound.
    NotNeeded,
    /// The coarse grid or an experiment is within [`ACCEPTED_PERCENT`]; its name.
    Explained(String),
    /// No experiment is; the closest one and the fraction of the difference that it explains \[%\].
    Unexplained(Option<(String, f64)>),
}

/// The name of the usual coarse grid in explanations.
pub const COARSE: &str = "disturbances in steps of 0.5 rad/s, last before the first fall";

impl Value {
    /// A number without coarse grid and experiments.
    pub fn new(cell: Cell, exact: Option<f64>) -> Self {
        Self {
            cell,
            exact: exact.filter(|x| x.is_finite()),
            coarse: None,
            grid: COARSE,
            experiments: Vec::new(),
            capped: false,
        }
    }

    /// The value with the number on the coarse grid.
    pub fn on_grid(self, coarse: Option<f64>) -> Self {
        Self { coarse, ..self }
    }

    /// The value with the number on another, named grid.
    pub fn on_grid_of(self, coarse: Option<f64>, grid: &'static str) -> Self {
        Self { coarse, grid, ..self }
    }

    /// The value with an experiment.
    pub fn tried(mut self, name: &str, value: f64) -> Self {
        self.experiments.push(Experiment { name: name.into(), value });
        self
    }

    /// Difference of the exact number from the printed one \[% of the latter\]; `None` if one is missing, or the
    /// printed one is zero and the exact one is not.
    pub fn difference(&self) -> Option<f64> {
        percent(self.exact?, self.cell.printed?.value)
    }

    /// The explanation of the difference.
    pub fn explanation(&self) -> Explanation {
        let (Some(exact), Some(printed)) = (self.exact, self.cell.printed) else {
            return Explanation::NotNeeded;
        };
        let close = |x: f64| {
            let rounded = (x - printed.value).abs() <= printed.rounding * (1.0 + 1e-9);
            let bounded = match self.cell.bound {
                Some(Bound::Above) => x >= printed.value,
                Some(Bound::Below) => x <= printed.value,
                None => false,
            };
            rounded || bounded || percent(x, printed.value).is_some_and(|d| d.abs() <= ACCEPTED_PERCENT)
        };
        let printed = printed.value;
        if close(exact) {
            return Explanation::NotNeeded;
        }
        let coarse = self.coarse.map(|value| Experiment { name: self.grid.into(), value });
        let all = || coarse.iter().chain(&self.experiments);
        if let Some(found) = all().find(|e| close(e.value)) {
            return Explanation::Explained(found.name.clone());
        }
        let left = |e: &&Experiment| (e.value - printed).abs();
        let best =
            all().min_by(|a, b| left(a).total_cmp(&left(b))).filter(|e| left(e) < (exact - printed).abs());
        Explanation::Unexplained(
            best.map(|e| (e.name.clone(), 100.0 * (1.0 - left(&e) / (exact - printed).abs()))),
        )
    }
}

fn percent(x: f64, printed: f64) -> Option<f64> {
    if x == printed {
        return Some(0.0);
    }
    (printed != 0.0).then(|| 100.0 * (x - printed) / printed.abs())
}

impl Item {
    /// Applies `value` to every printed cell of `item`.
    pub fn compare(item: &str, value: impl FnMut(Cell) -> Value) -> Vec<Value> {
        published::cells(item).into_iter().map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::published::Printed;

    fn value(printed: Option<&str>, exact: f64) -> Value {
        let text = String::new;
        let printed = printed.map(|p| Printed::parse(p).unwrap());
        let cell = Cell { row: text(), column: text(), unit: text(), from: text(), printed, bound: None };
        Value::new(cell, Some(exact))
    }

    #[test]
    fn a_difference_is_explained_by_what_comes_close() {
        assert_eq!(value(None, 5.0).explanation(), Explanation::NotNeeded);
        assert_eq!(value(Some("5.0"), 5.05).explanation(), Explanation::NotNeeded);
        assert_eq!(value(Some("5"), 5.4).explanation(), Explanation::NotNeeded);
        let mut above = value(Some("5.0"), 6.0);
        assert_eq!(above.explanation(), Explanation::Unexplained(None));
        above.cell.bound = Some(Bound::Above);
        assert_eq!(above.explanation(), Explanation::NotNeeded);
        let far = value(Some("5.0"), 6.0).tried("half", 5.5).tried("worse", 7.0);
        let Explanation::Unexplained(Some((name, part))) = far.explanation() else { panic!("{far:?}") };
        assert_eq!((name.as_str(), part.round()), ("half", 50.0));
        let near = far.on_grid(Some(5.01));
        assert_eq!(near.explanation(), Explanation::Explained(COARSE.into()));
        assert_eq!(value(Some("0.0"), 1.0).difference(), None);
        assert_eq!(value(Some("0.0"), 0.0).difference(), Some(0.0));
    }
}
