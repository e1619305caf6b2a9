//! The options of sensors, motor and faults.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use serde_json::json;
use tests::cli::Bench;
use tests::draws::runner;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// Situation: no options, then all of them.
/// Action: read the configuration of a ride's document.
/// Must hold: exact by default; all requested values are there, times in control periods, faults as parsed; the ride
/// repeats from them, and differs with another seed.
#[test]
fn the_document_has_the_plant() {
    let bench = Bench::new(PROGRAM);
    let plant = |options: &str| bench.json(&format!("ride --speed 4 {options}"))["config"]["plant"].clone();
    let exact = plant("");
    assert_eq!((&exact["sensors"], &exact["faults"], &exact["seed"]), (&json!({}), &json!([]), &json!(0)));
    assert_eq!(exact["actuator"]["scale"], json!(1.0));
    let options = "--sensor gyro:noise=0.01,bias=0.02,delay=5ms --sensor gyro.y:bias=-1 --sensor imu:roll=0.1,z=-0.4 \
                   --sensor path:every=10ms,range=2 --actuator davis,limit=7,time-constant=20ms,delay=2ms \
                   --fault gyro.x:stuck@1.5s..2s --fault motor:dead@5s --seed 9";
    let all = plant(options);
    let gyro = &all["sensors"]["gyro"];
    assert_eq!((&gyro["noise"], &gyro["delay_ticks"]), (&json!(0.01), &json!(5)));
    assert_eq!(gyro["bias"], json!([0.02, -1.0, 0.02]));
    assert_eq!(
        (&all["sensors"]["path"]["every_ticks"], &all["sensors"]["path"]["range"]),
        (&json!(10), &json!(2.0))
    );
    assert_eq!(
        (&all["imu"]["turned_rad"], &all["imu"]["point_m"]),
        (&json!([0.1, 0.0, 0.0]), &json!([0.5, 0.0, -0.4]))
    );
    let actuator = &all["actuator"];
    assert_eq!(
        (&actuator["limit_nm"], &actuator["time_constant_s"], &actuator["delay_ticks"]),
        (&json!(7.0), &json!(0.02), &json!(2))
    );
    assert_eq!(actuator["friction"]["viscous_nm_s_rad"], json!(0.34));
    assert_eq!(
        (&all["faults"], &all["seed"]),
        (&json!(["gyro.x:stuck@1.5s..2s", "motor:dead@5s"]), &json!(9))
    );
    let end = |seed: u32| {
        let line = format!("ride --speed 5 --steer-rate 1 --sensor gyro:noise=0.05 --seed {seed}");
        bench.json(&line)["final"].clone()
    };
    assert_eq!(end(1), end(1));
    assert_ne!(end(1), end(2));
}

/// Situation: options with an error each.
/// Must hold: exit code 1; the message names option, key, value and the allowed ones.
#[test]
fn wrong_options_name_the_allowed_ones() {
    let bench = Bench::new(PROGRAM);
    for (options, says) in [
        ("--sensor gyro", &["--sensor gyro", "NAME:KEY=VALUE"][..]),
        ("--sensor gyros:noise=1", &["`gyros`", "imu, gyro, accel"]),
        ("--sensor gyro:noises=1", &["`noises`", "delay=TIME", "dropout"]),
        ("--sensor gyro:noise", &["`noise` is not KEY=VALUE"]),
        ("--sensor gyro:noise=x", &["noise: `x` is not a number"]),
        ("--sensor gyro:noise=-1", &["gyro noise = -1", "0 to 1000"]),
        ("--sensor gyro.w:bias=1", &["no axis `w`", "x, y, z"]),
        ("--sensor gyro.x:noise=1", &["only bias"]),
        ("--sensor steer.x:bias=1", &["one axis only"]),
        ("--sensor gyro:delay=1.5ms", &["1 ms and 2 ms"]),
        ("--sensor gyro:delay=6s", &["0 s to 5 s"]),
        ("--actuator delay=2s", &["0 s to 1 s"]),
        ("--actuator stop=2", &["steer stop (rad) = 2", "0.05 to 1.5"]),
        ("--sensor gyro:every=0ms", &["gyro every", "1 to 5000"]),
        ("--sensor imu:up=1", &["unknown key `up` of the imu", "x, y, z"]),
        ("--actuator motor", &["unknown actuator `motor`", "none, davis, gazelle"]),
        ("--actuator gazelle,power=3", &["unknown key `power`", "time-constant"]),
        ("--actuator limit=-1", &["actuator limit (N m) = -1", "0 to 1000"]),
        ("--actuator voltage=24", &["given together"]),
        ("--actuator coulomb=5", &["over creep"]),
        ("--fault gyro:stuk", &["--fault", "gyro:stuk", "stuck, missing"]),
        ("--fault x", &["--fault x", "gyro, accel, steer,", "engage, clock"]),
        ("--fault motor", &["motor needs a kind", "dead, stuck, late=TIME"]),
        ("--assist ideal --fault gyro:stuck", &["only friction"]),
        ("--assist ideal --actuator gazelle", &["only friction"]),
    ] {
        let run = bench.run(&format!("ride --speed 4 {options}"));
        assert_eq!(run.code, Some(1), "{options}: {}", run.stderr);
        assert!(says.iter().all(|word| run.stderr.contains(word)), "{options}: {}", run.stderr);
    }
    let run = bench.run("basin plane --speed 4 --fault gyro:stuck@1s");
    assert!(run.code == Some(1) && run.stderr.contains("mirrors"), "{}", run.stderr);
    assert_eq!(bench.run("ride --speed 4 --assist ideal --actuator davis").code, Some(0));
}

/// Situation: every channel of faults, named without a kind.
/// Action: ride, and read the help.
/// Must hold: the error lists the channel's kinds, and the help has each channel and each kind.
#[test]
fn the_help_lists_all_faults() {
    let bench = Bench::new(PROGRAM);
    let help = bench.run("ride --help").stdout;
    let help = help.split("--fault ").nth(1).unwrap().split("--seed").next().unwrap().to_owned();
    let words: Vec<&str> = help.split(|c: char| c.is_whitespace() || ",:()".contains(c)).collect();
    for channel in sim_host::plant::Channel::all() {
        let name = channel.name();
        assert!(words.contains(&name), "{name}: {help}");
        let run = bench.run(&format!("ride --speed 4 --fault {name}"));
        assert_eq!(run.code, Some(1), "{run:?}");
        let kinds = run.stderr.split("there are ").nth(1).unwrap_or_else(|| panic!("{run:?}")).trim();
        assert!(kinds.split(", ").count() >= 3, "{kinds}");
        for kind in kinds.split(", ") {
            assert!(words.contains(&kind), "{name}: {kind}: {help}");
        }
    }
}

/// Situation: the flashed controller with a noisy gyro beside an exact accelerometer, a noisy steer angle beside an exact IMU, both with
/// noise, all exact, and the published conditions without checks.
/// Action: ride.
/// Must hold: in the first two a warning names the exact sensors and their cause, and the text of the ride has this cause; neither in
/// the others.
#[test]
fn an_exact_sensor_beside_a_noisy_one_is_told() {
    let bench = Bench::new(PROGRAM);
    for (options, exact) in [
        ("--preset product --sensor gyro:noise=0.01", &["accel"][..]),
        ("--preset product --sensor steer:noise=0.001", &["gyro", "accel"]),
        ("--preset product --sensor gyro:noise=0.01 --sensor accel:noise=0.1", &[]),
        ("--preset product", &[]),
        ("--sensor gyro:noise=0.01", &[]),
    ] {
        let run = bench.run(&format!("ride --speed 4 --steer-rate 0.5 {options}"));
        assert_eq!(run.code, Some(0), "{options}: {run:?}");
        let warned: Vec<&str> = run.stderr.lines().filter(|line| line.contains("is exact beside")).collect();
        assert_eq!(warned.len(), exact.len(), "{options}: {}", run.stderr);
        for (warning, name) in warned.iter().zip(exact) {
            let cause = if *name == "gyro" { "4 GyroStuck" } else { "8 AccelStuck" };
            assert!(warning.contains(&format!("{name} is exact beside")), "{warning}");
            assert!(warning.contains(&format!("cause {}", cause.replace(' ', ", "))), "{warning}");
        }
        let last = run.stdout.lines().last().unwrap();
        assert_eq!(last.starts_with("causes: "), !exact.is_empty(), "{options}: {last}");
        assert_eq!(last.contains("8 AccelStuck from 0.0"), !exact.is_empty(), "{options}: {last}");
    }
}

/// Situation: path tracking with a path that is lost after 2 s, for each reaction to its loss; without a path.
/// Action: ride.
/// Must hold: the text names the cause and its time; with `note` the bicycle rides on, with `fault` it falls; without a path a note
/// says that there is no tracking.
#[test]
fn a_lost_path_is_told() {
    let bench = Bench::new(PROGRAM);
    let ride = "ride --preset product --speed 4 --steer-rate 0.3 --set track=on --fault path:missing@2s";
    for (loss, falls) in [("note", false), ("limp", false), ("fault", true)] {
        let run = bench.run(&format!("{ride} --set input.path.fitted=on --set input.path.loss={loss}"));
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{loss}: {run:?}");
        assert!(run.stdout.contains("causes: 56 PathLost from 2."), "{loss}: {}", run.stdout);
        assert_eq!(run.stdout.contains("\nfallen after"), falls, "{loss}: {}", run.stdout);
    }
    let run = bench.run(ride);
    assert!(run.stderr.contains("track is on without a path"), "{}", run.stderr);
    assert!(!run.stdout.contains("causes:"), "{}", run.stdout);
}

/// Situation: options made of random parts of options.
/// Must hold: a ride or a reason.
#[test]
fn no_option_makes_the_program_panic() {
    let bench = Bench::new(PROGRAM);
    const PIECES: [&str; 16] = [
        "gyro", "imu", "davis", ".x", ":", "=", ",", "noise", "delay", "limit", "x", "5ms", "-1", "1e99",
        "nan", "@1s",
    ];
    let texts = vec(select(&PIECES[..]), 1..7).prop_map(|pieces| pieces.concat());
    runner(80)
        .run(&(select(&["--sensor", "--actuator", "--fault"][..]), texts), |(option, word)| {
            let run = bench.run(&format!("ride --speed 4 --time-limit 0.1 --json {option}={word}"));
            prop_assert!(matches!(run.code, Some(0..=2)), "{option} {word}: {run:?}");
            prop_assert!(
                run.code == Some(0) || run.stderr.starts_with("error: "),
                "{option} {word}: {run:?}"
            );
            Ok(())
        })
        .unwrap();
}
