//! Any file and any option: a result or a reason, never a panic.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use serde_json::Value;
use sim_host::bicycle::{KEYS, catalogue::from_text, linear::Linear};
use std::path::Path;
use tests::cli::{Bench, bicycle_with};
use tests::draws::runner;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A value as in a file: ordinary, odd, or no number.
fn value() -> impl Strategy<Value = String> {
    let odd = [
        "nan",
        "inf",
        "-inf",
        "0",
        "-0.0",
        "1e308",
        "-1e-308",
        "'x'",
        "[1]",
        "{}",
        "true",
        "1e",
        "",
        "99999999999999999999",
    ];
    prop_oneof![
        any::<f64>().prop_map(|x| format!("{x:?}")),
        (-2.0..2.0).prop_map(|x: f64| format!("{x:?}")),
        select(odd.to_vec()).prop_map(str::to_owned)
    ]
}

/// Situation: the example bicycle with one value replaced by anything.
/// Action: load it.
/// Must hold: it loads and its linear model is finite, or the message names the key (the line, if it is no TOML).
#[test]
fn a_bicycle_loads_or_its_key_is_named() {
    let text = |(key, value): (&str, &str)| bicycle_with(key, &format!("{key} = {value}"));
    runner(2000)
        .run(&(select(&KEYS[..]), value()), |(key, value)| {
            match from_text("my", &text((key, &value)), Path::new("my.toml"), None) {
                Ok(bicycle) => {
                    let l = Linear::new(&bicycle.parameters);
                    prop_assert!([l.m, l.c1, l.k0, l.k2].iter().all(|m| m.iter().all(|x| x.is_finite())));
                }
                Err(e) => {
                    let (e, body) = (e.to_string(), key.trim_end_matches(['x', 'y', 'z']));
                    prop_assert!(e.contains("my.toml") && (e.contains(body) || e.contains("TOML")), "{e}");
                }
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: any text as a bicycle file, and the example with bytes changed.
/// Action: load it, whole and as a collection.
/// Must hold: no panic.
#[test]
fn no_text_makes_the_bicycle_loader_panic() {
    let example = bicycle_with("w", "w = 1.02");
    let places = vec((0..example.len(), any::<char>()), 0..4);
    runner(2000)
        .run(&(places, any::<String>()), |(places, noise)| {
            let mut changed: Vec<char> = example.chars().collect();
            for (at, c) in places {
                changed[at] = c;
            }
            for text in [changed.into_iter().collect(), noise] {
                let _ = from_text("my", &text, Path::new("my.toml"), None);
                let _ = from_text("my", &text, Path::new("my.toml"), Some("a"));
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: texts made of the characters of ranges.
/// Action: give them as speeds.
/// Must hold: a usage error, or rising speeds from -30 to 30 m/s.
#[test]
fn speeds_parse_or_are_a_usage_error() {
    let bench = Bench::new(PROGRAM);
    let word = vec(select(&['0', '1', '9', ':', ':', '.', '-', 'e'][..]), 1..9);
    runner(60)
        .run(&word, |word| {
            let word: String = word.into_iter().collect();
            let run = bench.run(&format!("eigen --csv - --speeds {word}"));
            if run.code == Some(0) {
                let cells =
                    run.stdout.lines().skip(3).map(|l| l.split(',').next().unwrap().parse::<f64>().unwrap());
                let speeds: Vec<f64> = cells.collect();
                prop_assert!(speeds.is_sorted_by(|a, b| a < b), "{word}");
                prop_assert!(speeds.iter().all(|v| (-30.0..=30.0).contains(v)), "{word}");
            } else {
                prop_assert!(run.code == Some(2) && run.stderr.contains("--speeds"), "{word}: {run:?}");
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: ranges of whole steps.
/// Action: give them as speeds.
/// Must hold: both ends are there, and every step between.
#[test]
fn ranges_of_whole_steps_include_their_end() {
    let bench = Bench::new(PROGRAM);
    runner(40)
        .run(&(0..1000_u32, 1..60_u32, select(&[0.01, 0.1, 0.25, 0.3][..])), |(from, n, step)| {
            let from = f64::from(from) * 0.01;
            let to = format!("{:.2}", from + f64::from(n) * step);
            let document = bench.json(&format!("eigen --speeds {from:.2}:{to}:{step}"));
            let speeds = document["speeds"].as_array().unwrap();
            prop_assert_eq!(speeds.len(), n as usize + 1);
            prop_assert_eq!(speeds.last().unwrap().as_f64(), to.parse().ok());
            Ok(())
        })
        .unwrap();
}

/// Situation: law tables of any points.
/// Action: use them.
/// Must hold: accepted exactly when speeds rise within +-30 m/s and gains stay within +-200; then
/// the document has the points, else the message names file and key.
#[test]
fn law_tables_are_used_as_given_or_rejected() {
    let bench = Bench::new(PROGRAM);
    let points = vec((-35.0..35.0_f32, -220.0..220.0_f32), 0..5);
    runner(60)
        .run(&(points, any::<bool>()), |(mut points, sorted)| {
            if sorted {
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            let (speeds, gains): (Vec<f32>, Vec<f32>) = points.iter().copied().unzip();
            bench.write("law.toml", format!("speed_m_s = {speeds:?}\ngain_nm_s_rad = {gains:?}\n"));
            let run = bench.run("eigen --speeds 4 --law law.toml --json");
            let fits = !points.is_empty()
                && speeds.is_sorted_by(|a, b| *a + 1e-3 <= *b)
                && speeds.iter().all(|v| v.abs() <= 30.0)
                && gains.iter().all(|k| k.abs() <= 200.0);
            prop_assert_eq!(run.code, Some(if fits { 0 } else { 1 }), "{:?}: {}", points, run.stderr);
            if fits {
                let document: Value = serde_json::from_str(&run.stdout).unwrap();
                let stored: Value = serde_json::from_str(&serde_json::to_string(&points).unwrap()).unwrap();
                prop_assert_eq!(&document["law"]["points"], &stored);
            } else {
                prop_assert!(run.stderr.contains("law.toml: law.table."), "{}", run.stderr);
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: tables of states with cells of all kinds.
/// Action: request accelerations.
/// Must hold: a line of finite numbers for each, or a reason that names file and line.
#[test]
fn tables_of_states_are_answered_line_by_line_or_rejected() {
    let bench = Bench::new(PROGRAM);
    let cell = prop_oneof![
        20 => (-3.0..3.0).prop_map(|x: f64| format!("{x}")),
        1 => value().prop_map(|v| v.replace(',', " ")),
    ];
    let table = vec(vec(cell, 7), 0..4);
    runner(100)
        .run(&table, |rows| {
            let header = "roll,steer,roll_rate,steer_rate,rear_wheel_rate,roll_torque,steer_torque";
            let lines: Vec<String> = rows.iter().map(|r| r.join(",")).collect();
            bench.write("in.csv", format!("{header}\n{}\n", lines.join("\n")));
            let run = bench.run("bicycle accel --bicycle benchmark --states in.csv");
            if run.code == Some(0) {
                let answers: Vec<&str> = run.stdout.lines().skip(1).collect();
                prop_assert_eq!(answers.len(), rows.len());
                for cell in answers.iter().flat_map(|l| l.split(',')) {
                    prop_assert!(cell.parse::<f64>().unwrap().is_finite(), "{cell}");
                }
            } else {
                prop_assert_eq!(run.code, Some(1));
                prop_assert!(run.stderr.starts_with("error: in.csv: line "), "{}", run.stderr);
            }
            Ok(())
        })
        .unwrap();
}
