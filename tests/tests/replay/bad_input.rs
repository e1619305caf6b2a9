//! Recordings in which something is wrong.

use super::{Bench, HEADER, PERIOD_S, PROGRAM, cause, lines, number, remarks, rows, table_of};
use serde_json::Value;
use sim_host::recording::table;
use sim_host::replay::{Feed, FeedError, FeedOptions, Leap, Map, Resample, samples};

/// Replays a table that must be usable but for what is said, all of `words` in one remark; under `--strict` the same must be
/// the reason why it is refused.
fn said(text: &str, words: &[&str]) -> Value {
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", text);
    let document = bench.json("replay ride.csv --map extract");
    let found = remarks(&document).into_iter().any(|remark| words.iter().all(|word| remark.contains(word)));
    assert!(found, "{words:?}: {}", document["remarks"]);
    assert!(remarks(&document).len() < 10, "{}", document["remarks"]);
    bench.run("replay ride.csv --map extract --strict --json").refused_naming(&["ride.csv", words[0]]);
    document
}

/// A table that must be refused with these words.
fn refused(text: impl AsRef<[u8]>, words: &[&str]) {
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", text);
    bench.run("replay ride.csv --map extract --json").refused_naming(&[&["ride.csv"], words].concat());
}

fn engaged_s(document: &Value) -> f64 {
    number(&document["engaged_s"])
}

/// Situation: tables that hold nothing: no byte, no row, no header, two columns of one name.
/// Action: replay them.
/// Must hold: refused, with the line where there is one and what to do.
#[test]
fn tables_that_can_not_be_used() {
    let good = lines(&rows(50));
    refused("", &["no line with data"]);
    refused("\n# a remark\n", &["no line with data"]);
    refused(table_of(HEADER, &[]), &["line 1", "no row"]);
    refused(good.join("\n"), &["line 1", "header", "add one line with names"]);
    refused("<html><body>404: Not Found</body></html>\n", &["line 1", "`<html><body>404"]);
    refused([0xff, 0xfe, b't', 0, b',', 0, b'g', 0, b'\n', 0], &["line 1", "UTF-8"]);
    refused(table_of(&HEADER.replace("gy", "gx"), &good), &["line 1", "two columns are called `gx`"]);
    refused(table_of(HEADER, &good[..1]), &["gyro: 1 usable sample", "at least 2"]);
}

/// Situation: columns that change half way: the accelerometer is no longer written.
/// Action: replay.
/// Must hold: said with the line; the rows before and after are used, the accelerometer is lost from there on.
#[test]
fn columns_that_change_half_way() {
    let all = lines(&rows(400));
    let without = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [&cells[..4], &cells[7..]].concat().join(",")
    };
    let mut changed = all[..200].to_vec();
    changed.push(without(HEADER));
    changed.extend(all[200..].iter().map(|line| without(line)));
    let document = said(&table_of(HEADER, &changed), &["line 202", "8 other columns"]);
    assert_eq!(number(&document["span_s"][1]), 1.995);
    let lost = &document["modes"].as_array().unwrap().last().unwrap();
    assert_eq!(lost["mode"], "limp");
    assert!((1.0..1.05).contains(&number(&lost["from_s"])), "{lost}");
}

/// Situation: the last line is cut.
/// Action: replay.
/// Must hold: said with the line and that the file ends there; the others are used.
#[test]
fn half_a_last_line() {
    let text = table_of(HEADER, &lines(&rows(400)));
    let cut = text[..text.len() - 60].trim_end_matches('\n');
    let document = said(cut, &["line 401", "the file ends within it"]);
    assert_eq!(number(&document["span_s"][1]), 1.99);
    assert!((1.3..1.7).contains(&engaged_s(&document)));
}

/// Situation: a time that jumps back by 0.25 s; one that stands for three rows.
/// Action: replay.
/// Must hold: said once with line, both times and the number of rows; what comes later is used, and nothing is noticed.
#[test]
fn time_that_goes_back_or_stands() {
    let all = lines(&rows(400));
    let back = [&all[..200], &all[150..]].concat();
    let stands = [&all[..200], &[all[199].clone(), all[199].clone(), all[199].clone()], &all[200..]].concat();
    for (lines, words) in [
        (back, ["line 202", "goes back from 0.995 s to 0.75", "50 rows", "gyro"]),
        (stands, ["line 202", "stands at 0.995 s", "3 rows", "rear-wheel"]),
    ] {
        let document = said(&table_of(HEADER, &lines), &words);
        assert_eq!(remarks(&document).len(), 1, "{}", document["remarks"]);
        assert_eq!(number(&document["span_s"][1]), 1.995);
        assert!((1.3..1.7).contains(&engaged_s(&document)));
    }
}

/// Situation: the steer encoder says -1.78 rad for the first 10 s, as one that is not up yet.
/// Action: replay.
/// Must hold: out of range (cause 10) from the beginning for 10 s, engaged only after it.
#[test]
fn boot_values() {
    let mut all = rows(2600);
    for row in all.iter_mut().filter(|row| row[0] < 10.0) {
        (row[7], row[8]) = (-1.78, 0.0);
    }
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", table_of(HEADER, &lines(&all)));
    let document = bench.json("replay ride.csv --map extract");
    let range = cause(&document, 10).expect("out of range");
    assert_eq!(number(&range["first_s"]), 0.0);
    assert!((9.99..10.01).contains(&number(&range["total_s"])), "{range}");
    let engaged =
        document["modes"].as_array().unwrap().iter().find(|mode| mode["mode"] == "engaged").unwrap();
    assert!((10.0..10.5).contains(&number(&engaged["from_s"])), "{engaged}");
}

/// Situation: rates in degrees a second, angles in degrees, forces in g, speeds in km/h; an accelerometer upside down.
/// Action: replay each as if it were SI.
/// Must hold: said with the sensor, the magnitude and the unit that it looks like. The same in SI: nothing is said.
#[test]
fn values_that_look_like_another_unit() {
    // Twice as lively as the gentle ride.
    let lively = |factors: [f64; 11]| {
        let mut all = rows(400);
        for row in &mut all {
            for place in [1, 2, 3, 7, 8] {
                row[place] *= 4.0;
            }
            row.iter_mut().zip(factors).for_each(|(cell, factor)| *cell *= factor);
        }
        table_of(HEADER, &lines(&all))
    };
    let only = |places: &[usize], factor: f64| {
        lively(std::array::from_fn(|place| if places.contains(&place) { factor } else { 1.0 }))
    };
    let degrees = 180.0 / std::f64::consts::PI;
    said(&only(&[1, 2, 3], degrees), &["gyro", "one sample in twenty", "degrees a second"]);
    said(&only(&[7], degrees), &["steer", "degrees?"]);
    said(&only(&[8], degrees), &["steer-rate", "degrees a second"]);
    said(&only(&[9, 10], 3.6), &["front-wheel", "km/h"]);
    said(&only(&[4, 5, 6], 1.0 / 9.80665), &["accel", "is the unit g"]);
    said(&only(&[6], -1.0), &["accel", "along z", "are the axes right"]);
    // Hardly steered: 2.9 degrees either way.
    let mut straight = rows(400);
    straight.iter_mut().for_each(|row| row[7] *= 2.5 * degrees);
    said(&table_of(HEADER, &lines(&straight)), &["steer", "degrees?"]);
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", only(&[], 1.0));
    assert_eq!(remarks(&bench.json("replay ride.csv --map extract")), [""; 0]);
}

/// Situation: times in milliseconds taken as seconds; times that are all the same; a time of day
/// without a date.
/// Action: replay.
/// Must hold: said, or refused, with what the times are like; the first cell that is no number is named.
#[test]
fn times_that_are_wrong() {
    let timed = |time: &dyn Fn(f64) -> String| {
        let line = |row: &[f64; 11]| {
            let cells: Vec<String> = row[1..].iter().map(ToString::to_string).collect();
            format!("{},{}", time(row[0]), cells.join(","))
        };
        table_of(HEADER, &rows(100).iter().map(line).collect::<Vec<_>>())
    };
    said(&timed(&|t| (1e3 * t).to_string()), &["gyro", "5 s apart", "unit of the time"]);
    refused(timed(&|t| (1e9 * (1e9 + t)).to_string()), &["18000 s", "unit of the time"]);
    refused(timed(&|_| "5".into()), &["gyro: 1 usable sample", "line 3", "stands at 5 s"]);
    refused(
        timed(&|t| format!("12:00:{t:.3}")),
        &["gyro: 0 usable samples", "line 2", "`12:00:0.000` is no number"],
    );
}

/// Situation: a table as a spreadsheet with a decimal comma writes it; one with a separator at the end of every line.
/// Action: replay.
/// Must hold: the same as the plain table, without a remark.
#[test]
fn other_ways_of_writing_the_same_table() {
    let bench = Bench::new(PROGRAM);
    let plain = table_of(HEADER, &lines(&rows(400)));
    let results =
        [plain.clone(), plain.replace(',', ";").replace('.', ","), plain.replace('\n', ",\n")].map(|text| {
            bench.write("ride.csv", text);
            let document = bench.json("replay ride.csv --map extract");
            assert_eq!(remarks(&document), [""; 0]);
            (document["modes"].clone(), document["checks"].clone())
        });
    assert!(results[0] == results[1] && results[0] == results[2]);
}

/// Situation: cells that say NaN, and one that is a word.
/// Action: replay.
/// Must hold: NaN is no sample, as a blank is; the word is said with line and column.
#[test]
fn cells_without_a_number() {
    let mut all = lines(&rows(400));
    for line in &mut all[300..310] {
        let cells: Vec<&str> = line.split(',').collect();
        *line = [&cells[..1], &["NaN"], &cells[2..]].concat().join(",");
    }
    all[200] = all[200].rsplit_once(',').unwrap().0.to_owned() + ",broken";
    let document = said(&table_of(HEADER, &all), &["line 202", "rear", "`broken` is no number"]);
    // Without a gyro for 50 ms.
    let lost = cause(&document, 1).unwrap();
    assert_eq!((number(&lost["count"]), number(&lost["alarms"])), (2.0, 1.0));
}

/// Situation: a ride of 4 s; one row's time is far ahead, or the last one's.
/// Action: replay it, and with `--strict`.
/// Must hold: the row is left out, line and time are told, and all after it is used; of the last row the error names line and
/// times. Strictly the first is refused, too.
#[test]
fn a_time_stamp_far_ahead_is_named() {
    let ride = |wrong: usize| -> String {
        let time = |i: usize| if i == wrong { 1e9 } else { 0.005 * i as f64 };
        let noise = |i: usize| ((i * i) as f64).sin() * 1e-3;
        let row = |i: usize| format!("{},{},{},{},4\n", time(i), noise(i), noise(i + 7), noise(i + 13));
        std::iter::once("t,gx,gy,gz,rear\n".to_owned()).chain((0..800).map(row)).collect()
    };
    let bench = Bench::new(PROGRAM);
    bench.write("one.csv", ride(300));
    bench.write("last.csv", ride(799));
    let run = bench.run("replay one.csv --map extract");
    assert_eq!(run.code, Some(0), "{run:?}");
    for word in ["line 302", "time 1000000000 s is ahead", "0.000 to 3.995 s"] {
        assert!(run.stdout.contains(word), "{word}: {run:?}");
    }
    bench.run("replay one.csv --map extract --strict").refused_naming(&["line 302", "ahead"]);
    bench
        .run("replay last.csv --map extract")
        .refused_naming(&["line 801", "jumps from 3.99 s to 1000000000 s"]);
}

/// Situation: a ride of 4 s whose last row's time is far ahead; the same in milliseconds taken as seconds for 6 hours.
/// Action: feed them to the controller.
/// Must hold: too long, with its ends; the leap with line and both times in the first, no leap in the second.
#[test]
fn a_leap_is_known_without_its_words() {
    let table = |times: &[f64]| {
        let row = |t: &f64| format!("{t},{},{},0,4\n", t.sin(), t.cos());
        "t,gx,gy,gz,rear\n".to_owned() + &times.iter().map(row).collect::<String>()
    };
    let refused = |times: &[f64]| {
        let map = Map::load("extract").unwrap();
        let samples = samples(&table::parse(&table(times)).unwrap(), &map, PERIOD_S).unwrap();
        let resample = Resample::Hold;
        let options = FeedOptions { period_s: PERIOD_S, resample, longest_gap_s: 0.5, faults: &[], seed: 0 };
        Feed::new(&samples, options).map(|_| ()).unwrap_err()
    };
    let mut times: Vec<f64> = (0..800).map(|i| 0.005 * f64::from(i)).collect();
    times[799] = 1e9;
    let leap = Some(Leap { line: Some(801), from_s: 3.99, to_s: 1e9 });
    assert_eq!(refused(&times), FeedError::TooLong { start_s: 0.0, end_s: 1e9, most_s: 18e3, leap });
    let times: Vec<f64> = (0..4401).map(|i| 5.0 * f64::from(i)).collect();
    assert_eq!(refused(&times), FeedError::TooLong { start_s: 0.0, end_s: 22e3, most_s: 18e3, leap: None });
}
