//! Complete recordings of real bicycles, where they are available. The tables are those of docs/safety.md.

use super::{PROGRAM, number};
use rayon::prelude::*;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use tests::cli::{Bench, word};
use tests::detection::{LAST_FAULT, rows_of};

const PAGE: &str = include_str!("../../../docs/safety.md");
/// Folders of the recordings, and their maps.
const SETS: [(&str, &str); 2] = [("robot", "robot-bicycle"), ("sbw", "extract")];
/// Recordings of rides with a real fault.
const BROKEN: [&str; 2] = ["2013-07-13_007.csv.gz", "2013-07-13_019.csv.gz"];

/// The recordings of a set, by name; `STEER_ASSIST_RIDE_RECORDINGS` names the folder of the sets, which are not
/// shipped.
fn recordings(set: &str) -> Option<Vec<PathBuf>> {
    let folder = std::env::var_os("STEER_ASSIST_RIDE_RECORDINGS").map(PathBuf::from).filter(|f| f.is_dir());
    let Some(folder) = folder else {
        println!("skipped: STEER_ASSIST_RIDE_RECORDINGS names no folder of recordings (docs/testing.md)");
        return None;
    };
    let entries = std::fs::read_dir(folder.join(set)).expect("a folder").map(|e| e.expect("an entry").path());
    let files: BTreeSet<PathBuf> = entries.filter(|f| f.extension().is_some_and(|e| e == "gz")).collect();
    assert!(files.len() >= 5, "{} files", files.len());
    Some(files.into_iter().collect())
}

fn replayed(file: &Path, map: &str, faults: &str) -> Value {
    let faults: String =
        faults.split(' ').filter(|f| !f.is_empty()).map(|f| format!(" --fault {f}@0s")).collect();
    Bench::new(PROGRAM).json(&format!("replay {} --map {map}{faults}", word(file)))
}

/// Number of beginnings of each cause that reports a fault.
fn counts(document: &Value, of: &str) -> BTreeMap<u64, u64> {
    let causes = document["causes"].as_array().expect("causes").iter();
    let whole = |cause: &Value, key: &str| cause[key].as_u64().expect("a whole number");
    let pairs = causes.map(|cause| (whole(cause, "number"), whole(cause, of)));
    pairs.filter(|(code, count)| *code <= u64::from(LAST_FAULT.code()) && *count > 0).collect()
}

/// Number of recordings in which a fault adds a cause, total number, and the causes, the most frequent first.
fn detected(files: &[PathBuf], map: &str, faults: &str) -> [String; 2] {
    let added = |file: &PathBuf| -> Vec<u64> {
        let [without, with] = ["", faults].map(|faults| counts(&replayed(file, map, faults), "count"));
        with.into_iter()
            .filter(|(code, n)| *n > without.get(code).copied().unwrap_or(0))
            .map(|(code, _)| code)
            .collect()
    };
    let added: Vec<Vec<u64>> = files.par_iter().map(added).collect();
    let mut often: BTreeMap<u64, usize> = BTreeMap::new();
    added.iter().flatten().for_each(|code| *often.entry(*code).or_default() += 1);
    let mut often: Vec<(u64, usize)> = often.into_iter().collect();
    often.sort_by_key(|(code, n)| (std::cmp::Reverse(*n), *code));
    let codes: Vec<String> = often.iter().map(|(code, _)| code.to_string()).collect();
    let rides = added.iter().filter(|codes| !codes.is_empty()).count();
    let codes = if codes.is_empty() { "-".to_owned() } else { codes.join(", ") };
    [format!("{rides} of {}", files.len()), codes]
}

fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

/// Situation: recorded rides without faults.
/// Action: replay each with a fault from its first moment on.
/// Must hold: the number of rides in which it is detected, and the causes, are those of the table.
#[test]
fn faults_in_recorded_rides() {
    let [Some(robot), Some(sbw)] = SETS.map(|(set, _)| recordings(set)) else { return };
    let robot: Vec<PathBuf> =
        robot.into_iter().filter(|f| !BROKEN.iter().any(|name| f.ends_with(name))).collect();
    let rows = rows_of(PAGE, "whole rides");
    assert!(rows.len() > 8);
    let should: Vec<String> = rows
        .iter()
        .map(|row| {
            let faults = cells(row)[0];
            let [a, b] = [(&robot, SETS[0].1), (&sbw, SETS[1].1)]
                .map(|(files, map)| detected(files, map, &faults.replace('`', "")));
            format!("| {faults} | {} | {} | {} | {} |", a[0], a[1], b[0], b[1])
        })
        .collect();
    assert!(rows == should, "docs/safety.md should have:\n{}", should.join("\n"));
}

/// Situation: recorded rides.
/// Action: replay each unchanged.
/// Must hold: the number of alarms of each cause, in all and in an hour of riding, is that of the table, and no other
/// cause occurs.
#[test]
fn false_alarms_in_recorded_rides() {
    let mut columns = Vec::new();
    for (set, map) in SETS {
        let Some(files) = recordings(set) else { return };
        let documents: Vec<Value> = files.par_iter().map(|file| replayed(file, map, "")).collect();
        let hours = documents.iter().map(|d| number(&d["riding_s"])).sum::<f64>() / 3600.0;
        let mut alarms: BTreeMap<u64, u64> = BTreeMap::new();
        for (code, n) in documents.iter().flat_map(|d| counts(d, "alarms")) {
            *alarms.entry(code).or_default() += n;
        }
        columns.push((alarms, hours));
    }
    let rows = rows_of(PAGE, "false alarms");
    let code = |row: &str| cells(row)[0].split(' ').next().and_then(|code| code.parse().ok());
    let output: BTreeSet<u64> = rows.iter().filter_map(|row| code(row)).collect();
    let happened: BTreeSet<u64> = columns.iter().flat_map(|(alarms, _)| alarms.keys().copied()).collect();
    assert_eq!(output, happened);
    let should: Vec<String> = rows
        .iter()
        .map(|row| {
            let often =
                columns.iter().map(|(alarms, hours)| match code(row).and_then(|code| alarms.get(&code)) {
                    Some(n) => format!("{n}, {:.0} an hour", *n as f64 / hours),
                    None => "0".into(),
                });
            let often: Vec<String> = often.collect();
            format!("| {} | {} | {} |", cells(row)[0], often.join(" | "), cells(row)[3])
        })
        .collect();
    assert!(rows == should, "docs/safety.md should have:\n{}", should.join("\n"));
}
