//! Criteria of a fall, and their effect.

use serde_json::{Value, json};
use sim_host::plant::SteerStop;
use sim_host::ride::{Assist, Conditions, FallCriterion, Start, rides};
use tests::basins::alone;
use tests::cli::Bench;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// Situation: no assist, 3 m/s, a steer rate of 0.5 rad/s; without a handlebar stop, and with one at 45 degrees.
/// Action: ride, as text and as document; with the published criterion, too.
/// Must hold: without a stop it falls by its steer at the same time under both criteria. With it the steer cannot
/// pass 90 degrees: laid flat 1 s after 80 degrees of roll, and "not fallen" only with the published criterion.
#[test]
fn a_bicycle_that_lies_at_90_degrees_has_fallen() {
    let bench = Bench::new(PROGRAM);
    let kick = "ride --law none --speed 3 --steer-rate 0.5";
    for option in ["", " --fall published"] {
        let free = bench.json(&format!("{kick}{option}"));
        assert_eq!((&free["outcome"], &free["fall"]), (&json!("fallen"), &json!("steer")));
        assert!((free["time_to_fall_s"].as_f64().unwrap() - 1.487616).abs() < 1e-6);
    }
    let stopped = bench.json(&format!("{kick} --actuator stop=0.785"));
    assert_eq!((&stopped["outcome"], &stopped["fall"]), (&json!("fallen"), &json!("laid-flat")));
    let time = stopped["time_to_fall_s"].as_f64().unwrap();
    assert!((2.0..4.0).contains(&time) && stopped["final"]["t"] == json!(time), "{time}");
    let sooner = bench.json(&format!("{kick} --actuator stop=0.785 --fall lasting=200ms"));
    assert!((time - sooner["time_to_fall_s"].as_f64().unwrap() - 0.8).abs() < 1e-9);
    let published = bench.json(&format!("{kick} --actuator stop=0.785 --fall published"));
    assert_eq!((&published["outcome"], &published["fall"]), (&json!("undecided"), &Value::Null));
    let text = bench.run(&format!("{kick} --actuator stop=0.785")).stdout;
    assert!(text.contains("laid flat, roll beyond 80 deg and no fall by 90 deg within 1 s"), "{text}");
}

/// Situation: a bicycle without assist at speeds at which it is unstable, and a handlebar stop at 30 degrees.
/// Action: its basin, in all forms.
/// Must hold: no basin: area below 1 rad m/s^2, as without a stop; document and table name the fall beyond the
/// border.
#[test]
fn a_handlebar_stop_makes_no_endless_basin() {
    let bench = Bench::new(PROGRAM);
    let line = "basin --law none --speeds 2:4:1 --max-rate 10 --scan-step 1 --actuator stop=0.524";
    let run = bench.run(&format!("{line} --csv out.csv --json out.json"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stdout.contains("laid flat: ") && !run.stdout.contains("nothing fell"), "{}", run.stdout);
    let document: Value = serde_json::from_str(&bench.read("out.json")).unwrap();
    assert!((0.0..1.0).contains(&document["area"].as_f64().unwrap()), "{}", document["area"]);
    assert_eq!(document["capped"], json!([false, false, false]));
    assert_eq!(document["config"]["fall"]["flat"]["lasting_s"], json!(1.0));
    let falls = document["map"]["fall"].as_array().unwrap().iter().flat_map(|of| of.as_array().unwrap());
    let flat = falls.filter(|fall| **fall == json!("laid-flat")).count();
    assert!((5..=30).contains(&flat), "{flat}");
    assert!(bench.read("out.csv").contains(",border,,laid-flat"));
}

/// Situation: rides with stops, strong dampers, and knocks of every size, without assist: those that bounce at 90
/// degrees.
/// Action: ride 144 of them; once more without the criterion of lying flat.
/// Must hold: no ride that did not fall had its peak beyond 80 degrees of roll, and some are laid flat; the ride
/// without that criterion ends, too: its shorter steps are bounded.
#[test]
fn no_ride_ends_beyond_the_flat_angle_as_not_fallen() {
    let starts: Vec<Start> = (0..48)
        .map(|i| Start {
            speed_m_s: 1.5 + f64::from(i % 6),
            steer_rate_rad_s: 0.5 + 0.25 * f64::from(i),
            roll_rate_rad_s: 0.0,
        })
        .collect();
    let mut flat = 0;
    for (stop, viscous) in [(Some(0.524), 0.0), (Some(0.785), 0.0), (Some(1.2), 5.0)] {
        let mut conditions = Conditions { assist: Assist::None, ..alone() };
        conditions.plant.actuator.stop = stop.map(SteerStop::at);
        conditions.plant.actuator.friction.viscous_nm_s_rad = viscous;
        for ride in rides(&conditions, &starts) {
            let peak = ride.effort.peak_roll_rad.to_degrees();
            assert!(ride.fell() || peak <= 80.0, "{ride:?}");
            flat += u32::from(ride.outcome.fall().is_some_and(|fall| fall.name() == "laid-flat"));
        }
        let published = Conditions { fall: FallCriterion::PUBLISHED, ..conditions };
        assert_eq!(rides(&published, &starts[..8]).len(), 8);
    }
    assert!((20..=144).contains(&flat), "{flat}");
}

/// Situation: ordinary rides, no assist and law h, speeds and knocks over the whole map.
/// Action: ride them by the published criterion and by the default one.
/// Must hold: the same rides to the bit, except at most 2 % that lie flat for more than a second before they fall.
#[test]
fn ordinary_rides_keep_every_bit() {
    let starts: Vec<Start> = (0..120)
        .map(|i| Start {
            speed_m_s: 0.5 * f64::from(i % 20),
            steer_rate_rad_s: 0.25 * f64::from(i),
            roll_rate_rad_s: 0.0,
        })
        .collect();
    for conditions in [alone(), tests::basins::assisted(control::Law::H { cut: false })] {
        let published = Conditions { fall: FallCriterion::PUBLISHED, ..conditions.clone() };
        let (now, then) = (rides(&conditions, &starts), rides(&published, &starts));
        let differ: Vec<_> = now.iter().zip(&then).filter(|(now, then)| now != then).collect();
        assert!(differ.len() <= 2, "{differ:?}");
        assert!(differ.iter().all(|(now, then)| now.fell() && then.fell()), "{differ:?}");
    }
}

/// Situation: invalid criteria.
/// Action: give them.
/// Must hold: wrong usage, with the key, the value and the range or the available names.
#[test]
fn wrong_criteria_are_rejected() {
    let bench = Bench::new(PROGRAM);
    for (fall, named) in [
        ("roll=120deg", "fall: roll (deg) = 120 is outside 1 to 90"),
        ("roll=60", "80deg or 1.4rad"),
        ("lasting=20s", "0 s to 10 s"),
        ("yaw=1rad", "unknown key `yaw`"),
        ("flat=none,lasting=1s", "flat=ANGLE"),
    ] {
        let run = bench.run(&format!("ride --speed 4 --fall {fall}"));
        assert!(run.code == Some(2) && run.stderr.contains(named), "{fall}: {}", run.stderr);
    }
}
