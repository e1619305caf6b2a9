//! Faults injected into a recording.

use super::{bench, cause, number};
use serde_json::Value;

/// Situation: a gentle ride of 4 s without faults.
/// Action: replay it; without the gyro from 2 s on; for a while only.
/// Must hold: no fault is detected without; with it cause 1 comes within 20 ms after its time and never before; the
/// mode is fault, and after the fault has ended it is engaged again.
#[test]
fn a_fault_acts_at_its_time() {
    let bench = bench(800);
    let replay = |more: &str| bench.json(&format!("replay ride.csv --map extract {more}"));
    let alarms = |document: &Value| -> Vec<f64> {
        let causes = document["causes"].as_array().unwrap();
        causes.iter().filter(|cause| cause["alarms"] != 0).map(|cause| number(&cause["number"])).collect()
    };
    let whole = replay("");
    assert_eq!(alarms(&whole), [0.0; 0], "{}", whole["causes"]);
    assert!((3.3..3.7).contains(&number(&whole["engaged_s"])), "{}", whole["engaged_s"]);
    let lost = replay("--fault gyro:missing@2s");
    assert_eq!(alarms(&lost), [1.0]);
    let (mode, from_s) = last_mode(&lost);
    assert_eq!(mode, "fault");
    assert!((2.005..2.02).contains(&from_s), "{from_s}");
    assert!((1.45..1.65).contains(&number(&lost["engaged_s"])), "{}", lost["engaged_s"]);
    let while_ = replay("--fault gyro:missing@2s..2500ms");
    let (mode, from_s) = last_mode(&while_);
    assert_eq!(mode, "engaged");
    assert!((2.7..3.2).contains(&from_s), "{from_s}");
    let once = replay("--fault gyro:missing@2s..2500ms --press once");
    assert_ne!(last_mode(&once).0, "engaged");
    assert!(number(&cause(&once, 53).unwrap()["total_s"]) > 1.0);
}

fn last_mode(document: &Value) -> (&str, f64) {
    let last = document["modes"].as_array().unwrap().last().unwrap();
    (last["mode"].as_str().unwrap(), number(&last["from_s"]))
}

/// Situation: the same ride.
/// Action: a fault of another kind on another sensor; an invalid one.
/// Must hold: the cause of that sensor once its last good sample is older than 20 ms; the invalid one is rejected
/// with the allowed texts.
#[test]
fn faults_of_other_sensors() {
    let bench = bench(800);
    let document = bench.json("replay ride.csv --map extract --fault steer:value=1.7@2s");
    let range = cause(&document, 10).expect("out of range");
    assert!((2.0..2.021).contains(&number(&range["first_s"])), "{range}");
    let peak_nm = number(&document["peak_torque_nm"]);
    assert!((0.05..3.0).contains(&peak_nm), "{peak_nm}");
    bench.run("replay ride.csv --map extract --fault gyro:melts@2s").rejected_naming(&["--fault", "melts"]);
}

/// Situation: a ride of 4 s with gyro, accelerometer, steer and wheels.
/// Action: replay it, alone and beside another, with faults of a sensor that was not recorded, of one that the preset
/// does not have, after the end, between two control instants and of the motor; with one of the gyro.
/// Must hold: the first four are told with the recording and the reason, in the document as well; the motor's is refused as wrong
/// usage; the gyro's is not told.
#[test]
fn faults_that_cannot_act_are_told() {
    let bench = bench(800);
    bench.write("other.csv", bench.read("ride.csv"));
    for (options, reason) in [
        ("--fault path:missing", "the recording has no such sensor"),
        ("--preset thesis --fault steer:nan", "--set input.steer.fitted=on"),
        ("--fault gyro:stuck@100s", "it begins at 100 s, and the end is at 3.996 s"),
        ("--fault gyro:stuck@0.1ms..0.2ms", "no control instant is in its time"),
    ] {
        let run = bench.run(&format!("replay ride.csv --map extract {options} --json"));
        let document: Value = serde_json::from_str(&run.stdout).unwrap_or_else(|_| panic!("{run:?}"));
        let recorded = document["without_effect"].to_string();
        for text in [&run.stderr, &recorded] {
            assert!(text.contains("has no effect: ") && text.contains(reason), "{options}: {text}");
        }
        let run = bench.run(&format!("replay ride.csv other.csv --map extract {options}"));
        let told = |file: &str| run.stderr.contains(&format!("warning: {file}: the fault "));
        assert!(run.code == Some(0) && told("ride.csv") && told("other.csv"), "{run:?}");
    }
    let run = bench.run("replay ride.csv --map extract --fault motor:dead");
    assert!(run.code == Some(2) && run.stderr.contains("--fault: motor faults have no effect"), "{run:?}");
    let run = bench.run("replay ride.csv --map extract --fault gyro:stuck@3s");
    assert!(run.code == Some(0) && run.stderr.is_empty(), "{run:?}");
}
