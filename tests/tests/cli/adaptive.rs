//! `basin --adaptive-speeds`, and the picture of a basin during its computation.

use serde_json::Value;
use tests::cli::{Bench, Run};
#[cfg(target_os = "linux")]
use tests::pty::on_terminal;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
const BASIN: &str = "basin --law h --speeds 0:2:0.4 --max-rate 5";

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

/// Situation: a basin that bends and jumps below 2 m/s.
/// Action: `--adaptive-speeds` without a value; again from the result's scenario, and with a larger tolerance; as table and
/// figure.
/// Must hold: more speeds than given, fewer with the larger tolerance; the area is that of the trapezoids; document, scenario
/// and table name the tolerance; the scenario gives the same document; without the option no document names it.
#[test]
fn adaptive_speeds_can_be_reproduced() {
    let bench = Bench::new(PROGRAM);
    let of = |line: &str| {
        let mut document = bench.json(line);
        document.as_object_mut().expect("a table").remove("seconds");
        document
    };
    let fine = of(&format!("{BASIN} --adaptive-speeds"));
    bench.write("fine.json", fine.to_string());
    let (speeds, upper) = (numbers(&fine["speeds"]), numbers(&fine["height"]["upper"]));
    assert!(speeds.len() > 10 && speeds.is_sorted(), "{speeds:?}");
    let strips = speeds.windows(2).zip(upper.windows(2)).map(|(v, u)| 0.5 * (v[1] - v[0]) * (u[0] + u[1]));
    assert!((fine["area"].as_f64().expect("a number") - strips.sum::<f64>()).abs() < 1e-9);
    assert_eq!((&fine["search"]["adaptive_speeds"], &fine["complete"]), (&0.01.into(), &true.into()));
    assert_eq!(fine["scenario"]["search"]["adaptive_speeds"], 0.01);
    assert_eq!(of("basin --scenario fine.json"), fine);
    let coarse = of("basin --scenario fine.json --adaptive-speeds 0.2");
    let count = numbers(&coarse["speeds"]).len();
    assert!(count > 6 && count < speeds.len(), "{count} and {}", speeds.len());
    let given = of(BASIN);
    assert_eq!(numbers(&given["speeds"]).len(), 6);
    assert!(!given.to_string().contains("adaptive"), "{given}");

    let run = bench.run(&format!("{BASIN} --adaptive-speeds --csv out.csv --svg out.svg --png out.png"));
    assert_eq!(run.code, Some(0), "{run:?}");
    let table = bench.read("out.csv");
    assert_eq!(table.matches(",border,").count(), speeds.len());
    assert!(table.contains("\"adaptive_speeds\":0.01"));
    let run = bench
        .run("basin compare fine.json 'same=--law h' --speeds 0:2:0.4 --max-rate 5 --json compared.json");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.stdout.contains("different speeds of the same range"), "{run:?}");
    let compared: Value = serde_json::from_str(&bench.read("compared.json")).expect("JSON");
    assert_eq!(compared["rmse"][0][1], 0.0, "at the common speeds");
}

/// Situation: tolerances outside their range, also in a file; a scenario with adaptive speeds for a comparison.
/// Action: run.
/// Must hold: refused with the value and the range; a comparison uses the given speeds.
#[test]
fn other_tolerances_and_commands() {
    let bench = Bench::new(PROGRAM);
    bench.run(&format!("{BASIN} --adaptive-speeds 0")).rejected_naming(&["adaptive speeds", "0.0001", "1"]);
    bench.write("wrong.toml", "[search]\nadaptive_speeds = 2.0\n");
    bench.run("basin --scenario wrong.toml").rejected_naming(&["adaptive speeds", "2", "0.0001"]);
    assert_eq!(bench.run(&format!("{BASIN} --adaptive-speeds much")).code, Some(2));
    let printed = bench.run(&format!("{BASIN} --adaptive-speeds 0.02 --print-scenario"));
    assert!(printed.stdout.contains("adaptive_speeds = 0.02"), "{printed:?}");
    bench.write("given.toml", printed.stdout);
    let compared = bench.json("basin compare 'a=--scenario given.toml' 'b=--law f'");
    assert_eq!(numbers(&compared["cases"][0]["speeds"]).len(), 6);
    assert_eq!(compared["same_speeds"], true);
}

/// A basin of seconds on one thread.
#[cfg(target_os = "linux")]
const SECONDS: &str = "basin --law h --speeds 0:10:0.2 --search plain --scan-step 1 --threads 1";

/// The text without its last line, which has the computing time.
#[cfg(target_os = "linux")]
fn without_time(text: &str) -> &str {
    text.trim_end().rsplit_once('\n').map_or("", |(before, _)| before)
}

/// Situation: a basin of seconds, at a terminal, at one with few rows, and at no terminal.
/// Action: run, also with `--quiet`, and with JSON for the terminal.
/// Must hold: at the large terminal pictures before the end, of which the first differs from the last; the last text is that
/// without a terminal; at the small one only the last picture; none with the other options.
#[test]
#[cfg(target_os = "linux")]
fn a_terminal_shows_the_picture_early() {
    const TITLE: &str = "initial steer rate [rad/s]";
    let bench = Bench::new(PROGRAM);
    let Run { code, stdout: expected, stderr } = bench.run(SECONDS);
    assert_eq!((code, expected.matches(TITLE).count(), stderr.as_str()), (Some(0), 1, ""));
    let shown = |options: &str, rows| {
        let (code, text) = on_terminal(&mut bench.command(&format!("{SECONDS} {options}")), (rows, 100));
        assert_eq!(code, Some(0), "{text}");
        text
    };
    let large = shown("", 30);
    assert!(without_time(&large).ends_with(without_time(&expected)), "{large}");
    let pictures: Vec<&str> = large.split(TITLE).skip(1).collect();
    assert!((4..1000).contains(&pictures.len()), "{}", pictures.len());
    // Lines of the picture fill the terminal's width.
    let first: Vec<char> = pictures[0].chars().take_while(|c| *c != '\x1b').collect();
    let first: Vec<String> = first.chunks(100).map(|line| line.iter().collect()).collect();
    assert!(first.len() > 14 && first.iter().any(|line| line.contains('█')), "{first:?}");
    let last =
        expected.lines().skip(1).take(14).filter(|line| first.iter().any(|other| other.contains(line)));
    assert!(last.count() < 14, "{first:?}");
    let small = shown("", 20);
    assert_eq!(small.matches(TITLE).count(), 1, "{small}");
    assert_eq!(shown("--quiet", 30), "");
    assert!(!shown("--json", 30).contains(TITLE));
}
