//! Every command accepts the bicycles that `bicycle check` accepts.

use proptest::prelude::*;
use serde_json::json;
use tests::cli::{Bench, bicycle_with};
use tests::draws::runner;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A self-balancing model, 1:4.
const ROBOT: &str = "w = 0.27\nc = 0.015\nlam = 0.314\ng = 9.81\nrR = 0.08\nmR = 0.12\nIRxx = 0.00025\nIRyy = 0.0005\n\
    xB = 0.12\nzB = -0.16\nmB = 1.6\nIBxx = 0.006\nIByy = 0.012\nIBzz = 0.009\nIBxz = 0.001\nxH = 0.24\nzH = -0.17\n\
    mH = 0.15\nIHxx = 0.0004\nIHyy = 0.0004\nIHzz = 0.0001\nIHxz = -0.00005\nrF = 0.08\nmF = 0.12\nIFxx = 0.00025\nIFyy = 0.0005\n";

/// A short run of each command that rides.
const COMMANDS: [&str; 6] = [
    "ride --law none --speed 4 --steer-rate 0.1 --time-limit 0.3",
    "ride --law h --assist ideal --speed 4 --steer-rate 0.1 --time-limit 0.3",
    "ride --law h --speed 4 --steer-rate 0.1 --time-limit 0.3",
    "ride --preset product --speed 4 --steer-rate 0.1 --time-limit 0.3",
    "basin --preset product --speeds 4 --max-rate 1 --scan-step 1 --tolerance 1 --time-limit 0.3",
    "eigen --speeds 4",
];

/// The example with several lines replaced.
fn changed(lines: &[(&str, f64)]) -> String {
    let mut text = bicycle_with("w", "w = 1.02");
    for (key, value) in lines {
        let start = format!("{key} = ");
        let line = |l: &str| if l.starts_with(&start) { format!("{start}{value}") } else { l.to_owned() };
        text = text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n";
    }
    text
}

/// Situation: a 1:4 model, an optimised bicycle with a short wheelbase, a long cargo bicycle, a steep tilt, a trail
/// longer than the wheelbase.
/// Action: check each, then every command that rides, with and without the flashed code; a sweep over bicycles.
/// Must hold: all run. Where the flashed code does not fit, a note names file, parameter, value, range and the
/// equivalent option, and the check reports it before.
#[test]
fn model_cargo_and_optimised_bicycles_ride() {
    let bench = Bench::new(PROGRAM);
    bench.write("robot.toml", ROBOT);
    bench.write("short.toml", changed(&[("w", 0.41)]));
    bench.write("long.toml", changed(&[("w", 3.4), ("xH", 3.2)]));
    bench.write("tilted.toml", changed(&[("lam", 1.05)]));
    bench.write("trail.toml", changed(&[("w", 0.41), ("c", 0.75)]));
    for name in ["robot", "short", "long", "tilted", "trail"] {
        for line in ["bicycle check"].into_iter().chain(COMMANDS) {
            let run = bench.run(&format!("{line} --bicycle {name}.toml"));
            assert_eq!(run.code, Some(0), "{line} {name}: {}", run.stderr);
        }
    }
    let note = "response.motor.per_nm = 2027";
    let output = bench.run(&format!("{} --bicycle robot.toml", COMMANDS[3])).stderr;
    for word in ["robot.toml", note, "0.1 to 100", "--set response.motor=off"] {
        assert!(output.contains(word), "{output}");
    }
    let check = bench.json("bicycle check --bicycle robot.toml");
    assert!(check["flashed_off"][0].as_str().unwrap().contains(note), "{check}");
    assert_eq!(bench.json("bicycle check")["flashed_off"], json!([]));
    let free = bench.run(&format!("{} --bicycle robot.toml", COMMANDS[0]));
    assert_eq!(free.stderr, "");
    bench.run("ride --speed 4 --bicycle trail.toml --set predict.lead_s=0.02").rejected_naming(&[
        "trail.toml",
        "estimate.pitch",
        "-1 to 1",
        "--assist ideal",
    ]);
    let sweep = "sweep --over bicycle=benchmark,robot.toml --law h --speeds 4 --max-rate 1 --scan-step 1 --time-limit 0.3 --out s";
    assert_eq!(bench.run(sweep).code, Some(0));
}

/// Situation: a parameter that is fitted to the bicycle, set by hand.
/// Action: ride with it.
/// Must hold: the set value is in the configuration; one out of range is rejected by its name.
#[test]
fn a_set_parameter_overrides_the_fitted_one() {
    let bench = Bench::new(PROGRAM);
    let line = "ride --preset product --speed 4 --time-limit 0.1 --set cross.wheelbase_m=0.9";
    assert_eq!(bench.run(line).code, Some(0));
    let set = "ride --preset product --speed 4 --time-limit 0.1 --set estimate.pitch.steer2=0.125";
    assert_eq!(bench.run(set).code, Some(0));
    bench
        .run("ride --speed 4 --set cross.wheelbase_m=9")
        .rejected_naming(&["cross.wheelbase_m = 9", "0.1 to 5"]);
}

/// Situation: random bicycles inside the ranges of their file.
/// Action: check each; a valid one rides by every command.
/// Must hold: every command accepts the bicycles that the check accepts; a rejection names the file and its key.
#[test]
fn random_bicycles_are_taken_by_all_commands_or_named() {
    let bench = Bench::new(PROGRAM);
    let (w, lam, c, scale) = (0.1..5.0f64, -1.0..1.4f64, -1.0..1.0f64, 0.0..1.0f64);
    let one = (w, lam, c, scale, 0.02..1.5f64, 0.02..1.5f64, -3.0..5.0f64, -3.0..-0.05f64, -1.0..1.0f64);
    let result = runner(12).run(&one, |(w, lam, c, scale, rear, front, x, z, product)| {
        // From a toy of 100 g to a cargo bicycle of 500 kg.
        let mass = 0.1 * 5000f64.powf(scale);
        let lines = [
            ("w", w),
            ("lam", lam),
            ("c", c),
            ("rR", rear),
            ("rF", front),
            ("xB", x),
            ("zB", z),
            ("mB", mass),
            ("IBxx", 0.1 * mass * z * z),
            ("IByy", 0.15 * mass * z * z),
            ("IBzz", 0.08 * mass * z * z),
            ("IBxz", 0.1 * product * mass * z * z),
            ("mH", 0.05 * mass),
            ("xH", w),
            ("zH", z),
            ("IHxx", 0.005 * mass * z * z),
            ("IHyy", 0.005 * mass * z * z),
            ("IHzz", 0.001 * mass * z * z),
            ("IHxz", 0.0),
        ];
        bench.write("any.toml", changed(&lines));
        let check = bench.run("bicycle check --bicycle any.toml");
        if check.code != Some(0) {
            prop_assert!(
                check.stderr.contains("any.toml") && check.stderr.contains("`IBxz`"),
                "{}",
                check.stderr
            );
            return Ok(());
        }
        for line in COMMANDS {
            let run = bench.run(&format!("{line} --bicycle any.toml"));
            prop_assert_eq!(run.code, Some(0), "{}: {}", line, run.stderr);
        }
        Ok(())
    });
    result.unwrap();
}

/// Situation: bicycles whose steer is neutral at rest, where the real part of the pair of eigenvalues is rounding;
/// and the shipped ones.
/// Action: check trails close to each other; read the stable ranges.
/// Must hold: the critical speeds do not jump between none and zero; check and list print the stable ranges.
#[test]
fn critical_speeds_do_not_hang_on_rounding() {
    let bench = Bench::new(PROGRAM);
    for c in [-0.52, -0.51, -0.50, -0.49, -0.48, -0.47] {
        bench.write("c.toml", changed(&[("c", c)]));
        let check = bench.json("bicycle check --bicycle c.toml");
        for speed in ["v_d", "v_w", "v_c"] {
            assert!(check[speed].is_null(), "c = {c}: {speed} = {}", check[speed]);
        }
        assert_eq!(check["stable_ranges"], json!([]), "c = {c}");
        assert_eq!(check["stable_ranges"], bench.json("eigen --speeds 4 --bicycle c.toml")["stable_ranges"]);
    }
    let ranges = &bench.json("bicycle check --bicycle benchmark")["stable_ranges"];
    let [from, to] = [0, 1].map(|i| ranges[0][i].as_f64().unwrap());
    assert!((from - 4.292382536341).abs() < 1e-9 && (to - 6.024262015388).abs() < 1e-9, "{ranges}");
    assert!(bench.run("bicycle list").stdout.contains("stable 4.292 to 6.024"));
}

/// Situation: the benchmark bicycle, forward and backwards.
/// Action: eigenvalues from -5 to 5 m/s; a ride at -3 m/s; both with a law.
/// Must hold: backwards the eigenvalues are the negatives of those forward (time reversed), the ride falls, and a law
/// is rejected with the range.
#[test]
fn backwards_is_riding_with_a_steered_rear_wheel() {
    let bench = Bench::new(PROGRAM);
    let eigen = bench.json("eigen --bicycle benchmark --speeds=-5:5:5");
    let at = |i: usize| -> Vec<(f64, f64)> {
        let of = eigen["eigenvalues"][i].as_array().unwrap().iter();
        of.map(|e| (e[0].as_f64().unwrap(), e[1].as_f64().unwrap())).collect()
    };
    let (back, forth) = (at(0), at(2));
    for (re, im) in &forth {
        let near = back.iter().map(|(r, i)| (re + r).hypot(im.abs() - i.abs())).fold(f64::INFINITY, f64::min);
        assert!(near < 1e-9, "{re} {im}: {back:?}");
    }
    let text = bench.run("eigen --bicycle benchmark --speeds=-5:5:5").stdout;
    assert!(text.contains("riding forward:\nv_d = 0.6843"), "{text}");
    assert!(!bench.run("eigen --bicycle benchmark --speeds 5").stdout.contains("riding forward"));
    let ride = bench.json("ride --bicycle benchmark --law none --speed=-3 --steer-rate 0.1");
    assert_eq!((&ride["outcome"], &ride["start"]["speed_m_s"]), (&json!("fallen"), &json!(-3.0)));
    bench.run("ride --law h --speed=-3").rejected_naming(&["--speed", "-3", "0 to 30", "law none"]);
    bench.run("eigen --law h --speeds=-3").rejected_naming(&["--speeds", "-3", "--law none"]);
}
