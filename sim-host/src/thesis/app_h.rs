//! Appendix H: basins with six and with seven gains.

use super::case::Case;
use super::ch3_riders::{all_fits, basin_cell, of_rider, outlines, ridden};
use super::cyclist::{Cyclist, fit_named, named};
use super::figures_of_merit::{merit, with_readings};
use super::heights::{Outline, area, rmse};
use super::item::{Figure, Item, Value};
use super::study::Study;
use crate::rider::Fit;

/// The basins of appendix H's tables.
pub(super) fn cases() -> Vec<Case> {
    with_readings(&all_fits(&[Cyclist::smart, Cyclist::six]))
}

/// The basins of Figure H.3.
pub(super) fn cases_figure_h_3() -> Vec<Case> {
    all_fits(&[Cyclist::smart, Cyclist::six])
}

/// The basins with seven and with six gains.
fn both(fit: Fit) -> [Case; 2] {
    [Cyclist::smart(fit), Cyclist::six(fit)].map(Case::ridden)
}

/// Table H.2.
pub(super) fn table_h_2(study: &Study) -> Item {
    let values = Item::compare("table-H.2", |cell| {
        let fit = cell.row.strip_suffix(", six to seven gains").and_then(fit_named);
        match (named(&cell.row), fit) {
            (Some(rider), _) => basin_cell(study, cell, rider),
            (None, Some(fit)) => merit(study, cell, &both(fit), &|o| rmse(&o[0], &o[1])),
            _ => Value::new(cell, None),
        }
    });
    Item { values, ..Item::default() }
}

/// Table H.3.
pub(super) fn table_h_3(study: &Study) -> Item {
    let change = |o: &[Outline]| 100.0 * (area(&o[1]) / area(&o[0]) - 1.0);
    let values = Item::compare("table-H.3", |cell| {
        let Some(fit) = fit_named(&cell.row) else { return Value::new(cell, None) };
        match cell.column.as_str() {
            "seven gains" => merit(study, cell, &ridden(Cyclist::smart, &[fit]), &|o| area(&o[0])),
            "six gains" => merit(study, cell, &ridden(Cyclist::six, &[fit]), &|o| area(&o[0])),
            _ => merit(study, cell, &both(fit), &change),
        }
    });
    Item { values, ..Item::default() }
}

/// Figure H.3.
pub(super) fn figure_h_3(study: &Study) -> Item {
    let six = of_rider(study, "six gains,", 0, Cyclist::six);
    let seven = of_rider(study, "seven gains,", 1, Cyclist::smart);
    let chart =
        outlines(study, "Basins of the smart, old cyclist with six and seven gains", [six, seven].concat());
    let caption = "Outlines of the basins of the smart, old cyclist, 60 ms late, with and without a gain on the roll \
                   angle.";
    Item { figures: vec![Figure::of_chart("figure-H.3", caption, &chart)], ..Item::default() }
}
