//! Any text as a table gives a recording or a reason.

use super::{HEADER, PERIOD_S, lines, rows, table_of};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use sim_host::recording::table;
use sim_host::replay::{Feed, FeedOptions, Map, Resample, samples};
use tests::draws::runner;

/// Columns as long as their group; samples of rising time and finite values; a feed that begins.
fn sound(text: &str) -> Result<(), TestCaseError> {
    let Ok(recording) = table::parse(text) else { return Ok(()) };
    for group in &recording.groups {
        prop_assert!(group.columns.iter().all(|column| column.values.len() == group.lines.len()));
        prop_assert!(group.columns.iter().flat_map(|c| &c.values).all(|value| !value.is_infinite()));
        prop_assert!(group.lines.iter().all(|line| *line as usize <= text.lines().count()));
    }
    prop_assert!(recording.remarks.len() < 40);
    let map = Map::load("extract").unwrap();
    for resample in [Resample::Hold, Resample::Interpolate] {
        let Ok(samples) = samples(&recording, &map, PERIOD_S) else { return Ok(()) };
        for track in &samples.tracks {
            prop_assert!(track.samples.windows(2).all(|two| two[0].t_s < two[1].t_s));
            prop_assert!(track.samples.iter().all(|sample| sample.value.iter().all(|x| !x.is_nan())));
        }
        let options = FeedOptions { period_s: PERIOD_S, resample, longest_gap_s: 0.5, faults: &[], seed: 0 };
        if let Ok(mut feed) = Feed::new(&samples, options) {
            let first = feed.next(true);
            prop_assert!(first.is_some() || feed.is_empty());
            prop_assert!((0..1000).filter_map(|_| feed.next(true)).all(|(t_s, _)| t_s.is_finite()));
        }
    }
    Ok(())
}

/// Situation: any text.
/// Action: read it as a table, apply a map, feed it.
/// Must hold: an error or a valid recording, never a panic.
#[test]
fn any_text() {
    runner(2000).run(&"(?s).{0,300}", |text| sound(&text)).unwrap();
}

/// Situation: a good table with pieces of text inserted at any place.
/// Action: the same.
/// Must hold: the same.
#[test]
fn a_table_with_random_insertions() {
    let good = table_of(HEADER, &lines(&rows(40)));
    let odd = [
        "",
        ",",
        ",,",
        ";",
        "\t",
        "\n",
        "\r\n",
        "\0",
        "\"",
        "'",
        "#",
        " ",
        "é",
        "\u{feff}",
        "\u{fffd}",
        "NaN",
        "inf",
        "-inf",
        "1e999",
        "1e308",
        "-1e308",
        "-",
        "-0",
        "1e-320",
        "t",
        "\nt,gx,gy,gz,rear\n",
        "\nt,t\n",
        "\ngx\n",
        "2026-05-01 12:00:00",
        "2026-13-41T99:99:99Z",
        "99999999999999999999",
        "true",
        "off",
    ];
    let change = (any::<Index>(), 0..8_usize, select(odd.to_vec()));
    let changed = vec(change, 1..12);
    runner(1000)
        .run(&changed, |changes| {
            let mut text = good.clone();
            for (place, length, piece) in changes {
                let at = place.index(text.len());
                let end = (at + length).min(text.len());
                if text.is_char_boundary(at) && text.is_char_boundary(end) {
                    text.replace_range(at..end, piece);
                }
            }
            sound(&text)
        })
        .unwrap();
}
