//! A rider of the thesis, as a small hashable key.

use super::published::{cells, published};
use crate::rider::catalogue::load;
use crate::rider::{Fit, Gains, KEYS, Outside, Rider, RiderTable, Row, Schedule};

/// A built-in rider, the fit of its gains over speed, and its neural delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cyclist {
    /// Name of the built-in table.
    pub table: &'static str,
    /// The fit of the gains over speed.
    pub fit: Fit,
    /// The neural delay \[ms\].
    pub delay_ms: u16,
    /// Which print of the gains is used.
    pub print: Print,
}

/// Contradicting prints of the gains in the thesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Print {
    /// As settled in `docs/riders.md`.
    Settled,
    /// The regression by least squares over the printed sets instead of the printed lines.
    LeastSquares,
    /// The best sets by the VAFs as printed.
    HighestVaf,
    /// The smart cyclist with run 249, by Table G.4.
    Run249ByG4,
    /// The smart cyclist with run 249, by Table H.4.
    Run249ByH4,
    /// Run 191 at 6.0 m/s, as in Table G.4.
    Run191,
    /// Eq. H.1 with its intercept of the steer rate as printed.
    EquationH1,
}

impl Cyclist {
    const fn new(table: &'static str, fit: Fit, delay_ms: u16) -> Self {
        Self { table, fit, delay_ms, print: Print::Settled }
    }

    /// The young cyclist.
    pub const fn young(fit: Fit) -> Self {
        Self::new("young", fit, 30)
    }

    /// The naive, old cyclist: the young one's gains with the old one's delay.
    pub const fn naive(fit: Fit) -> Self {
        Self::new("young", fit, 60)
    }

    /// The smart, old cyclist.
    pub const fn smart(fit: Fit) -> Self {
        Self::new("smart", fit, 60)
    }

    /// The smart, old cyclist with six gains.
    pub const fn six(fit: Fit) -> Self {
        Self::new("smart6", fit, 60)
    }

    /// The cyclist of appendix J, whose gains were identified without delay.
    pub const fn undelayed(fit: Fit, delay_ms: u16) -> Self {
        Self::new("undelayed", fit, delay_ms)
    }

    /// The same rider with another print of its gains.
    pub const fn by(self, print: Print) -> Self {
        Self { print, ..self }
    }

    /// The measured gains.
    pub fn table(&self) -> RiderTable {
        let shipped = load(self.table).unwrap_or_else(|e| panic!("{e}"));
        let rows = shipped.rows.clone();
        match self.print {
            Print::Settled => shipped,
            Print::LeastSquares => RiderTable { regression: None, ..shipped },
            Print::HighestVaf => RiderTable { best_runs: None, ..shipped },
            Print::Run249ByG4 => with_run_249(shipped, &published().run_249.table_g_4),
            Print::Run249ByH4 => with_run_249(shipped, &published().run_249.table_h_4),
            Print::Run191 => {
                let at = |r: Row| if r.run == Some(191) { Row { speed_m_s: 6.0, ..r } } else { r };
                RiderTable { rows: rows.into_iter().map(at).collect(), regression: None, ..shipped }
            }
            Print::EquationH1 => {
                let mut regression = shipped.regression;
                for cell in cells("equation-H.1").iter().filter(|c| c.column == "at 0 m/s") {
                    let key = KEYS.iter().position(|k| *k == cell.row);
                    if let (Some(line), Some(i), Some(printed)) = (&mut regression, key, cell.printed) {
                        line.intercept.0[i] = printed.value;
                    }
                }
                RiderTable { regression, ..shipped }
            }
        }
    }

    /// The gains over speed.
    pub fn schedule(&self) -> Schedule {
        self.rider().schedule
    }

    /// The rider.
    pub fn rider(&self) -> Rider {
        let rider = self.table().rider(self.fit, Outside::Extrapolate, Some(f64::from(self.delay_ms) * 1e-3));
        rider.unwrap_or_else(|e| panic!("data/riders/{}.toml: {e}", self.table))
    }
}

fn with_run_249(shipped: RiderTable, printed: &[f64; 8]) -> RiderTable {
    let of = &published().run_249;
    let gains = Gains::of_states(printed);
    let row =
        Row { speed_m_s: of.speed, run: Some(249), group: 1, vaf: Some(of.vaf), gains, covariance: None };
    let mut rows = shipped.rows;
    let at = rows.partition_point(|r| r.speed_m_s < row.speed_m_s);
    rows.insert(at, row);
    RiderTable { rows, regression: None, ..shipped }
}

/// The thesis's name of a fit.
pub fn fit_name(fit: Fit) -> &'static str {
    match fit {
        Fit::Regression => "LR",
        Fit::Mean => "LI mean",
        Fit::Best => "LI highest VAF",
        Fit::Spline => "smoothing spline",
    }
}

/// The fit of a name in the thesis.
pub fn fit_named(name: &str) -> Option<Fit> {
    Fit::THESIS.into_iter().find(|&fit| fit_name(fit) == name)
}

/// A rider by the name of a row in `data/thesis.toml`: "young LR", "six LI mean".
pub fn named(row: &str) -> Option<Cyclist> {
    let (who, fit) = row.split_once(' ')?;
    let fit = fit_named(fit)?;
    match who {
        "young" => Some(Cyclist::young(fit)),
        "naive" => Some(Cyclist::naive(fit)),
        "smart" => Some(Cyclist::smart(fit)),
        "six" => Some(Cyclist::six(fit)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_print_makes_a_rider() {
        let prints = [Print::Settled, Print::LeastSquares, Print::Run249ByG4, Print::Run191];
        for who in [Cyclist::young, Cyclist::naive, Cyclist::smart, Cyclist::six] {
            for fit in Fit::THESIS {
                for print in prints {
                    assert!(who(fit).by(print).rider().check(1e-3).is_ok(), "{fit:?} {print:?}");
                }
            }
        }
        assert_eq!(named("six LI mean"), Some(Cyclist::six(Fit::Mean)));
        assert_eq!(named("young, mean of the three"), None);
    }

    #[test]
    fn run_249_is_the_best_of_its_group() {
        let at = |print| Cyclist::smart(Fit::Best).by(print).schedule().points()[0].1;
        assert_eq!(at(Print::Run249ByG4).get("K_phi_d"), Some(2.98));
        assert_eq!(at(Print::Settled).get("K_phi_d"), Some(10.34));
        let line = |print| Cyclist::six(Fit::Regression).by(print).schedule().at(0.0).get("K_delta_d");
        assert!((line(Print::EquationH1).unwrap() + 0.06181).abs() < 1e-9);
        assert!((line(Print::Settled).unwrap() + 0.6181).abs() < 1e-9);
    }
}
