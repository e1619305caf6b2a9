//! The items of the thesis that are reproduced, in its order.

#[cfg(feature = "solvers")]
use super::app_d;
use super::case::Case;
use super::item::Item;
use super::study::Study;
use super::{
    app_c, app_h, app_i, app_j, app_k, ch2, ch3_assist, ch3_laws, ch3_riders, fits, reductions, sensitivity,
};

/// An item of the thesis.
#[derive(Debug)]
pub struct Entry {
    /// Kind and number: "table-3.1", "figure-J.4".
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// How it is reproduced.
    pub made: Made,
}

/// How an item is reproduced.
#[derive(Debug)]
pub enum Made {
    /// Computed.
    Computed {
        /// Its requirements, as text.
        needs: &'static str,
        /// The basins it needs.
        cases: fn() -> Vec<Case>,
        /// The computation.
        compute: fn(&Study) -> Item,
        /// Its work beyond the basins, approximately, in columns of a basin.
        work: u64,
    },
    /// It cannot be computed; the reason.
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

    /// Whether `wanted` selects this item: by its name, its number, or its chapter or appendix.
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

const fn gains(name: &'static str, title: &'static str, compute: fn(&Study) -> Item) -> Entry {
    Entry { name, title, made: Made::Computed { needs: "gains", cases: none, compute, work: 1 } }
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

#[cfg(not(feature = "solvers"))]
const SOLVERS: Made = Made::Unavailable("needs adaptive solvers: build sim-host with `--features full`");

const MEASURED: Made =
    Made::Unavailable("needs the measured roll rates of the experiments, which are not published");

/// Every item, in the thesis's order.
pub const CATALOGUE: &[Entry] = &[
    linear("figure-2.2", "Eigenvalues of the uncontrolled bicycle", ch2::figure_2_2),
    rides("figure-2.3", "Modes of the nonlinear bicycle", ch2::figure_2_3, 6),
    linear("figure-2.7", "The intuitive controller on the benchmark bicycle", ch2::figure_2_7),
    gains("figure-3.1", "Gains of the young cyclist over speed", fits::figure_3_1),
    basins("table-3.1", "Basins of the young cyclist", ch3_riders::cases_3_1, ch3_riders::table_3_1),
    basins("figure-3.2", "Basins of the young cyclist", ch3_riders::cases_figure_3_2, ch3_riders::figure_3_2),
    basins("table-3.2", "Basins of the old cyclists", ch3_riders::cases_3_2, ch3_riders::table_3_2),
    gains("figure-3.3", "Gains of the smart, old cyclist over speed", fits::figure_3_3),
    basins("figure-3.4", "Basins of the old cyclists", ch3_riders::cases_figure_3_4, ch3_riders::figure_3_4),
    basins("table-3.3", "Decline of the basins with delay", ch3_riders::cases_3_3, ch3_riders::table_3_3),
    basins("figure-3.5", "Basins of the three cyclists", ch3_riders::cases_3_5, ch3_riders::figure_3_5),
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
    basins(
        "figure-3.15",
        "Basin of the smart, old cyclist aided by h",
        ch3_riders::cases_3_15,
        ch3_riders::figure_3_15,
    ),
    rides("figure-C.1", "Eigenvalues fitted to the roll rate", app_c::figure_c_1, 8),
    rides("figure-C.2", "Eigenvalues fitted to the steer rate", app_c::figure_c_2, 8),
    rides("figure-C.3", "Eigenvalues fitted within bounds, and by matrix pencil", app_c::figure_c_3, 12),
    #[cfg(feature = "solvers")]
    rides("figure-D.1", "The rides of the convergence study", app_d::figure_d_1, 2),
    #[cfg(not(feature = "solvers"))]
    Entry { name: "figure-D.1", title: "The rides of the convergence study", made: SOLVERS },
    #[cfg(feature = "solvers")]
    rides("figure-D.2", "Errors of fixed steps", app_d::figure_d_2, 40),
    #[cfg(not(feature = "solvers"))]
    Entry { name: "figure-D.2", title: "Errors of fixed steps", made: SOLVERS },
    #[cfg(feature = "solvers")]
    rides("figure-D.3", "Errors of adaptive solvers", app_d::figure_d_3, 20),
    #[cfg(not(feature = "solvers"))]
    Entry { name: "figure-D.3", title: "Errors of adaptive solvers", made: SOLVERS },
    gains("table-F.1", "Fit of the young cyclist's gains", fits::table_f_1),
    gains("equation-F.2", "Regression of the young cyclist's gains", fits::equation_f_2),
    linear("table-F.3", "Variance that the young cyclist's reduced sets account for", reductions::table_f_3),
    gains("table-G.2", "Fit of the smart cyclist's gains", fits::table_g_2),
    gains("equation-G.2", "Regression of the smart cyclist's gains", fits::equation_g_2),
    linear("table-G.3", "Variance that the old cyclist's reduced sets account for", reductions::table_g_3),
    gains("figure-H.1", "Six and seven gains over speed", fits::figure_h_1),
    gains("table-H.1", "Fit of the six gains", fits::table_h_1),
    gains("equation-H.1", "Regression of the six gains", fits::equation_h_1),
    gains("figure-H.2", "The six gains over speed", fits::figure_h_2),
    basins("table-H.2", "Basins of the smart cyclist with six gains", app_h::cases, app_h::table_h_2),
    basins("figure-H.3", "Basins with six and with seven gains", app_h::cases_figure_h_3, app_h::figure_h_3),
    basins("table-H.3", "Change of the basins from seven to six gains", app_h::cases, app_h::table_h_3),
    rides("table-I.1", "Heights of the young cyclist's reduced gain sets", app_i::table_i_1, 30),
    rides("table-I.2", "Heights of the old cyclist's reduced gain sets", app_i::table_i_2, 60),
    rides("figure-I.1", "Heights of the reduced gain sets", app_i::figure_i_1, 60),
    Entry { name: "figure-I.2", title: "Measured and modelled roll rate, run 184", made: MEASURED },
    Entry { name: "figure-I.3", title: "Measured and modelled roll rate, run 248", made: MEASURED },
    Entry { name: "figure-I.4", title: "Measured and modelled roll rate, run 248", made: MEASURED },
    Entry { name: "figure-I.5", title: "Measured and modelled roll rate, run 252", made: MEASURED },
    Entry { name: "figure-I.6", title: "Measured and modelled roll rate, run 256", made: MEASURED },
    linear(
        "table-J.1",
        "Variance that the undelayed cyclist's reduced sets account for",
        reductions::table_j_1,
    ),
    gains("figure-J.1", "Variance accounted for by two reduced sets", app_j::figure_j_1),
    gains("equation-J.5", "Regression of the undelayed rider's gains", fits::equation_j_5),
    gains("figure-J.2", "The undelayed rider's gains over speed", fits::figure_j_2),
    linear("table-J.4", "Critical speeds of the undelayed rider", app_j::table_j_4),
    linear("figure-J.3", "Eigenvalues of the undelayed rider", app_j::figure_j_3),
    basins("figure-J.4", "Basins of the undelayed rider", app_j::cases_j_4, app_j::figure_j_4),
    basins("figure-J.5", "Basins with a delay the gains do not know of", app_j::cases_j_5, app_j::figure_j_5),
    linear("table-K.1", "Gains at 4.3 m/s", app_k::table_k_1),
    rides("figure-K.1", "Gains and torques at 4.3 m/s", app_k::figure_k_1, 1),
    rides("figure-K.2", "Which gain makes the regression unstable", app_k::figure_k_2, 1),
    rides("figure-K.3", "Sensitivity at 4.3 m/s", app_k::figure_k_3, 2),
    rides("figure-K.4", "Sensitivity at 2.2 m/s", app_k::figure_k_4, 2),
    rides("figure-K.5", "Sensitivity at 3.2 m/s", app_k::figure_k_5, 2),
    rides("figure-K.6", "Sensitivity at 4.3 m/s", app_k::figure_k_6, 2),
    rides("figure-K.7", "Sensitivity at 6.0 m/s", app_k::figure_k_7, 2),
    rides("figure-K.8", "Sensitivity at 7.3 m/s", app_k::figure_k_8, 2),
    rides("sensitivity-K", "Sensitivity of the height to everything", sensitivity::sensitivity_k, 200),
];

/// An unknown item.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("no item `{wanted}`; items are {}, or their numbers, or a chapter or appendix alone", known())]
pub struct UnknownItem {
    /// The name as given.
    wanted: String,
}

fn known() -> String {
    CATALOGUE.iter().map(|e| e.name).collect::<Vec<_>>().join(", ")
}

/// The items that `wanted` selects; all if it is empty.
///
/// # Errors
/// The first name that selects no item.
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
        let error = names("9.9").unwrap_err().to_string();
        assert!(error.contains("`9.9`") && error.contains("figure-2.2"), "{error}");
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
