//! The command `fmu export`.

use tests::cli::Bench;

fn bench() -> Bench {
    Bench::new(env!("CARGO_BIN_EXE_sim-host-under-test"))
}

/// Situation: scenarios without such an FMU, a library and a place that are not there. Action: export. Must hold: refused by
/// name, and no file is left.
#[test]
fn refused_exports() {
    let bench = bench();
    for (line, named) in [
        ("rider", &["--rider NAME"][..]),
        ("controller --law none", &["no controller", "--law"]),
        ("controller --assist ideal", &["no controller", "--assist"]),
        ("bicycle --sensor-delay 1ms", &["exact sensors", "delays"]),
        ("controller --preset product --fault gyro:stuck@1s", &["exact sensors", "faults"]),
        ("controller --schedule-speed initial", &["--schedule-speed front or rear"]),
        ("bicycle --speed nan", &["--speed", "NaN", "30"]),
        ("controller --torque-limit 500", &["torque", "500"]),
        ("bicycle --library nothing.so", &["nothing.so"]),
        ("bicycle --library /dev/null", &["/dev/null", "not the dynamic library"]),
        ("bicycle --out there/b.fmu", &["there"]),
    ] {
        bench.run(&format!("fmu export {line}")).rejected_naming(named);
    }
    assert_eq!(bench.files(), [""; 0]);
}

/// Situation: options of other parts. Action: export each part with them, and with what describes it.
/// Must hold: a warning for each option that changes nothing in this FMU, with its name and the FMU's; none for one that does, also where
/// it describes another part, such as a rider's delay that sets the time step.
#[test]
fn options_without_effect_are_told() {
    let bench = bench();
    for (line, idle) in [
        ("controller --law h --speed 4 --torque-limit 5", &[][..]),
        (
            "controller --law h --rider smart --delay 30ms --steer-rate 5 --speed 4 --fall roll=30deg",
            &["rider", "delay", "fall", "steer-rate"],
        ),
        ("controller --time-limit 9 --imu body --seed 4", &["seed", "imu", "time-limit"]),
        ("bicycle --speed 4 --steer-rate 5 --imu body --time-limit 9", &[]),
        (
            "bicycle --law f --torque-limit 5 --recovered-below 0.2",
            &["law", "torque-limit", "recovered-below"],
        ),
        ("bicycle --set rate_hz=500", &[]),
        ("bicycle --steer-rate 5", &[]),
        ("bicycle --roll-rate 0", &[]),
        ("controller --roll-rate 1", &["roll-rate"]),
        ("rider --rider smart --delay 30ms", &[]),
        ("rider --rider smart --speed 4 --preset product --taper 1:2", &["preset", "taper", "speed"]),
    ] {
        let run = bench.run(&format!("fmu export {line}"));
        assert_eq!(run.code, Some(0), "{line}: {run:?}");
        let part = line.split(' ').next().unwrap();
        let expected: String =
            idle.iter().map(|name| format!("warning: --{name} has no effect on the FMU {part}\n")).collect();
        let told: String = run
            .stderr
            .split_inclusive('\n')
            .filter(|line| line.contains("has no effect on the FMU"))
            .collect();
        assert_eq!(told, expected, "{line}");
    }
}

/// Situation: one scenario. Action: export twice, for both versions. Must hold: the same bytes for the same version, other bytes
/// for the other, and an answer with the number of variables.
#[test]
fn the_same_scenario_is_the_same_file() {
    let bench = bench();
    let exported = |name: &str, version: u32| {
        let run = bench.run(&format!("fmu export rider --rider smart --fmi {version} --out {name}"));
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
        assert!(
            run.stdout.starts_with(&format!("{name}: 15 variables, time step 0.001 s")),
            "{}",
            run.stdout
        );
        std::fs::read(bench.path(name)).unwrap()
    };
    let [a, b, c] = [("a.fmu", 3), ("b.fmu", 3), ("c.fmu", 2)].map(|(name, version)| exported(name, version));
    assert!(a == b && a != c);
    assert!((300_000..20_000_000).contains(&a.len()), "{}", a.len());
}
