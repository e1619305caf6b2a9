//! Numbers in sentences of the pages are those of the program.

use serde_json::Value;
use tests::cli::{Bench, repository};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A page with single spaces between its words, as lines may break anywhere.
fn page(name: &str) -> String {
    let text = std::fs::read_to_string(repository(name)).expect("a page");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn states(name: &str, sentence: &str) {
    assert!(page(name).contains(sentence), "{name} should state: {sentence}");
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Situation: the basin of the README, whose rides end after 6 s, some of them undecided.
/// Action: the same with 30 s.
/// Must hold: the parts of the undecided rides that recover and fall, and both areas, are those of the README.
#[test]
fn undecided_rides_end_as_the_readme_states() {
    let bench = Bench::new(PROGRAM);
    let [short, long] = ["", "--time-limit 30"].map(|limit| bench.json(&format!("basin {limit}")));
    let outcomes = |document: &Value| -> Vec<Value> {
        let speeds = document["map"]["outcome"].as_array().expect("speeds");
        speeds.iter().flat_map(|rides| rides.as_array().expect("rides").clone()).collect()
    };
    let pairs = outcomes(&short).into_iter().zip(outcomes(&long));
    let later: Vec<Value> =
        pairs.filter(|(at_6_s, _)| at_6_s == "undecided").map(|(_, later)| later).collect();
    let percent = |outcome: &str| {
        100.0 * later.iter().filter(|later| *later == outcome).count() as f64 / later.len() as f64
    };
    let (recovered, fallen) = (percent("recovered"), percent("fallen"));
    states("README.md", &format!("{recovered:.0} % recover within 30 s and {fallen:.0} % fall"));
    let [short, long] = [short, long].map(|document| number(&document["area"]));
    states("README.md", &format!("{short:.1} rad m/s^2 with the limit of 6 s and {long:.1} with 30 s"));
}

/// Situation: the rows of docs/delay.md without compensation, whose rides are of a loop with an estimator.
/// Action: search the same borders with `basin`.
/// Must hold: all but one are within the difference that the page states; that one has the border that it states.
#[test]
fn basins_differ_from_the_delay_page_as_it_states() {
    let bench = Bench::new(PROGRAM);
    let text = std::fs::read_to_string(repository("docs/delay.md")).expect("a page");
    let mut off = Vec::new();
    for (table, rider) in [("won back", ""), ("wrong", ""), ("rider", "--rider smart")] {
        let table = text.split(&format!("<!-- {table} -->")).nth(1).expect("a table");
        let mut rows =
            table.lines().take_while(|line| !line.contains("<!-- end")).filter(|l| l.contains('|'));
        let cells = |row: &str| -> Vec<String> {
            row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
        };
        let speeds = cells(rows.next().expect("a heading"));
        for row in rows.map(cells).filter(|row| row[1] == "none" && !row[0].contains("actuator")) {
            let (bicycle, delay) = row[0].split_once(", ").unwrap_or(("rigid_jason", &row[0]));
            let delay = delay.replace(' ', "");
            for (speed, border) in speeds[2..].iter().zip(&row[2..]) {
                let speed = speed.trim_end_matches(" m/s");
                let options = format!("--bicycle {bicycle} --sensor-delay {delay} --speeds {speed}");
                let run = format!("basin --law h {options} {rider}");
                let found = number(&bench.json(&run)["height"]["upper"][0]);
                off.push((found - border.parse::<f64>().expect("a border"), found, options));
            }
        }
    }
    off.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let (largest, found, options) = &off[0];
    let [largest, next] = [*largest, off[1].0].map(f64::abs);
    states("docs/delay.md", &format!("up to {next:.2} rad/s, and in one by {largest:.2}"));
    states("docs/delay.md", &format!("`sim-host basin {options}` gives {found:.2}"));
}

/// Situation: a motor with time constants down to less than the weights of a step's stages resolve.
/// Must hold: the areas are those of docs/plant.md.
#[test]
fn short_time_constants_act_as_the_plant_page_states() {
    let bench = Bench::new(PROGRAM);
    let area = |ms: &str| {
        let document = bench.json(&format!("basin --speeds 2:8:0.5 --actuator time-constant={ms}ms"));
        format!("{:.3} with {ms} ms", number(&document["area"]))
    };
    let [none, shortest, short, resolved] = ["0", "0.001", "0.1", "0.2"].map(area);
    states("docs/plant.md", &format!("is {none}, {shortest}, {short} and {resolved}"));
}

/// Situation: two riders on the treadmill, pushed with 200 N, at five speeds, six seeds.
/// Must hold: one of them falls, at one speed, as docs/riders.md states.
#[test]
fn strong_pushes_throw_the_riders_that_the_page_names() {
    let bench = Bench::new(PROGRAM);
    let mut falls = Vec::new();
    for rider in ["young", "smart"] {
        for speed in ["2.1", "2.5", "3", "3.5", "4"] {
            let falls_of = |seed: &u32| {
                let line =
                    format!("record --rider {rider} --speed {speed} --pulse 200 --seed {seed} --out x.csv");
                bench.run(&line).code != Some(0)
            };
            if (0..6).any(|seed| falls_of(&seed)) {
                falls.push(format!("`{rider}` at {speed} m/s"));
            }
        }
    }
    assert_eq!(falls.len(), 1, "{falls:?}");
    states("docs/riders.md", &format!("With 200 N only {} falls", falls[0]));
}

/// Situation: the noisy record of docs/riders.md.
/// Action: identify its rider.
/// Must hold: no warning; the signal to noise and the largest error, in standard errors, are those of the page.
#[test]
fn the_record_of_the_page_gives_its_rider() {
    let bench = Bench::new(PROGRAM);
    let text = page("docs/riders.md").replace("\\ ", "");
    let at = text.find("sim-host record --rider young --speed 5 --remnant").expect("the command");
    let command = text[at..].split("```").next().expect("a block").trim_start_matches("sim-host ");
    assert_eq!(bench.run(command).code, Some(0), "{command}");
    let truth: Value = serde_json::from_str(&bench.read("noisy.json")).expect("JSON");
    let document = bench.json("identify noisy.csv --delay 30ms --reduce-until none");
    assert_eq!(document["warnings"], serde_json::json!([]));
    let gains = document["gains"].as_object().expect("gains").iter();
    let errors = gains.map(|(name, gain)| {
        (number(&gain["value"]) - number(&truth["gains"]["gains"][name])) / number(&gain["std_error"])
    });
    let largest = errors.map(f64::abs).fold(0.0, f64::max);
    let to_noise = number(&document["black_box"][0]["signal_to_noise"]);
    let found = format!("within {largest:.1} standard errors, at a signal to noise of {to_noise:.1}");
    states("docs/riders.md", &found);
}
