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
        ("bicycle --steer-rate 3", &["--speed", "must be given"]),
        ("controller --torque-limit 500", &["torque", "500"]),
        ("bicycle --library nothing.so", &["nothing.so"]),
        ("bicycle --library /dev/null", &["/dev/null", "not the dynamic library"]),
        ("bicycle --out there/b.fmu", &["there"]),
    ] {
        bench.run(&format!("fmu export {line}")).rejected_naming(named);
    }
    assert_eq!(bench.files(), [""; 0]);
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
