//! What of the thesis is computed again, in its order.

use super::case::Case;
use super::item::Item;
use super::study::Study;
use super::{app_c, app_d, ch2, ch3_assist, ch3_laws};

/// An item of the thesis.
#[derive(Debug)]
pub struct Entry {
    /// Kind and number: "table-3.1", "figure-J.4".
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// How it comes about.
    pub made: Made,
}

/// How an item comes about.
#[derive(Debug)]
pub enum Made {
    /// Computed.
    Computed {
        /// In words, what it needs.
        needs: &'static str,
        /// The basins it needs.
        cases: fn() -> Vec<Case>,
        /// The computation.
        compute: fn(&Study) -> Item,
        /// Its own work, in columns of a basin, about.
        work: u64,
    },
    /// Can't be, and why.
    Unavailable(&'static str),
}

impl Entry {
    /// "3.1" of "table-3.1".
    pub fn number(&self) -> &'static str {
        self.name.split_once('-').map_or(self.name, |(_, number)| number)
    }

    /// "Table 3.1".
    pub fn label(&self) -> String {
        let (kind, number) = self.name.split_once('-').unwrap_or((self.name, ""));
        let first = kind.chars().next().map(|c| c.to_ascii_uppercase());
        format!("{}{} {number}", first.unwrap_or_default(), kind.get(1..).unwrap_or_default())
    }

    /// Whether `wanted` means this item: its name, its number, or its chapter or appendix.
    pub fn is(&self, wanted: &str) -> bool {
        let (wanted, number) = (wanted.to_lowercase(), self.number().to_lowercase());
        let chapter = number.split('.').next().unwrap_or_default();
        wanted == self.name.to_lowercase() || wanted == number || wanted == chapter
    }
}

fn none() -> Vec<Case> {
    Vec::new()
}

const fn linear(name: &'static str, title: &'static str, compute: fn(&Study) -> Item) -> Entry {
    Entry { name, title, made: Made::Computed { needs: "eigenvalues", cases: none, compute, work: 1 } }
}

const fn rides(name: &'static str, title: &'static str, compute: fn(&Study) -> Item, work: u64) -> Entry {
    Entry { name, title, made: Made::Computed { needs: "rides", cases: none, compute, work } }
}

const fn basins(
    name: &'static str,
    title: &'static str,
    cases: fn() -> Vec<Case>,
    compute: fn(&Study) -> Item,
) -> Entry {
    Entry { name, title, made: Made::Computed { needs: "basins", cases, compute, work: 2 } }
}

const RIDERS: Made = Made::Unavailable("needs the riders, which are not there yet");
const MEASURED: Made =
    Made::Unavailable("needs the measured roll rates of the experiments, which are not published");

/// Every item, in the thesis's order.
pub const CATALOGUE: &[Entry] = &[
    linear("figure-2.2", "Eigenvalues of the uncontrolled bicycle", ch2::figure_2_2),
    rides("figure-2.3", "Modes of the nonlinear bicycle", ch2::figure_2_3, 6),
    linear("figure-2.7", "The intuitive controller on the benchmark bicycle", ch2::figure_2_7),
    Entry { name: "figure-3.1", title: "Gains of the young cyclist over speed", made: RIDERS },
    Entry { name: "table-3.1", title: "Basins of the young cyclist", made: RIDERS },
    Entry { name: "figure-3.2", title: "Basins of the young cyclist", made: RIDERS },
    Entry { name: "table-3.2", title: "Basins of the old cyclists", made: RIDERS },
    Entry { name: "figure-3.3", title: "Gains of the smart, old cyclist over speed", made: RIDERS },
    Entry { name: "figure-3.4", title: "Basins of the old cyclists", made: RIDERS },
    Entry { name: "table-3.3", title: "Decline of the basins with delay", made: RIDERS },
    Entry { name: "figure-3.5", title: "Basins of the three cyclists", made: RIDERS },
    linear("section-3.4", "Weave speeds under the laws", ch3_laws::section_3_4),
    linear("figure-3.6", "Eigenvalues and gain of CL1", ch3_laws::figure_3_6),
    basins("figure-3.7", "Basin of CL1", ch3_assist::cases_3_7, ch3_assist::figure_3_7),
    rides("figure-3.8", "Rides under CL1 around its weave speed", ch3_assist::figure_3_8, 1),
    linear("figure-3.9", "Eigenvalues and gains of CL2", ch3_laws::figure_3_9),
    basins("figure-3.10", "Basins of CL2", ch3_assist::cases_3_10, ch3_assist::figure_3_10),
    linear("figure-3.11", "Gains of f, g and h", ch3_laws::figure_3_11),
    linear("figure-3.12", "Eigenvalues under f, g and h", ch3_laws::figure_3_12),
    basins("figure-3.13", "Basins of f, g and h", ch3_assist::cases_3_13, ch3_assist::figure_3_13),
    rides("figure-3.14", "Rides under f and h from 7.221 m/s", ch3_assist::figure_3_14, 1),
    Entry { name: "figure-3.15", title: "Basin of the smart, old cyclist aided by h", made: RIDERS },
    rides("figure-C.1", "Eigenvalues fitted to the roll rate", app_c::figure_c_1, 8),
    rides("figure-C.2", "Eigenvalues fitted to the steer rate", app_c::figure_c_2, 8),
    rides("figure-C.3", "Eigenvalues fitted within bounds, and by matrix pencil", app_c::figure_c_3, 12),
    rides("figure-D.1", "The rides of the convergence study", app_d::figure_d_1, 2),
    rides("figure-D.2", "Errors of fixed steps", app_d::figure_d_2, 40),
    rides("figure-D.3", "Errors of adaptive solvers", app_d::figure_d_3, 20),
    Entry { name: "table-F.1", title: "Fit of the young cyclist's gains", made: RIDERS },
    Entry { name: "equation-F.2", title: "Regression of the young cyclist's gains", made: RIDERS },
    Entry { name: "table-G.2", title: "Fit of the smart cyclist's gains", made: RIDERS },
    Entry { name: "equation-G.2", title: "Regression of the smart cyclist's gains", made: RIDERS },
    Entry { name: "figure-H.1", title: "Six and seven gains over speed", made: RIDERS },
    Entry { name: "table-H.1", title: "Fit of the six gains", made: RIDERS },
    Entry { name: "equation-H.1", title: "Regression of the six gains", made: RIDERS },
    Entry { name: "figure-H.2", title: "The six gains over speed", made: RIDERS },
    Entry { name: "table-H.2", title: "Basins of the smart cyclist with six gains", made: RIDERS },
    Entry { name: "figure-H.3", title: "Basins with six and with seven gains", made: RIDERS },
    Entry { name: "table-H.3", title: "Change of the basins from seven to six gains", made: RIDERS },
    Entry { name: "table-I.1", title: "Heights of the young cyclist's reduced gain sets", made: RIDERS },
    Entry { name: "table-I.2", title: "Heights of the old cyclist's reduced gain sets", made: RIDERS },
    Entry { name: "figure-I.1", title: "Heights of the reduced gain sets", made: RIDERS },
    Entry { name: "figure-I.2", title: "Measured and modelled roll rate, run 184", made: MEASURED },
    Entry { name: "figure-I.3", title: "Measured and modelled roll rate, run 248", made: MEASURED },
    Entry { name: "figure-I.4", title: "Measured and modelled roll rate, run 248", made: MEASURED },
    Entry { name: "figure-I.5", title: "Measured and modelled roll rate, run 252", made: MEASURED },
    Entry { name: "figure-I.6", title: "Measured and modelled roll rate, run 256", made: MEASURED },
    Entry { name: "figure-J.1", title: "Variance accounted for by two reduced sets", made: RIDERS },
    Entry { name: "equation-J.5", title: "Regression of the undelayed rider's gains", made: RIDERS },
    Entry { name: "figure-J.2", title: "The undelayed rider's gains over speed", made: RIDERS },
    Entry { name: "table-J.4", title: "Critical speeds of the undelayed rider", made: RIDERS },
    Entry { name: "figure-J.3", title: "Eigenvalues of the undelayed rider", made: RIDERS },
    Entry { name: "figure-J.4", title: "Basins of the undelayed rider", made: RIDERS },
    Entry { name: "figure-J.5", title: "Basins with a delay the gains do not know of", made: RIDERS },
    Entry { name: "table-K.1", title: "Gains at 4.3 m/s", made: RIDERS },
    Entry { name: "figure-K.1", title: "Gains and torques at 4.3 m/s", made: RIDERS },
    Entry { name: "figure-K.2", title: "Which gain makes the regression unstable", made: RIDERS },
    Entry { name: "figure-K.3", title: "Sensitivity at 4.3 m/s", made: RIDERS },
    Entry { name: "figure-K.4", title: "Sensitivity at 2.2 m/s", made: RIDERS },
    Entry { name: "figure-K.5", title: "Sensitivity at 3.2 m/s", made: RIDERS },
    Entry { name: "figure-K.6", title: "Sensitivity at 4.3 m/s", made: RIDERS },
    Entry { name: "figure-K.7", title: "Sensitivity at 6.0 m/s", made: RIDERS },
    Entry { name: "figure-K.8", title: "Sensitivity at 7.3 m/s", made: RIDERS },
];

/// No such item.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no item `{wanted}`; items are {}, or their numbers, or a chapter or appendix alone", known())]
pub struct UnknownItem {
    /// As given.
    wanted: String,
}

fn known() -> String {
    CATALOGUE.iter().map(|e| e.name).collect::<Vec<_>>().join(", ")
}

/// The items that any of `wanted` means; all if it is empty.
///
/// # Errors
/// Names what no item is.
pub fn selected(wanted: &[String]) -> Result<Vec<&'static Entry>, UnknownItem> {
    if let Some(wanted) = wanted.iter().find(|w| !CATALOGUE.iter().any(|e| e.is(w))) {
        return Err(UnknownItem { wanted: wanted.clone() });
    }
    let meant = |e: &&Entry| wanted.is_empty() || wanted.iter().any(|w| e.is(w));
    Ok(CATALOGUE.iter().filter(meant).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_go_by_name_number_and_chapter() {
        let names =
            |wanted: &str| selected(&[wanted.into()]).map(|es| es.iter().map(|e| e.name).collect::<Vec<_>>());
        assert_eq!(names("figure-3.6"), Ok(vec!["figure-3.6"]));
        assert_eq!(names("3.14"), Ok(vec!["figure-3.14"]));
        assert_eq!(names("c"), Ok(vec!["figure-C.1", "figure-C.2", "figure-C.3"]));
        let refused = names("9.9").unwrap_err().to_string();
        assert!(refused.contains("`9.9`") && refused.contains("figure-2.2"), "{refused}");
        assert_eq!(selected(&[]).unwrap().len(), CATALOGUE.len());
        assert_eq!(CATALOGUE[0].label(), "Figure 2.2");
    }

    #[test]
    fn names_are_single() {
        for (i, e) in CATALOGUE.iter().enumerate() {
            assert!(CATALOGUE[..i].iter().all(|other| other.name != e.name), "{}", e.name);
        }
    }
}
