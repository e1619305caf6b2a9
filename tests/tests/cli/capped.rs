//! Heights that are lower bounds: every comparison marks them, in every output.

use proptest::prelude::*;
use serde_json::Value;
use tests::cli::{Bench, repository};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
const SEARCH: &str = "--scan-step 1 --tolerance 0.5";

/// Situation: law h with 0.5 N m and without limit at 4 and 5 m/s; the second recovers from 4 rad/s, the first does
/// not.
/// Action: compare their basins with a largest rate of 4 rad/s and of 30 rad/s.
/// Must hold: with 4 rad/s the part and the distance are lower bounds in text, document and table; with 30 rad/s,
/// where every ride falls, nothing is marked and the part is larger than the bound.
#[test]
fn a_capped_basin_is_compared_as_a_bound() {
    let bench = Bench::new(PROGRAM);
    let line =
        format!("basin compare 'lim=--law h --torque-limit 0.5' 'free=--law h' --speeds 4:5:1 {SEARCH}");
    let text = bench.run(&format!("{line} --max-rate 4 --csv c.csv --json c.json"));
    let free = text.stdout.lines().find(|l| l.starts_with("free")).expect("a line");
    assert!(free.contains(">= 4.000") && free.contains(">= 1"), "{}", text.stdout);
    assert!(text.stdout.contains("nothing fell up to the largest rate tried"), "{}", text.stdout);
    let capped: Value = serde_json::from_str(&bench.read("c.json")).unwrap();
    let case = &capped["cases"][1];
    assert_eq!((&case["area_capped"], &case["relative_is"]), (&true.into(), &"at_least".into()));
    assert_eq!(
        (&capped["cases"][0]["area_capped"], &capped["rmse_is"][0][1]),
        (&false.into(), &"at_least".into())
    );
    let table = bench.read("c.csv");
    assert!(table.contains("speed_m_s,lim,free,lim_capped,free_capped"), "{table}");
    assert!(table.lines().last().unwrap().ends_with(",false,true"), "{table}");
    let whole = bench.json(&format!("{line} --max-rate 30"));
    assert_eq!(
        (&whole["cases"][1]["area_capped"], &whole["rmse_is"][0][1]),
        (&false.into(), &"measured".into())
    );
    let part = |d: &Value| d["cases"][1]["relative_area"].as_f64().unwrap();
    assert!(part(&whole) > part(&capped) && part(&capped) > 1.0, "{} {}", part(&whole), part(&capped));
}

/// Situation: a sweep of the torque limit whose larger cells recover from the largest rate, and one at a single
/// speed.
/// Action: read text, tables, NetCDF and figures.
/// Must hold: censored cells are marked in each; at one speed the ranking is by height, none of which is zero.
#[test]
fn a_sweep_marks_its_lower_bounds_and_ranks_one_speed_by_height() {
    let bench = Bench::new(PROGRAM);
    let sweep = |speeds: &str, rate: u8, out: &str| {
        let line = format!(
            "sweep --law h --over torque-limit=0.5,7,none --speeds {speeds} --scan-step 1 --tolerance 0.5"
        );
        bench.run(&format!("{line} --max-rate {rate} --out {out}"))
    };
    let text = sweep("4:5:1", 4, "a").stdout;
    assert!(
        text.contains("largest area at least 4.000") && text.contains("2 of 3 cells are lower bounds"),
        "{text}"
    );
    assert!(text.contains(": which is the largest is not known"), "{text}");
    let cells = bench.read("a/sweep.csv");
    let marks: Vec<&str> = cells.lines().skip(3).map(|l| l.rsplit(',').next().unwrap()).collect();
    assert_eq!(marks, ["false", "true", "true"], "{cells}");
    assert!(bench.read("a/figures/area-torque-limit.svg").contains("at least this"));
    assert!(bench.read("a/figures/height-torque-limit.svg").contains("no line in its map"));
    let netcdf = std::fs::read(bench.path("a/sweep.nc")).unwrap();
    assert!(netcdf.windows(11).any(|w| w == b"area_capped"));
    let text = sweep("4", 30, "b").stdout;
    let height = |which: &str| -> f64 {
        let line = text.lines().find(|l| l.starts_with(which)).expect("a line");
        line.split_whitespace().nth(2).unwrap().parse().expect("a height")
    };
    let (largest, smallest) = (height("largest height"), height("smallest height"));
    assert!(largest > smallest && smallest > 0.5 && largest < 30.0, "{text}");
    assert!(!bench.read("b/figures/area-torque-limit.svg").contains("Area"));
}

/// Situation: sweeps of which no, one or all of two cells recover from the largest rate.
/// Action: read the ranking in the text.
/// Must hold: it is marked as unknown where it is unknown, and nowhere else: one lower bound above a measured area is
/// the largest.
#[test]
fn a_ranking_is_unknown_only_between_bounds() {
    let bench = Bench::new(PROGRAM);
    for (limits, rate, ending) in [
        ("0.5,7", 30, ""),
        ("0.5,7", 4, "1 of 2 cells are lower bounds, as nothing fell up to 4 rad/s"),
        (
            "7,none",
            4,
            "2 of 2 cells are lower bounds, as nothing fell up to 4 rad/s: which is the largest and which the smallest is not known",
        ),
    ] {
        let line =
            format!("sweep --law h --over torque-limit={limits} --speeds 4:5:1 {SEARCH} --max-rate {rate}");
        let text = bench.run(&format!("{line} --out {limits}-{rate}")).stdout;
        let last = text.lines().last().unwrap();
        assert!(last == ending || ending.is_empty() && last.starts_with("smallest area "), "{text}");
    }
}

/// Situation: the page on end-stops, whose rider recovers from the largest rate at two of its stops.
/// Action: compute the basins of its first table's last column again.
/// Must hold: each area is the page's, lower bounds are marked as such, others are not.
#[test]
fn the_page_on_end_stops_marks_its_lower_bounds() {
    let bench = Bench::new(PROGRAM);
    let page = std::fs::read_to_string(repository("docs/studies/end-stop.md")).unwrap();
    for (rider, expected) in [("none", false), ("smart", true)] {
        let found = bench.json(&format!(
            "basin --law h --torque-limit 7 --rider {rider} --actuator stop=0.524 --speeds 2:7:1 --max-rate 20 --scan-step 0.5"
        ));
        let row = page.lines().find(|line| line.starts_with(&format!("| rider {rider} |"))).expect("a row");
        let cell = row.split('|').rev().nth(1).unwrap().trim();
        assert_eq!(found["area_capped"], expected, "{rider}");
        let sign = if expected { ">= " } else { "" };
        let area = found["area"].as_f64().unwrap();
        assert!(cell.starts_with(&format!("{sign}{area:.3} ({sign}+")), "{cell} {area}");
    }
}

/// Situation: a plane of steer rate and roll rate whose rays along the roll rate end before a fall, and one that
/// reaches further.
/// Action: read text, document and figure.
/// Must hold: the first is marked in each, the second in none.
#[test]
fn a_plane_marks_its_lower_bounds() {
    let bench = Bench::new(PROGRAM);
    for (most, capped) in [("0.5", true), ("8", false)] {
        let line = format!(
            "basin plane --speed 4 --rays 8 --time-limit 2 --max-roll-rate {most} --svg p.svg --json p.json"
        );
        let run = bench.run(&line);
        let document: Value = serde_json::from_str(&bench.read("p.json")).unwrap();
        let marks = [
            run.stdout.contains("area at least"),
            document["area_capped"] == true,
            bench.read("p.svg").contains("no fall up to the largest rates tried"),
        ];
        assert_eq!(marks, [capped; 3], "{most}: {}", run.stdout);
    }
}

/// Situation: a study of one sweep, searched up to a rate from which its reference recovers.
/// Action: make its page.
/// Must hold: the threshold for 95 % is rejected, parts are marked as bounds; with a larger rate neither.
#[test]
fn a_study_rejects_95_percent_of_a_bound() {
    let bench = Bench::new(PROGRAM);
    let page = |rate: u8| {
        bench.write(
            "s.toml",
            format!(
                "title='t'\nquestion='q'\n[[sweep]]\nname='a'\ntitle='t'\nunit='N m'\nalong='torque-limit'\n\
                 options='--law h --speeds 4:5:1 --scan-step 1 --tolerance 0.5 --max-rate {rate}'\n\
                 over=['torque-limit=0.5,0.6,2,none']\nreference={{torque-limit='none'}}\n"
            ),
        );
        let run = bench.run(&format!("study s.toml --out out{rate} -q"));
        assert_eq!(run.code, Some(0), "{run:?}");
        bench.read(&format!("out{rate}/studies/s.md"))
    };
    let capped = page(4);
    assert!(capped.contains("not known: capped") && capped.contains("| >= 4.00 |"), "{capped}");
    assert!(capped.contains("<= ") && capped.contains("~ 100.0 %"), "{capped}");
    let whole = page(30);
    assert!(!whole.contains("capped") && !whole.contains(">=") && !whole.contains("<="), "{whole}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    /// Situation: two basins from files, with heights and caps at random.
    /// Action: compare them.
    /// Must hold: the true part and distance, drawn at random beyond each cap, never contradict the bounds.
    #[test]
    fn no_comparison_of_bounds_without_a_mark(
        heights in prop::collection::vec((0.5..8.0f64, 0.5..8.0f64), 2..5),
        cap in 1.0..9.0f64,
        other_cap in 1.0..9.0f64,
        caps_differ in any::<bool>(),
    ) {
        let bench = Bench::new(PROGRAM);
        let caps = (cap, if caps_differ { other_cap } else { cap });
        let speeds: Vec<f64> = (0..heights.len()).map(|i| 2.0 + i as f64).collect();
        let file = |name: &str, true_heights: Vec<f64>, cap: f64| {
            let upper: Vec<f64> = true_heights.iter().map(|h| h.min(cap)).collect();
            let capped: Vec<bool> = true_heights.iter().map(|h| *h > cap).collect();
            let document = serde_json::json!({"speeds": speeds, "height": {"upper": upper}, "capped": capped,
                "search": {"axis": "steer-rate"}, "config": {}});
            bench.write(name, document.to_string());
            capped.contains(&true)
        };
        let a: Vec<f64> = heights.iter().map(|h| h.0).collect();
        let b: Vec<f64> = heights.iter().map(|h| h.1).collect();
        let (a_capped, b_capped) = (file("a.json", a.clone(), caps.0), file("b.json", b.clone(), caps.1));
        let found = bench.json("basin compare a.json b.json");
        let text = bench.run("basin compare a.json b.json").stdout;
        prop_assert_eq!(a_capped || b_capped, text.contains("nothing fell up to"), "{}", text);
        let area = |h: &[f64]| h.windows(2).map(|w| 0.5 * (w[0] + w[1])).sum::<f64>();
        let rmse = (a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64).sqrt();
        let holds = |is: &Value, stated: &Value, truth: f64| {
            let stated = stated.as_f64().expect("a number");
            match is.as_str().expect("a bound") {
                "measured" => (stated - truth).abs() < 1e-9,
                "at_least" => truth >= stated - 1e-9,
                "at_most" => truth <= stated + 1e-9,
                _ => true,
            }
        };
        let second = &found["cases"][1];
        prop_assert!(holds(&second["relative_is"], &second["relative_area"], area(&b) / area(&a)), "{}", second);
        prop_assert!(holds(&found["rmse_is"][0][1], &found["rmse"][0][1], rmse), "{}", found);
        let marked = second["relative_is"] != "measured";
        prop_assert_eq!(marked, a_capped || b_capped);
    }
}
