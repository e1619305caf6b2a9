//! The 1 kHz task in simulated time: every period its step, every step in its period.

use xtask::instructions::field;
use xtask::process::Outcome;
use xtask::{image, qemu};

/// Milliseconds between two injected delays, the first after half of it.
const EVERY_MS: u32 = 100;

fn fly(name: &str, arguments: &[&str]) -> Outcome {
    let directory = qemu::directory(name).unwrap();
    qemu::run("qemu-control", arguments, &directory, qemu::TIMED, qemu::LIMIT).unwrap()
}

/// The image's last line.
fn last_line(outcome: &Outcome) -> &str {
    let line = outcome.stdout.lines().find(|line| line.starts_with("done:"));
    line.unwrap_or_else(|| panic!("no result: {outcome:?}"))
}

/// Steps done and deadlines missed.
fn result(outcome: &Outcome) -> (u32, u32) {
    let line = last_line(outcome);
    (field(line, "steps").unwrap(), field(line, "missed").unwrap())
}

/// Missed deadlines when control is delayed by `hold_us` from one release in [`EVERY_MS`].
///
/// The step released at that instant ends just after the delay, and so do those released during it; a step is missed
/// if its period, 1 ms, is over by then: as many as there are whole milliseconds in the delay.
fn expected_misses(seconds: u32, hold_us: u32) -> u32 {
    seconds * 1000 / EVERY_MS * (hold_us / 1000)
}

/// Situation: the product's control task, the thread never idle.
/// Action: 5 simulated seconds.
/// Must hold: exactly 5000 steps, no deadline missed, every step done within a tenth of its
/// period, engaged at the end, success.
#[test]
fn five_busy_seconds_miss_no_deadline() {
    if !image::ready() {
        return;
    }
    let outcome = fly("deadlines", &["seconds=5"]);
    assert_eq!(result(&outcome), (5000, 0));
    let worst_us: u32 = field(last_line(&outcome), "worst_us").unwrap();
    assert!(worst_us < 100, "a step ended {worst_us} us after its release");
    assert!(last_line(&outcome).ends_with(" mode=engaged"), "{outcome:?}");
    assert_eq!(outcome.status, Some(0));
}

/// Situation: as above.
/// Action: an interrupt of higher priority delays control every 100 ms, for 0.8, 1.5, 2.5 or 7.1 ms.
/// Must hold: the missed deadlines are exactly those of the schedule, all steps are made up for, and the image fails
/// if one was missed.
#[test]
fn a_delayed_control_task_misses_exactly_the_scheduled_deadlines() {
    if !image::ready() {
        return;
    }
    for hold_us in [800, 1500, 2500, 7100] {
        let outcome = fly("held-up", &["seconds=2", &format!("block_us={hold_us}"), "every_ms=100"]);
        let missed = expected_misses(2, hold_us);
        assert_eq!(result(&outcome), (2000, missed), "held up for {hold_us} us");
        assert_eq!(outcome.status, Some(i32::from(missed > 0)), "held up for {hold_us} us");
    }
}

/// Situation: as above.
/// Action: an interrupt of higher priority never returns.
/// Must hold: the watchdog, 100 ms after it was last fed, ends the run with its own status.
#[test]
fn the_watchdog_resets_when_control_hangs() {
    if !image::ready() {
        return;
    }
    let outcome = fly("watchdog", &["seconds=2", "block_us=1000000", "every_ms=1000"]);
    assert_eq!(outcome.status, Some(104), "{outcome:?}");
    let bite = outcome.stdout.lines().find_map(|l| l.strip_prefix("watchdog: control stood still, "));
    let at: u32 = bite.and_then(|l| l.split(' ').next()?.parse().ok()).expect("a report");
    assert!((590..=601).contains(&at), "held up from 500 ms, bitten at {at} ms");
}

/// Situation: a board whose components take 300 ms to start, six times the longest permitted silence of a task, with
/// the clock running.
/// Action: 2 simulated seconds from the start of the tasks.
/// Must hold: the start causes no reset, every step is done in time, success.
#[test]
fn a_slow_start_causes_no_reset() {
    if !image::ready() {
        return;
    }
    let outcome = fly("slow-start", &["seconds=2", "start_ms=300"]);
    assert_eq!(outcome.status, Some(0), "{outcome:?}");
    assert_eq!(result(&outcome), (2000, 0));
}

/// Situation: any run.
/// Action: the same run twice.
/// Must hold: the same output, byte for byte: time is simulated, not the host's.
#[test]
fn two_runs_are_equal() {
    if !image::ready() {
        return;
    }
    let runs = ["first", "second"].map(|name| fly(name, &["seconds=2"]).stdout);
    assert_eq!(runs[0], runs[1]);
}
