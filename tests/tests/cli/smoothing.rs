//! The table of the page on delays: areas of basins of the product with and without smoothing of the roll rate.

use tests::cli::{Bench, repository};
use tests::detection::rows_of;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// The areas of a row's basins without a rider and, if the page has it, with one, computed by the command that the page states.
fn computed(bench: &Bench, row: &str) -> [Option<String>; 2] {
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    let options = cells[2].trim_matches('`');
    let options = if options == "as flashed" { "" } else { options };
    [("", cells[3]), ("--rider smart", cells[4])].map(|(rider, area)| {
        let line = format!("basin --preset product --speeds 1:7:0.5 {rider} {options}");
        (!area.is_empty()).then(|| format!("{:.2}", bench.json(&line)["area"].as_f64().expect("an area")))
    })
}

/// Compares the rows that `chosen` selects by their options with the page.
fn compare(chosen: impl Fn(&str) -> bool) -> usize {
    let bench = Bench::new(PROGRAM);
    let page = std::fs::read_to_string(repository("docs/delay.md")).expect("the page");
    let rows: Vec<&str> = rows_of(&page, "smoothing").into_iter().filter(|row| chosen(row)).collect();
    for row in &rows {
        let [alone, ridden] = computed(&bench, row);
        let should = format!("| {} | {} |", alone.expect("an area"), ridden.unwrap_or_default());
        assert!(
            row.contains(&should.replace("|  |", "| |")),
            "docs/delay.md should have {should} in:\n{row}"
        );
    }
    rows.len()
}

/// Situation: the product as flashed, without a rider and with the smart one. Action: search the basins.
/// Must hold: the areas are the page's.
#[test]
fn the_page_on_delays_has_the_areas_as_flashed() {
    assert_eq!(compare(|row| row.contains("as flashed")), 1);
}

/// Situation, action and what must hold: as above, for every row.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_page_on_delays_has_every_area() {
    assert_eq!(compare(|_| true), 9);
}
