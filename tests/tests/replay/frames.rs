//! Rides of the simulator, replayed.

use super::{PROGRAM, SMALLEST, bench};
use tests::cli::Bench;

/// A column of a table, below its lines with `#`.
fn column(text: &str, name: &str) -> Vec<String> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place = header.iter().position(|column| *column == name).unwrap_or_else(|| panic!("no {name}"));
    lines.map(|line| line.split(',').nth(place).unwrap().to_owned()).collect()
}

/// Commanded torques, in f32.
fn torques(text: &str) -> Vec<u32> {
    column(text, "torque").iter().map(|cell| (cell.parse::<f64>().unwrap() as f32).to_bits()).collect()
}

/// Situation: rides of the simulator under both presets, and one whose gyro fails, each written as frames and as a table.
/// Action: replay the frames, a row each millisecond, and write frames again.
/// Must hold: torque, mode, causes and limits are those of the ride, bit for bit; the frames are the same bytes.
#[test]
fn a_simulated_ride_gives_the_same_commands() {
    let bench = Bench::new(PROGRAM);
    for (preset, more, most_nm) in [
        ("product", "--steer-rate 3", 1.0),
        ("thesis", "--steer-rate 3", 1.0),
        ("product", "--steer-rate 0.5 --sensor gyro:every=5ms --fault gyro:missing@2s..3s", 0.2),
    ] {
        let ride = format!("ride --preset {preset} --speed 4 {more} --csv ride.csv --frames ride.frames -q");
        assert_eq!(bench.run(&ride).code, Some(0), "{ride}");
        let line = format!(
            "replay ride.frames --preset {preset} --bicycle rigid_jason --every 0.001 --csv again.csv --frames again.frames -q"
        );
        let run = bench.run(&line);
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let (ride, again) = (bench.read("ride.csv"), bench.read("again.csv"));
        let (theirs, ours) = (torques(&ride), torques(&again));
        // Before the disturbance at t = 0 the ride has no rows; the frames begin at the controller's boot.
        let boot = ours.len() - theirs.len();
        assert!((1..2000).contains(&boot) && theirs.len() >= 4000, "{boot} {}", theirs.len());
        assert_eq!(ours[boot..], theirs[..], "{line}");
        let largest = theirs.iter().map(|bits| f32::from_bits(*bits).abs()).fold(0.0, f32::max);
        assert!(largest > most_nm, "{largest}: nothing to compare");
        for name in ["mode", "causes", "limits"] {
            assert_eq!(column(&again, name)[boot..], column(&ride, name)[..], "{line}: {name}");
        }
        let read = |name| std::fs::read(bench.path(name)).unwrap();
        assert_eq!(read("again.frames"), read("ride.frames"));
    }
}

/// Situation: files named `.frames` that are none: half a frame, empty.
/// Action: replay them.
/// Must hold: rejected with the size of the file and the size of a frame.
#[test]
fn frames_that_are_none() {
    let bench = Bench::new(PROGRAM);
    for (bytes, size) in [(vec![1; 100], "100 bytes"), (Vec::new(), "0 bytes")] {
        bench.write("half.frames", bytes);
        bench.run("replay half.frames").rejected_naming(&["half.frames", size, "81 bytes"]);
    }
    bench.write("half.frames", [0; 81]);
    for (option, value) in [
        ("--fault", " gyro:flip@1s"),
        ("--map", " extract"),
        ("--dbc", " no.dbc"),
        ("--strict", ""),
        ("--resample", " hold"),
        ("--longest-gap", " 1"),
        ("--press", " once"),
    ] {
        let run = bench.run(&format!("replay half.frames {option}{value}"));
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{option}: {run:?}");
        assert!(run.stderr.contains("half.frames") && run.stderr.contains(option), "{}", run.stderr);
    }
    for line in ["ride.csv --seed 3", "ride.csv --resample hold --longest-gap 1"] {
        assert_eq!(bench.run(&format!("replay {line}")).code, Some(2), "{line}");
    }
}

/// Situation: frames of a ride beside a table of samples; maps that hold and that interpolate.
/// Action: replay with options that act on samples; with a longest gap and each map, or with none.
/// Must hold: a warning names the frames and the options; the gap is refused as wrong usage beside a map that holds, told where
/// the map follows from the columns and holds, and taken where samples are interpolated.
#[test]
fn options_without_effect_on_one_recording_are_told() {
    let bench = bench(400);
    bench.write("t.toml", SMALLEST);
    bench.write("interpolated.toml", format!("resample = 'interpolate'\n{SMALLEST}"));
    let made = bench.run("replay ride.csv --map t.toml --frames ride.frames");
    assert_eq!(made.code, Some(0), "{made:?}");
    let run = bench.run("replay ride.csv ride.frames --map t.toml --press once");
    let warning =
        "warning: ride.frames has frames, which are replayed bit for bit, without effect of --map, --press\n";
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), warning));

    let gap = |more: &str| bench.run(&format!("replay ride.csv --longest-gap 0.2 {more}"));
    let run = gap("--map t.toml");
    assert!(run.code == Some(2) && run.stderr.contains("--longest-gap: is for interpolation"), "{run:?}");
    for line in ["--map interpolated.toml", "--map t.toml --resample interpolate"] {
        let run = gap(line);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{line}");
    }
    let run = gap("");
    assert!(run.code == Some(0) && run.stderr.contains("ride.csv: the longest gap is for"), "{run:?}");
}
