//! Numbers derived from basins, with their values under other readings of the thesis.

use super::case::{Case, GRID};
use super::ch3_assist::{BY_INITIAL, BY_REAR};
use super::cyclist::{Cyclist, Print};
use super::heights::{Outline, coarse, exact, floored};
use super::item::Value;
use super::published::Cell;
use super::study::Study;
use crate::basin::Basin;
use crate::ride::ScheduleSpeed;
use crate::rider::Fit;

/// Another reading: the case under it, or `None` if it does not differ.
type Reading = fn(Case) -> Option<Case>;

const READINGS: [(&str, Reading); 7] = [
    ("gains by least squares over the printed sets", |case| {
        by(case, Print::LeastSquares, |r| r.fit == Fit::Regression && r.table != "undelayed")
    }),
    ("eq. H.1 as printed, with -0.06181", |case| {
        by(case, Print::EquationH1, |r| r.fit == Fit::Regression && r.table == "smart6")
    }),
    ("best sets by the VAFs of Table F.2", |case| {
        by(case, Print::HighestVaf, |r| r.fit == Fit::Best && r.table == "young")
    }),
    ("with run 249, K_phi_d = 7.98", |case| by(case, Print::Run249ByH4, |r| r.table == "smart")),
    ("with run 249, K_phi_d = 2.98", |case| by(case, Print::Run249ByG4, |r| r.table == "smart")),
    (BY_REAR, |case| Some(case.scheduled(ScheduleSpeed::Rear))),
    (BY_INITIAL, |case| Some(case.scheduled(ScheduleSpeed::Initial))),
];

fn by(case: Case, print: Print, concerned: impl Fn(&Cyclist) -> bool) -> Option<Case> {
    let rider = case.rider.filter(concerned)?;
    Some(Case { rider: Some(rider.by(print)), ..case })
}

/// The cases together with all their other readings.
pub(super) fn with_readings(cases: &[Case]) -> Vec<Case> {
    let mut all = cases.to_vec();
    for (_, reading) in READINGS {
        all.extend(cases.iter().filter_map(|&case| reading(case)));
    }
    all
}

/// Whether a case is another reading of a rider.
pub(super) fn is_reading(case: &Case) -> bool {
    case.rider.is_some_and(|r| r.print != Print::Settled || case.schedule != ScheduleSpeed::Front)
}

/// A value computed by `of` from the outlines of `cases`: as located, on the coarse grid, and under each other reading
/// whose basins exist.
pub(super) fn merit(study: &Study, cell: Cell, cases: &[Case], of: &dyn Fn(&[Outline]) -> f64) -> Value {
    let under = |cases: &[Case], view: &dyn Fn(&Basin) -> Outline| {
        of(&cases.iter().map(|case| view(&study.basin(case))).collect::<Vec<_>>())
    };
    let capped = cases.iter().any(|case| study.basin(case).capped());
    let mut value = Value { capped, ..Value::new(cell, Some(under(cases, &exact))) }
        .on_grid(Some(under(cases, &coarse)))
        .tried("disturbances in steps of 0.4 rad/s", under(cases, &|basin| floored(basin, 0.4)));
    if !study.quick {
        let sparse = under(cases, &|basin| sparse(&coarse(basin)));
        value = value.tried("speeds in steps of 0.5 m/s, disturbances of 0.5 rad/s", sparse);
    }
    for (name, reading) in READINGS {
        let changed: Vec<Case> = cases.iter().map(|&case| reading(case).unwrap_or(case)).collect();
        if changed != cases && changed.iter().all(|case| study.has(case)) {
            value = value
                .tried(name, under(&changed, &exact))
                .tried(&format!("{name}; steps of {GRID} rad/s"), under(&changed, &coarse));
        }
    }
    value
}

/// The points at integer multiples of 0.5 m/s.
fn sparse(outline: &[(f64, f64)]) -> Outline {
    outline.iter().copied().filter(|(v, _)| (2.0 * v - (2.0 * v).round()).abs() < 1e-6).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_concern_whom_they_should() {
        let count = |rider| with_readings(&[Case::ridden(rider)]).len() - 1;
        assert_eq!(count(Cyclist::young(Fit::Mean)), 2);
        assert_eq!(count(Cyclist::naive(Fit::Best)), 3);
        assert_eq!(count(Cyclist::smart(Fit::Regression)), 5);
        assert_eq!(count(Cyclist::six(Fit::Regression)), 4);
        assert!(with_readings(&[Case::ridden(Cyclist::six(Fit::Mean))])[1..].iter().all(is_reading));
        assert_eq!(sparse(&[(2.0, 1.0), (2.1, 2.0), (2.5, 3.0)]), [(2.0, 1.0), (2.5, 3.0)]);
    }
}
