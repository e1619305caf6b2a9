//! `sim-host study` and `sim-host studies`: one command for every question answered by a page.

use crate::sweep::must;
use tests::cli::Bench;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A study of two small sweeps.
const STUDY: &str = r#"
title = "Little"
question = "Is it?"
[[sweep]]
name = "torque"
title = "Torque"
options = "--law h --speeds 4:5:1 --max-rate 12 --scan-step 2 --tolerance 0.1 --time-limit 1.5"
over = ["torque-limit=0.5:20/log4,none"]
reference = { torque-limit = "none" }
along = "torque-limit"
[[sweep]]
name = "laws"
title = "Laws"
options = "--speeds 4:5:1 --max-rate 12 --scan-step 2 --tolerance 0.1 --time-limit 1.5"
over = ["rider=none,smart", "law=h,f"]
reference = { law = "h" }
along = "law"
"#;

/// Situation: a user's study, of an axis of numbers and one of texts.
/// Action: compute it, and again.
/// Must hold: the page has both answers with the numbers of the sweeps' tables, and its figures; computed again, only
/// the time taken is missing.
#[test]
fn a_study_is_answered_by_a_page() {
    let bench = Bench::new(PROGRAM);
    bench.write("little.toml", STUDY);
    let output = must(&bench, "study little.toml --out s --pages p");
    assert_eq!(output, "p/studies/little.md\n");
    let page = bench.read("p/studies/little.md");
    for texts in ["# Little\n", "## Torque\n", "--over torque-limit=0.5:20/log4,none", "| rider smart | "] {
        assert!(page.contains(texts), "{texts}: {page}");
    }
    let figures: Vec<&str> =
        page.split("](../").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    assert_eq!(figures, ["img/studies/little-torque.svg", "img/studies/little-laws.svg"]);
    for figure in figures {
        assert!(bench.read(&format!("p/{figure}")).starts_with("<svg"));
    }
    let table = bench.read("s/torque/sweep.csv");
    let area = |value: &str| -> f64 {
        let row = table.lines().find(|l| l.starts_with(&format!("{value},"))).unwrap();
        row.split(',').nth(1).unwrap().parse().unwrap()
    };
    let part = |value| 100.0 * area(value) / area("none");
    assert!(page.contains(&format!("| {:.2} | ", area("none"))), "{page}");
    assert!(page.contains(&format!("| {:.1} %, ", part("20"))), "{page}");
    let (lost, left) = (part("0.5"), part("20"));
    assert!(page.contains(&format!(", {lost:.1} % |")), "{page}");
    assert!(lost < 95.0 && left >= 95.0, "{lost} {left}");
    must(&bench, "study little.toml --out s --pages p -q");
    let again = bench.read("p/studies/little.md");
    let timeless = |page: &str| page.lines().filter(|l| !l.starts_with("This page")).collect::<String>();
    assert!(page.contains(" min on ") && !again.contains(" min on "));
    assert_eq!(timeless(&page), timeless(&again));
}

/// Situation: the shipped studies.
/// Action: list them.
/// Must hold: one list of all, each with its question.
#[test]
fn studies_are_listed_with_their_questions() {
    let bench = Bench::new(PROGRAM);
    let list = must(&bench, "studies");
    let heads: Vec<&str> = list.lines().filter(|l| !l.starts_with(' ')).collect();
    let names: Vec<&str> = heads.iter().map(|l| l.split(' ').next().unwrap()).collect();
    let shipped = ["limits", "imu", "compensate", "tracking", "speed", "sensors", "end-stop"];
    assert_eq!(names, [&["balance-assist", "equal-vaf", "prototype"], &shipped[..]].concat());
    for head in heads {
        let (_, question) = list.split_once(&format!("{head}\n    ")).unwrap();
        assert!(question.split_once("\n").is_some_and(|(line, _)| line.len() > 20), "{head}: {question}");
    }
}

/// Situation: studies that are wrong, do not exist, or do not have such an option.
/// Action: compute them.
/// Must hold: file, sweep, option and value named; no file is left.
#[test]
fn wrong_studies_are_named() {
    let bench = Bench::new(PROGRAM);
    bench
        .run("study nothing")
        .rejected_naming(&["`nothing`", "balance-assist, equal-vaf, prototype, limits, imu"]);
    bench.run("study imu --quick").rejected_naming(&["--quick", "study imu", "prototype"]);
    bench.write("a.toml", STUDY.replace("law=h,f\"", "law=h,q\""));
    bench.run("study a.toml").rejected_naming(&["study a.toml, sweep laws", "cell rider=none, law=q"]);
    bench.write("a.toml", STUDY.replace("--law h --speeds", "--law h --speed"));
    bench.run("study a.toml").rejected_naming(&["study a.toml, sweep torque", "--speed"]);
    bench.write("a.toml", STUDY.replace("along = \"law\"", "along = \"rider\""));
    bench.run("study a.toml").rejected_naming(&["study a.toml", "sweep laws", "`rider`"]);
    bench.write("a.toml", STUDY.replace("{ law = \"h\" }", "{ law = [\"h\"] }"));
    bench.run("study a.toml").rejected_naming(&[
        "study a.toml: TOML parse error",
        "law",
        "expected a string",
    ]);
    bench.run("study balance-assist --pages a.toml").rejected_naming(&["can't make a.toml/studies"]);
    assert_eq!(bench.files(), ["a.toml"]);
}
