//! Several recordings at once.

use super::{HEADER, bench, lines, number, rows, table_of};
use serde_json::{Value, json};

/// Situation: a ride of 10 s and one of 6 s.
/// Action: replay both, without and with a fault at 2 s.
/// Must hold: each is there as if alone; times add up; the cause of the fault is counted in both and by the hour, and
/// its delay is reported.
#[test]
fn a_summary_of_all() {
    let bench = bench(2000);
    bench.write("short.csv", table_of(HEADER, &lines(&rows(1200))));
    let fine = bench.json("replay ride.csv short.csv --map extract");
    let recordings = fine["recordings"].as_array().unwrap();
    assert_eq!(recordings.len(), 2);
    let alone = bench.json("replay short.csv --map extract");
    for key in ["modes", "causes", "checks", "peak_torque_nm", "engaged_s"] {
        assert_eq!(recordings[1][key], alone[key], "{key}");
    }
    let summary = &fine["summary"];
    assert!((number(&summary["riding_s"]) - 16.0).abs() < 0.05, "{summary}");
    let engaged_s: f64 = recordings.iter().map(|one| number(&one["engaged_s"])).sum();
    assert!((number(&summary["engaged_s"]) - engaged_s).abs() < 1e-9 && engaged_s > 14.0);
    assert_eq!((&summary["alarms"], &summary["noticed"]), (&json!([]), &Value::Null));

    let faulty = bench.json("replay ride.csv short.csv --map extract --fault gyro:missing@2s");
    let summary = &faulty["summary"];
    assert_eq!(summary["noticed"], 2);
    assert!((0.005..0.02).contains(&number(&summary["median_notice_s"])), "{summary}");
    let alarm = summary["alarms"].as_array().unwrap().iter().find(|alarm| alarm["number"] == 1).unwrap();
    assert_eq!((&alarm["count"], &alarm["recordings"]), (&json!(2), &json!(2)));
    let per_hour = 2.0 * 3600.0 / number(&summary["riding_s"]);
    assert!((number(&alarm["per_hour"]) - per_hour).abs() < 1e-6, "{alarm}");
    let text = bench.run("replay ride.csv short.csv --map extract --fault gyro:missing@2s").stdout;
    for word in ["2 recordings", "an hour of riding", "noticed in 2 of 2"] {
        assert!(text.contains(word), "{text}");
    }
}

/// Situation: one of three recordings is unusable; all are.
/// Action: replay them.
/// Must hold: the others are there, the one is named with its reason, exit code 1; with none there is no document.
#[test]
fn an_unusable_file_leaves_the_others() {
    let bench = bench(400);
    bench.write("bad.csv", "1,2,3\n");
    let run = bench.run("replay ride.csv bad.csv ride.csv --map extract --json all.json --csv all.csv");
    assert_eq!(run.code, Some(1), "{run:?}");
    assert!(run.stderr.contains("bad.csv: line 1") && run.stderr.contains("1 of the recordings"), "{run:?}");
    let document: Value = serde_json::from_str(&bench.read("all.json")).unwrap();
    assert_eq!(document["recordings"].as_array().unwrap().len(), 2);
    let unusable = document["unusable"].as_array().unwrap();
    assert!(unusable.len() == 1 && unusable[0].as_str().unwrap().contains("bad.csv"), "{unusable:?}");
    let table = bench.read("all.csv");
    assert!(
        table.contains("file,number,name,first_s") && table.contains("\nride.csv,54,SelfTest,"),
        "{table}"
    );

    let run = bench.run("replay bad.csv bad.csv --map extract --json none.json");
    assert!(run.code == Some(1) && run.stderr.contains("none of the recordings"), "{run:?}");
    assert!(!bench.files().contains(&"none.json".to_owned()));
}

/// Situation: one of two recordings has two unusable lines.
/// Action: replay both.
/// Must hold: the text names that one with the first of its remarks, and reports that there is another.
#[test]
fn remarks_are_reported_with_their_file() {
    let bench = bench(400);
    let text = bench.read("ride.csv");
    bench.write("cut.csv", text.replacen("\n0.5,", "\n0.5;", 1).replacen("\n0.6,", "\n0.6;", 1));
    let run = bench.run("replay ride.csv cut.csv --map extract");
    let output: Vec<&str> = run.stdout.lines().filter(|line| line.starts_with("remark: ")).collect();
    assert!(output.len() == 1 && output[0].starts_with("remark: cut.csv: line 102: "), "{run:?}");
    assert!(output[0].ends_with(", and 1 more"), "{run:?}");
    bench.run("replay cut.csv cut.csv --map extract --strict").rejected_naming(&["cut.csv", "line 102"]);
}

/// Situation: two recordings.
/// Action: request a figure, or frames.
/// Must hold: rejected before any work, each with the option.
#[test]
fn figures_and_frames_are_of_one_recording() {
    let bench = bench(50);
    for option in ["--svg", "--png", "--frames"] {
        let run = bench.run(&format!("replay ride.csv ride.csv --map extract {option} out"));
        run.rejected_naming(&[option, "one recording only"]);
    }
    assert_eq!(bench.files(), ["ride.csv"]);
    let run = bench.run("replay ride.csv --map extract --svg ride.svg --png ride.png -q");
    assert!(run.code == Some(0) && run.stdout.is_empty(), "{run:?}");
    assert!(bench.read("ride.svg").contains("</svg>"));
}
