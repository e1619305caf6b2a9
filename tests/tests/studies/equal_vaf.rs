//! The study of gains with equal VAF: its page is the committed one, but for the resolution.

use sim_host::basin::Search;
use sim_host::study::equal_vaf::{Extent, study, work};
use tests::cli::repository;

/// The rows of "Every set" of a page: all cells but the height, and the height \[rad/s\].
fn every_set(page: &str) -> Vec<(Vec<String>, f64)> {
    let (_, list) = page.split_once("\n## Every set\n").expect("the section");
    let rows = list.lines().filter(|line| line.starts_with("| ")).skip(2);
    rows.map(|line| {
        let mut cells: Vec<String> =
            line.trim_matches('|').split('|').map(|cell| cell.trim().into()).collect();
        let height = cells.remove(6).parse().expect("a height");
        (cells, height)
    })
    .collect()
}

/// Situation: the study with a coarser scan, one speed and four drawn riders.
/// Action: compute it, and stop it.
/// Must hold: every set of the committed page with the same printed numbers and growth, its height within the
/// tolerance of both; the printed heights, on their grid, except the two of Table I.2 known not to be met; nothing if stopped.
#[test]
fn the_committed_page_is_the_studys() {
    let page = Extent::page();
    let search = Search { speeds: vec![4.0], scan_step: 0.8, ..page.search.clone() };
    let extent = Extent { search, draws: 4 };
    let found = study(&extent, &|| {}, &|| false).expect("shipped riders").expect("not stopped");
    let committed = std::fs::read_to_string(repository("docs/studies/equal-vaf.md")).expect("the page");
    let (own, committed) = (every_set(&found.text), every_set(&committed));
    assert_eq!((own.len(), committed.len()), (work(&extent).expect("shipped") - 4, own.len()));
    let mut missed = Vec::new();
    for ((cells, height), (as_committed, committed)) in own.iter().zip(&committed) {
        assert_eq!(cells, as_committed);
        assert!((height - committed).abs() <= 2.0 * page.search.tolerance, "{cells:?} {height} {committed}");
        if let Ok(printed) = cells[6].parse::<f64>() {
            let on_grid = (10.0 * committed + 1e-9).floor() / 10.0 + 0.1;
            if (on_grid - printed).abs() > 0.15 {
                missed.push((cells[1].clone(), cells[3].clone()));
            }
        }
    }
    assert_eq!(missed, [("252".into(), "8".into()), ("190".into(), "7".into())]);
    assert!(found.text.contains("4 riders drawn from `young`"), "{}", found.text);
    assert_eq!(study(&extent, &|| {}, &|| true).expect("shipped riders"), None);
}
