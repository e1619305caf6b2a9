//! What an item of the thesis consists of when it has been computed again.

use super::published::{self, Bound, Cell};
use crate::report::figure::Picture;

/// Differences up to this need no explanation \[%\].
pub const ACCEPTED_PERCENT: f64 = 2.0;

/// One table, figure or equation, computed again.
#[derive(Debug, Default)]
pub struct Item {
    /// Numbers beside the printed ones.
    pub values: Vec<Value>,
    /// Tables of what the thesis does not print.
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
    /// Below it.
    pub caption: String,
    /// The figure.
    pub picture: Picture,
    /// The data as a CSV table.
    pub csv: String,
}

/// A table of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Above it.
    pub title: String,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<String>>,
}

/// A number beside the printed one.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Row, column, unit and the printed number.
    pub cell: Cell,
    /// Computed as exactly as the settings allow; `None` if there is no such number.
    pub exact: Option<f64>,
    /// Computed on the grid of disturbances the thesis probably used.
    pub coarse: Option<f64>,
    /// What grid that is.
    pub grid: &'static str,
    /// What else could be meant, computed.
    pub experiments: Vec<Experiment>,
    /// Whether it comes from a basin with a height that is a lower bound.
    pub capped: bool,
}

/// A number under another reading of the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// What is different.
    pub name: String,
    /// The number then.
    pub value: f64,
}

/// What a difference from the print comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Explanation {
    /// Nothing is printed, or nothing computed, or the difference is small: within [`ACCEPTED_PERCENT`],
    /// the rounding of the print, or the bound that is printed.
    NotNeeded,
    /// The printed grid or an experiment comes within [`ACCEPTED_PERCENT`]; its name.
    Explained(String),
    /// None does; the one that comes closest and which part of the difference it explains \[%\].
    Unexplained(Option<(String, f64)>),
}

/// The name of the usual coarse grid among the explanations.
pub const COARSE: &str = "disturbances in steps of 0.5 rad/s, last before the first fall";

impl Value {
    /// A number without coarse grid or experiments.
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

    /// The same with the number on the coarse grid.
    pub fn on_grid(self, coarse: Option<f64>) -> Self {
        Self { coarse, ..self }
    }

    /// The same with the number on another grid, which is named.
    pub fn on_grid_of(self, coarse: Option<f64>, grid: &'static str) -> Self {
        Self { coarse, grid, ..self }
    }

    /// The same with an experiment.
    pub fn tried(mut self, name: &str, value: f64) -> Self {
        self.experiments.push(Experiment { name: name.into(), value });
        self
    }

    /// How far the exact number is from the printed one \[%\] of it; `None` without both, and where
    /// the printed one is zero but the exact one is not.
    pub fn difference(&self) -> Option<f64> {
        percent(self.exact?, self.cell.printed?.value)
    }

    /// Where the difference comes from.
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
    /// What `value` makes of every printed cell of `item`.
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
