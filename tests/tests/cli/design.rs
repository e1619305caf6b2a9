//! `sim-host design`, with searches so small that they end at once.

use control::Law;
use sim_host::basin::{Axis, Method, Search};
use sim_host::design::{Found, Knots, Plan, Progress, Scenarios, evaluate, evaluate_in, optimise, scenarios};
use sim_host::ride::FallCriterion;
use sim_host::study::trial::Trial;
use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering};
use tests::cli::Bench;
use tests::sets::whole;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// Three speeds, a scan that ends early.
fn coarse() -> Search {
    Search {
        speeds: vec![2.0, 4.5, 7.5],
        axis: Axis::SteerRate,
        max_rate: 12.0,
        scan_step: 1.5,
        tolerance: 0.2,
        method: Method::Fast,
        efforts: false,
    }
}

fn plan(seed: u64, evaluations: u32) -> Plan {
    let knots = Knots::new(3).expect("enough");
    Plan { knots, start: Law::Cl2 { k: 1.0 }, search: coarse(), smoothness: 0.0, seed, evaluations }
}

/// The thesis bicycle without a rider, without sensor delay and with one.
fn trials() -> Vec<Trial> {
    let all = scenarios(FallCriterion::default()).training;
    all.into_iter().filter(|t| !t.scenario.is_ridden()).take(2).collect()
}

fn found(plan: &Plan) -> Found {
    optimise(&trials(), plan, &|_| {}, &|| false).expect("rides").expect("not stopped")
}

/// Situation: a small search from a weak law.
/// Action: run it on one thread and on two, by default with fewer schedules on one.
/// Must hold: the same to the bit; the requested number of schedules; never worse than the start, and better at the
/// end; a shorter search is the beginning of a longer; every improvement is one.
#[test]
fn a_design_is_the_same_for_a_seed_and_a_number_of_schedules() {
    let first = found(&plan(1, 24));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    if whole() {
        assert_eq!(pool.install(|| found(&plan(1, 24))), first);
    }
    assert!(first.complete && first.evaluations == 24);
    assert!(first.worst_area > first.start_area + 0.3, "{first:?}");
    assert!(first.history.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 < w[1].1), "{first:?}");
    let shorter = pool.install(|| found(&plan(1, 12)));
    assert_eq!(first.history[..shorter.history.len()], shorter.history);
    assert!(first.gains.iter().all(|gain| (-10.0..=40.0).contains(gain)));
    let evaluated = evaluate(
        &Scenarios { training: trials(), held_out: Vec::new(), ..scenarios(FallCriterion::default()) },
        &[("it".into(), plan(1, 1).knots.law(&first.gains).expect("in range"))],
        &coarse(),
        &|| {},
        &|| false,
    );
    let areas = evaluated.expect("rides").expect("not stopped").areas;
    let least = areas.iter().map(|of_trial| of_trial[0]).fold(f64::INFINITY, f64::min);
    assert_eq!(least, first.worst_area, "what the search says is what its basins are");
}

/// Situation: a running search.
/// Action: stop it after some schedules, and before the first.
/// Must hold: the best so far, marked as not complete; nothing.
#[test]
fn a_stopped_design_keeps_the_best_so_far() {
    let tried = AtomicU32::new(0);
    let last = Cell::new(Progress { evaluations: 0, best: 0.0 });
    let advanced = |now: Progress| {
        tried.store(now.evaluations, Ordering::SeqCst);
        last.set(now);
    };
    let stop = || tried.load(Ordering::SeqCst) >= 5;
    let found = optimise(&trials(), &plan(1, 1000), &advanced, &stop).expect("rides").expect("some");
    assert!(!found.complete && found.evaluations == 5);
    assert_eq!(last.get(), Progress { evaluations: 5, best: found.worst_area });
    assert_eq!(optimise(&trials(), &plan(1, 1000), &advanced, &|| true).expect("rides"), None);
}

/// Situation: knots, and a law that is not made of them.
/// Action: make laws of their gains.
/// Must hold: the law has those gains at the knots, and zero from a metre per second above the last.
#[test]
fn a_schedule_is_the_table_of_its_knots() {
    let knots = Knots::new(6).expect("enough");
    assert_eq!(knots.speeds(), [2.0, 3.1, 4.2, 5.3, 6.4, 7.5]);
    let h = Law::H { cut: false };
    let gains = knots.gains_of(&h);
    let law = knots.law(&gains).expect("in range");
    for v in knots.speeds() {
        assert!((law.gain(*v) - h.gain(*v)).abs() < 1e-5, "{v}");
    }
    assert_eq!([law.gain(8.5), law.gain(20.0)], [0.0, 0.0]);
    assert!(Knots::new(1).is_err() && Knots::new(9).is_err());
}

/// Situation: the program with a budget of no schedule, then of two.
/// Action: request all outputs; use the law file as --law and as --start.
/// Must hold: the file is a law; the search resumes at its end; documents record the search; a budget too short for one
/// schedule is an error.
#[test]
fn the_law_file_is_a_law_and_a_start() {
    let bench = Bench::new(PROGRAM);
    let small = "design --judge none --coarse 5.5 --knots 3 -q";
    let run = bench.run(&format!("{small} --evaluations 2 --law-file a.toml --json a.json --svg a.svg"));
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(bench.files(), ["a.json", "a.svg", "a.toml"]);
    let document: serde_json::Value = serde_json::from_str(&bench.read("a.json")).expect("JSON");
    assert_eq!(document["evaluations"], 2);
    assert_eq!(document["complete"], true);
    assert_eq!(document["schedule"].as_array().map(Vec::len), Some(4));
    let eigen = bench.json("eigen --law a.toml --speeds 2");
    assert_eq!(eigen["law"]["points"], document["schedule"]);
    let again = bench.json(&format!("{small} --evaluations 1 --start a.toml"));
    assert_eq!(again["start_worst_area"], document["worst_area"]);
    let none = bench.run(&format!("{small} --budget 1ms --law-file b.toml"));
    none.rejected_naming(&["--budget 1ms", "nothing is written"]);
    assert_eq!(bench.files().len(), 3);
}

/// Situation: a design whose rides fall at 10 degrees of roll, and one by default.
/// Action: evaluate one schedule.
/// Must hold: the same start has less area by the stricter fall, and the document names the fall.
#[test]
fn the_fall_of_a_design_is_chosen() {
    let bench = Bench::new(PROGRAM);
    let small = "design --judge none --coarse 5.5 --knots 3 --evaluations 1 -q";
    let (strict, published) = (
        bench.json(&format!("{small} --fall roll=10deg,flat=none")),
        bench.json(&format!("{small} --fall published")),
    );
    let area = |document: &serde_json::Value| document["start_worst_area"].as_f64().expect("an area");
    assert!(area(&strict) > 0.0 && area(&strict) < 0.8 * area(&published), "{strict} {published}");
    assert_eq!(published["fall"]["flat"], serde_json::Value::Null);
    assert!((strict["fall"]["roll_rad"].as_f64().expect("an angle") - 10f64.to_radians()).abs() < 1e-12);
}

/// Situation: invalid options.
/// Action: run.
/// Must hold: rejected before any ride, with option, value and range.
#[test]
fn invalid_options_are_rejected() {
    let bench = Bench::new(PROGRAM);
    for (options, named) in [
        ("--smoothness 11", ["--smoothness 11", "0 to 10"]),
        ("--coarse 6", ["--coarse 6", "0.01 to 5.5"]),
        ("--judge 0", ["--judge 0", "0.01 to 5.5"]),
        ("--start nothing", ["nothing", "no such file"]),
        ("--law-file no/where.toml", ["where.toml", "no folder"]),
        ("--law-file same --json same", ["--json", "--law-file"]),
    ] {
        bench.run(&format!("design {options}")).rejected_naming(&named);
    }
    for usage in ["--knots 9", "--evaluations 0", "--budget 10", "--budget 1e9h", "--seed -1", "--judge some"]
    {
        assert_eq!(bench.run(&format!("design {usage}")).code, Some(2), "{usage}");
    }
    assert!(bench.files().is_empty());
}

/// Situation: two laws in two trials.
/// Action: evaluate them in memory; twice at the same time in one folder; then another law in that folder.
/// Must hold: the same areas to the bit; the folder is a complete sweep without claims; the other law is rejected.
#[test]
fn an_evaluation_is_shared_in_a_folder() {
    let bench = Bench::new(PROGRAM);
    let scenarios =
        Scenarios { training: trials(), held_out: Vec::new(), ..scenarios(FallCriterion::default()) };
    let laws = |k| [("none".into(), Law::None), ("it".into(), Law::Cl2 { k })];
    let alone = evaluate(&scenarios, &laws(2.0), &coarse(), &|| {}, &|| false).expect("rides");
    let steps = sim_host::sweep::Progress { advanced: &|| {}, waits: &|_| {}, stop: &|| false };
    let shared = |k| evaluate_in(&bench.path("judged"), &scenarios, &laws(k), &coarse(), &steps);
    std::thread::scope(|scope| {
        let both = [(); 2].map(|()| scope.spawn(|| shared(2.0).expect("rides")));
        for one in both {
            assert_eq!(one.join().expect("no panic"), alone);
        }
    });
    assert!(bench.path("judged/sweep.json").exists() && !bench.path("judged/claims").exists());
    let status = bench.json("sweep --status judged");
    assert_eq!((&status["cells"], &status["done"]), (&4.into(), &4.into()));
    let other = shared(3.0).expect_err("another law").to_string();
    assert!(other.contains("holds another sweep") && other.contains("the options"), "{other}");
}
