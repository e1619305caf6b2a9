//! `sim-host identify RECORD --report`: the page of an identified rider.

use serde_json::Value;
use tests::cli::Bench;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
const SECTIONS: [&str; 11] = [
    "fitted",
    "gains",
    "not-identified",
    "signals",
    "residuals",
    "impulse-response",
    "reduction",
    "optima",
    "delay",
    "command",
    "rider-file",
];
/// A fit of a second.
const QUICK: &str = "--feedback K_phi_d,K_delta_p,K_delta_d --linear";

fn bench(records: &[&str]) -> Bench {
    let bench = Bench::new(PROGRAM);
    for (seed, name) in records.iter().enumerate() {
        let line = format!(
            "record --rider young --speed 4.3 --rate 100 --duration 30 --steer-noise 0.001 --seed {seed}"
        );
        let run = bench.run(&format!("{line} --out '{name}'"));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
    }
    bench
}

/// The first tag that does not match the ones before it; `None` on a well-formed page.
fn unmatched(page: &str) -> Option<&str> {
    let mut open: Vec<&str> = Vec::new();
    for tag in page.split('<').skip(1) {
        let tag = &tag[..tag.find('>')?];
        let name = tag.split([' ', '/', '\n']).find(|name| !name.is_empty()).unwrap_or("");
        match tag {
            _ if tag.starts_with('!') || tag.ends_with('/') || name == "meta" => {}
            _ if tag.starts_with('/') => {
                if open.pop() != Some(name) {
                    return Some(tag);
                }
            }
            _ => open.push(name),
        }
    }
    open.pop()
}

/// Situation: a record and a fit with a profile of the delay.
/// Action: write the report, twice.
/// Must hold: all sections in their order; the gains, errors and the rider of the other outputs, to the last digit; figures; the
/// command; well-formed, nothing from elsewhere, no folder of the machine; the same bytes.
#[test]
fn a_report_is_complete_and_self_contained() {
    let bench = bench(&["a & b.csv"]);
    let line = format!(
        "identify 'a & b.csv' {QUICK} --delay-profile 20:40:10 --select bic --report r.html --json r.json --out r.toml -q"
    );
    let run = bench.run(&line);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let page = bench.read("r.html");

    let places: Vec<usize> = SECTIONS
        .iter()
        .map(|name| page.find(&format!("<section id=\"{name}\">")).unwrap_or_else(|| panic!("{name}")))
        .collect();
    assert!(places.is_sorted() && page.matches("<section").count() == SECTIONS.len());
    let document: Value = serde_json::from_str(&bench.read("r.json")).expect("JSON");
    let gains = document["gains"].as_object().expect("gains");
    assert!((1..=3).contains(&gains.len()));
    for (name, gain) in gains {
        assert!(page[places[1]..places[2]].contains(&format!("<td>{name}</td>")), "{name}");
        for key in ["value", "std_error"] {
            let exact = gain[key].as_f64().expect("a number");
            assert!(
                page[places[1]..places[2]].contains(&format!("<data value=\"{exact}\">")),
                "{name} {exact}"
            );
        }
    }
    let selected = document["selected"].as_u64().expect("an index");
    assert_eq!(page.matches(&format!("<b>{selected}, selected</b>")).count(), 1);
    assert_eq!(page.matches("<figure>").count(), 6);
    let escaped = |text: &str| {
        text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
    };
    assert!(page.contains(&escaped(&bench.read("r.toml"))));
    let command = page[places[9]..].split("<pre>").nth(1).and_then(|text| text.split("</pre>").next());
    let command = command.expect("a command").replace("&amp;", "&");
    assert_eq!(shlex::split(&command), shlex::split(&format!("sim-host {line}")));
    assert!(page.contains(document["record"]["sha256"].as_str().expect("a hash")));

    assert_eq!(unmatched(&page), None);
    for elsewhere in ["src=", "<script", "@import", "<link", "url(http", "href=\"http", "href=\"/", "NaN"] {
        assert!(!page.contains(elsewhere), "{elsewhere}");
    }
    let folder = bench.path("").display().to_string();
    assert!(!page.contains(folder.trim_end_matches('/')), "{folder}");
    let mut ids: Vec<&str> = page.split(" id=\"").skip(1).filter_map(|s| s.split('"').next()).collect();
    let all = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), all);
    bench.run(&line);
    assert!(bench.read("r.html") == page);
}

/// Situation: two records, one of them with several signals, and a folder for the results.
/// Action: identify both, then one of them again.
/// Must hold: a page for each, beside its document; the finished page is the report of the second run.
#[test]
fn a_folder_has_a_report_for_each_record() {
    let bench = bench(&["one.csv", "two.csv"]);
    let options = format!("{QUICK} --fit steer,roll-rate --reduce-until none --results found -q");
    let run = bench.run(&format!("identify one.csv two.csv {options}"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for name in ["one", "two"] {
        let page = bench.read(&format!("found/{name}.html"));
        assert!(page.contains(&format!("Rider identified from {name}.csv")) && unmatched(&page).is_none());
        assert!(!page.contains("<section id=\"delay\">") && page.contains("roll-rate with itself"));
    }
    let run = bench.run(&format!("identify two.csv {options} --report again.html"));
    assert!(run.code == Some(0) && run.stderr.contains("not fitted again"), "{}", run.stderr);
    assert!(bench.read("again.html") == bench.read("found/two.html"));
}

/// Situation: a report of two records, or in the place of another output. Must hold: rejected before anything is fitted.
#[test]
fn a_report_is_of_one_record_in_a_place_of_its_own() {
    let bench = bench(&["one.csv", "two.csv"]);
    let files = bench.files();
    for (line, named) in [
        ("one.csv two.csv --report r.html", &["--report", "one record", "--results"][..]),
        ("one.csv --report r --json r", &["--json and --report", "same place"]),
        ("one.csv --report r --out r", &["--out and --report", "same place"]),
        ("one.csv --report missing/r.html", &["missing"]),
    ] {
        bench.run(&format!("identify {line}")).rejected_naming(named);
    }
    assert_eq!(bench.files(), files);
}
