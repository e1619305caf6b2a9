//! Every failure on the chip ends with a report and a status of its own.

use xtask::{image, qemu};

/// Situation: the image that fails on purpose.
/// Action: a panic, a stack overflow, an undefined instruction, an access to absent memory, an interrupt without a
/// handler.
/// Must hold: the status of its kind, a report that names the cause and the image.
#[test]
fn every_failure_is_reported_and_none_exits_with_success() {
    if !image::ready() {
        return;
    }
    for (failure, status, report) in [
        ("panic", 101, "on purpose"),
        ("stack", 102, "cfsr=00009200"),
        ("undefined", 102, "cfsr=00010000"),
        ("bus", 102, "bfar=60000000"),
        ("interrupt", 103, "stray interrupt"),
    ] {
        let directory = qemu::directory("fault").unwrap();
        let outcome = qemu::run("qemu-fault", &[failure], &directory, qemu::TIMED, qemu::LIMIT).unwrap();
        assert_eq!(outcome.status, Some(status), "{failure}: {outcome:?}");
        assert!(outcome.stdout.contains(report), "{failure}: {outcome:?}");
        assert!(outcome.stdout.starts_with("qemu-fault "), "{failure}: {outcome:?}");
    }
}

/// Situation: a file of rides whose configuration no controller accepts, and a truncated one.
/// Action: replay it.
/// Must hold: rejected with a reason and status 2; no command is output.
#[test]
fn a_bad_file_of_rides_is_rejected() {
    if !image::ready() {
        return;
    }
    let frames = [control::SensorFrame::missing(); 10];
    let bad = control::Config { rate_hz: 1.0, ..control::Config::product() };
    let good = control::Config::product();
    let whole = xtask::rides::encode(&[(&good, &frames)]);
    for (name, bytes, reason) in [
        ("refused", xtask::rides::encode(&[(&bad, &frames)]), "rate_hz = 1 is outside 100 to 10000"),
        ("cut", whole[..whole.len() - 1].to_vec(), "rides.bin ends within a ride"),
    ] {
        let directory = qemu::directory(name).unwrap();
        std::fs::write(directory.join("rides.bin"), bytes).unwrap();
        let outcome = qemu::run("qemu-replay", &[], &directory, qemu::UNTIMED, qemu::LIMIT).unwrap();
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stdout.contains(reason), "{outcome:?}");
        assert_eq!(std::fs::read(directory.join("commands.bin")).unwrap(), Vec::<u8>::new());
    }
}
