//! Recordings with errors.

use super::{Bench, HEADER, PERIOD_S, PROGRAM, cause, lines, number, remarks, rows, table_of};
use serde_json::Value;
use sim_host::recording::table;
use sim_host::replay::{Feed, FeedError, FeedOptions, Leap, Map, Resample, samples};

/// Replays a table that must be usable except for the reported error, all of `words` in one remark; under `--strict`
/// the same must be the reason of the rejection.
fn output(text: &str, texts: &[&str]) -> Value {
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", text);
    let document = bench.json("replay ride.csv --map extract");
    let found = remarks(&document).into_iter().any(|remark| texts.iter().all(|word| remark.contains(word)));
    assert!(found, "{texts:?}: {}", document["remarks"]);
    assert!(remarks(&document).len() < 10, "{}", document["remarks"]);
    bench.run("replay ride.csv --map extract --strict --json").rejected_naming(&["ride.csv", texts[0]]);
    document
}

/// A table that must be rejected with this text.
fn assert_rejected(text: impl AsRef<[u8]>, texts: &[&str]) {
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", text);
    bench.run("replay ride.csv --map extract --json").rejected_naming(&[&["ride.csv"], texts].concat());
}

fn engaged_s(document: &Value) -> f64 {
    number(&document["engaged_s"])
}

/// Situation: empty tables: no byte, no row, no header, two columns of one name.
/// Action: replay them.
/// Must hold: rejected, with the line where there is one and a remedy.
#[test]
fn tables_that_can_not_be_used() {
    let good = lines(&rows(50));
    assert_rejected("", &["no line with data"]);
    assert_rejected("\n# a remark\n", &["no line with data"]);
    assert_rejected(table_of(HEADER, &[]), &["line 1", "no row"]);
    assert_rejected(good.join("\n"), &["line 1", "header", "add one line with names"]);
    assert_rejected("<html><body>404: Not Found</body></html>\n", &["line 1", "`<html><body>404"]);
    assert_rejected([0xff, 0xfe, b't', 0, b',', 0, b'g', 0, b'\n', 0], &["line 1", "UTF-8"]);
    assert_rejected(table_of(&HEADER.replace("gy", "gx"), &good), &["line 1", "two columns are called `gx`"]);
    assert_rejected(table_of(HEADER, &good[..1]), &["gyro: 1 usable sample", "at least 2"]);
}

/// Situation: a table cut within the last number of its last line.
/// Action: replay it, also with `--strict`; the same with the line's end.
/// Must hold: a remark with the line, and the row is used; rejected under `--strict`. Accepted with the end.
#[test]
fn a_last_line_without_an_end() {
    let whole = table_of(HEADER, &lines(&rows(400)));
    let cut = whole.trim_end();
    output(cut, &["line 401: the last line has no end"]);
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", format!("{cut}\n"));
    let document = bench.json("replay ride.csv --map extract --strict");
    assert!(remarks(&document).is_empty(), "{}", document["remarks"]);
}

/// Situation: columns that change in the middle: the accelerometer is no longer written.
/// Action: replay.
/// Must hold: reported with the line; the rows before and after are used, the accelerometer is lost from there on.
#[test]
fn columns_that_change_in_the_middle() {
    let all = lines(&rows(400));
    let without = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [&cells[..4], &cells[7..]].concat().join(",")
    };
    let mut changed = all[..200].to_vec();
    changed.push(without(HEADER));
    changed.extend(all[200..].iter().map(|line| without(line)));
    let document = output(&table_of(HEADER, &changed), &["line 202", "8 other columns"]);
    assert_eq!(number(&document["span_s"][1]), 1.995);
    let lost = &document["modes"].as_array().unwrap().last().unwrap();
    assert_eq!(lost["mode"], "limp");
    assert!((1.0..1.05).contains(&number(&lost["from_s"])), "{lost}");
}

/// Situation: the last line is cut.
/// Action: replay.
/// Must hold: reported with the line and that the file ends there; the others are used.
#[test]
fn half_a_last_line() {
    let text = table_of(HEADER, &lines(&rows(400)));
    let cut = text[..text.len() - 60].trim_end_matches('\n');
    let document = output(cut, &["line 401", "the file ends within it"]);
    assert_eq!(number(&document["span_s"][1]), 1.99);
    assert!((1.3..1.7).contains(&engaged_s(&document)));
}

/// Situation: a time that jumps back by 0.25 s; one that is constant for three rows.
/// Action: replay.
/// Must hold: reported once with line, both times and the number of rows; later rows are used, and no fault is
/// detected.
#[test]
fn time_that_steps_back_or_stops() {
    let all = lines(&rows(400));
    let back = [&all[..200], &all[150..]].concat();
    let stands = [&all[..200], &[all[199].clone(), all[199].clone(), all[199].clone()], &all[200..]].concat();
    for (lines, texts) in [
        (back, ["line 202", "goes back from 0.995 s to 0.75", "50 rows", "gyro"]),
        (stands, ["line 202", "stands at 0.995 s", "3 rows", "rear-wheel"]),
    ] {
        let document = output(&table_of(HEADER, &lines), &texts);
        assert_eq!(remarks(&document).len(), 1, "{}", document["remarks"]);
        assert_eq!(number(&document["span_s"][1]), 1.995);
        assert!((1.3..1.7).contains(&engaged_s(&document)));
    }
}

/// Situation: the steer encoder reads -1.78 rad for the first 10 s, as before its start-up.
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

/// Situation: rates in degrees a second, angles in degrees, forces in g, speeds in km/h; an accelerometer upside
/// down.
/// Action: replay each as if it were SI.
/// Must hold: reported with the sensor, the magnitude and the probable unit. The same in SI: no report.
#[test]
fn values_in_another_unit_are_reported() {
    // Twice the motion of the gentle ride.
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
    output(&only(&[1, 2, 3], degrees), &["gyro", "one sample in twenty", "degrees a second"]);
    output(&only(&[7], degrees), &["steer", "degrees?"]);
    output(&only(&[8], degrees), &["steer-rate", "degrees a second"]);
    output(&only(&[9, 10], 3.6), &["front-wheel", "km/h"]);
    output(&only(&[4, 5, 6], 1.0 / 9.80665), &["accel", "is the unit g"]);
    output(&only(&[6], -1.0), &["accel", "along z", "are the axes right"]);
    // Almost no steering: 2.9 degrees to either side.
    let mut straight = rows(400);
    straight.iter_mut().for_each(|row| row[7] *= 2.5 * degrees);
    output(&table_of(HEADER, &lines(&straight)), &["steer", "degrees?"]);
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", only(&[], 1.0));
    assert_eq!(remarks(&bench.json("replay ride.csv --map extract")), [""; 0]);
}

/// Situation: times in milliseconds taken as seconds; times that are all the same; a time of day without a date.
/// Action: replay.
/// Must hold: reported, or rejected, with the probable form of the times; the first cell that is no number is named.
#[test]
fn times_that_are_wrong() {
    let timed = |time: &dyn Fn(f64) -> String| {
        let line = |row: &[f64; 11]| {
            let cells: Vec<String> = row[1..].iter().map(ToString::to_string).collect();
            format!("{},{}", time(row[0]), cells.join(","))
        };
        table_of(HEADER, &rows(100).iter().map(line).collect::<Vec<_>>())
    };
    output(&timed(&|t| (1e3 * t).to_string()), &["gyro", "5 s apart", "unit of the time"]);
    assert_rejected(timed(&|t| (1e9 * (1e9 + t)).to_string()), &["18000 s", "unit of the time"]);
    assert_rejected(timed(&|_| "5".into()), &["gyro: 1 usable sample", "line 3", "stands at 5 s"]);
    assert_rejected(
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

/// Situation: cells with NaN, and one with a text.
/// Action: replay.
/// Must hold: NaN is no sample, like a blank; the text is reported with line and column.
#[test]
fn cells_without_a_number() {
    let mut all = lines(&rows(400));
    for line in &mut all[300..310] {
        let cells: Vec<&str> = line.split(',').collect();
        *line = [&cells[..1], &["NaN"], &cells[2..]].concat().join(",");
    }
    all[200] = all[200].rsplit_once(',').unwrap().0.to_owned() + ",broken";
    let document = output(&table_of(HEADER, &all), &["line 202", "rear", "`broken` is no number"]);
    // Without a gyro for 50 ms.
    let lost = cause(&document, 1).unwrap();
    assert_eq!((number(&lost["count"]), number(&lost["alarms"])), (2.0, 1.0));
}

/// Situation: a ride of 4 s; the time of one row, or of the last one, is far ahead.
/// Action: replay it, and with `--strict`.
/// Must hold: the row is left out, line and time are reported, and all later rows are used; for the last row the
/// error names line and times. Strictly the first is rejected, too.
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
    bench.run("replay one.csv --map extract --strict").rejected_naming(&["line 302", "ahead"]);
    bench
        .run("replay last.csv --map extract")
        .rejected_naming(&["line 801", "jumps from 3.99 s to 1000000000 s"]);
}

/// Situation: a ride of 4 s whose last row's time is far ahead; the same in milliseconds taken as seconds for 6
/// hours.
/// Action: feed them to the controller.
/// Must hold: too long, with its ends; the jump with line and both times in the first, no jump in the second.
#[test]
fn a_time_jump_is_found_without_its_text() {
    let table = |times: &[f64]| {
        let row = |t: &f64| format!("{t},{},{},0,4\n", t.sin(), t.cos());
        "t,gx,gy,gz,rear\n".to_owned() + &times.iter().map(row).collect::<String>()
    };
    let assert_rejected = |times: &[f64]| {
        let map = Map::load("extract").unwrap();
        let samples = samples(&table::parse(&table(times)).unwrap(), &map, PERIOD_S).unwrap();
        let resample = Resample::Hold;
        let options = FeedOptions { period_s: PERIOD_S, resample, longest_gap_s: 0.5, faults: &[], seed: 0 };
        Feed::new(&samples, options).map(|_| ()).unwrap_err()
    };
    let mut times: Vec<f64> = (0..800).map(|i| 0.005 * f64::from(i)).collect();
    times[799] = 1e9;
    let leap = Some(Leap { line: Some(801), from_s: 3.99, to_s: 1e9 });
    assert_eq!(assert_rejected(&times), FeedError::TooLong { start_s: 0.0, end_s: 1e9, most_s: 18e3, leap });
    let times: Vec<f64> = (0..4401).map(|i| 5.0 * f64::from(i)).collect();
    assert_eq!(
        assert_rejected(&times),
        FeedError::TooLong { start_s: 0.0, end_s: 22e3, most_s: 18e3, leap: None }
    );
}
