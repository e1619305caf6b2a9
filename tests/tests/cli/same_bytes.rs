//! The same results on every processor.
#![cfg(target_os = "linux")]

use tests::cli::{Bench, Run, bicycle_with};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// The C library's code for a processor without fused multiply-add.
const WITHOUT_FMA: (&str, &str) = ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F");

/// Situation: a tilt of 0.259 rad, whose sine has another last bit in the C library's code for processors without
/// fused multiply-add; a processor that has it.
/// Action: eigenvalues without and with a late rider, a ride with noise, a basin, a perturbation record; each by default, and with the C
/// library forced to use that code.
/// Must hold: the same bytes.
#[test]
fn the_c_library_does_not_change_results() {
    let bench = Bench::new(PROGRAM);
    bench.write("tilted.toml", bicycle_with("lam", "lam = 0.259"));
    for line in [
        "eigen --speeds 0:10:1 --csv -",
        "eigen --rider young --speeds 3:6:1 --csv -",
        "ride --preset product --law h-cut --speed 4 --steer-rate 1 --sensor gyro:noise=0.01 --csv -",
        "basin --rider young --law h --speeds 4 --max-rate 4 --scan-step 1 --csv -",
        "record --rider young --speed 5 --duration 3 --until-fall --remnant 0.5 --steer-noise 0.001 --treadmill-drift 0.1",
    ] {
        let table = |with: Option<(&str, &str)>| {
            let mut command = bench.command(&format!("{line} --bicycle tilted.toml -q"));
            let run = Run::from(command.envs(with).output().expect("runs"));
            assert_eq!(run.code, Some(0), "{line}: {run:?}");
            run.stdout
        };
        let usual = table(None);
        assert!(usual.lines().count() > 3, "{line}: {usual}");
        assert!(usual == table(Some(WITHOUT_FMA)), "{line}");
    }
}
