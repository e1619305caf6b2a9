//! Reaction of the image to its own failures: every task as on the board, in QEMU.

use crate::steady_board::SteadyBoard;
use control::Mode;
use link::Key;
use link::message::Message;
use link::report::{FaultKind, ResetCause};
use xtask::{image, rides};

/// Time of the failure \[ms\]: long after the switch was pressed and full authority was reached.
const AT_MS: u32 = 2500;

/// Situation: the product, engaged, its configuration in flash; all tasks run.
/// Action: 2.5 s after the start a task waits without end, a task never ends, control never ends, a panic, a bus
/// fault, the supply falls; the switch stays pressed; later it is released and pressed again.
/// Must hold: engaged until then; a new start within the stated time, and just one; no torque from then on, and no
/// engagement until the new press, then engagement; the fault is stored with its kind, start, mode and text; the
/// cause of the new start is reported; the stored configuration is in force.
#[test]
fn every_failure_ends_in_a_restart_without_torque() {
    if !image::ready() {
        return;
    }
    use FaultKind::{BrownOut, Exception, Panic, Watchdog};
    let thread = "the lowest priority stood still";
    for (failure, ms, kind, boot, text, cause) in [
        ("control-mute", 100..171, Watchdog, 1, "control", ResetCause::Watchdog),
        ("line-mute", 100..171, Watchdog, 1, "line", ResetCause::Watchdog),
        ("report-mute", 100..171, Watchdog, 1, "report", ResetCause::Watchdog),
        ("control-spin", 80..111, Watchdog, 2, thread, ResetCause::Watchdog),
        ("line-spin", 80..121, Watchdog, 2, thread, ResetCause::Watchdog),
        ("report-spin", 80..131, Watchdog, 2, thread, ResetCause::Watchdog),
        ("panic", 0..6, Panic, 1, "on purpose", ResetCause::Software),
        ("bus", 0..6, Exception, 1, "", ResetCause::Software),
        ("brown-out", 0..6, BrownOut, 1, "supply too low", ResetCause::Software),
    ] {
        let (at, word) = (format!("at_ms={AT_MS}"), format!("fault={failure}"));
        let mut board = SteadyBoard::start(&[&word, &at]);
        board.ride(1000, false);
        let stored = rides::product();
        while board.starts() == 1 && board.time_ms() < AT_MS - 1 {
            board.ride(1, true);
        }
        assert_eq!(
            board.mode(),
            Mode::Engaged,
            "{failure}: until then, {:?}, {}",
            board.latest,
            board.board.output()
        );
        while board.starts() == 1 && board.time_ms() < AT_MS + 1000 {
            board.ride(1, true);
        }
        let took = board.time_ms() - AT_MS;
        assert!(ms.contains(&took), "{failure}: {took} ms");
        for _ in 0..2000 {
            board.ride(1, true);
            assert!(board.torque_nm() == 0.0 && !board.mode().drives(), "{failure}: {:?}", board.latest);
        }
        let mut checked = stored.clone();
        checked.calibration.polarity_checked = true;
        board.request(&Message::AskHello);
        board.request(&Message::ListFaults { from: 0 });
        board.ride(500, false);
        assert_eq!(
            board.hash,
            Some(link::report::config_hash(&checked)),
            "{failure}: what was stored is in force"
        );
        let fault = &board.faults[0];
        assert_eq!((fault.kind, fault.boot), (kind, boot), "{failure}: {fault:?}");
        assert!(fault.text.contains(text), "{failure}: {fault:?}");
        assert_eq!(fault.mode, Mode::Engaged, "{failure}: {fault:?}");
        assert!((AT_MS - 2..AT_MS + 171).contains(&fault.steps), "{failure}: {fault:?}");
        let expected_log = format!("start 2 after {}; parameters: stored ones", cause.name());
        assert!(board.logs.iter().any(|log| log.contains(&expected_log)), "{failure}: {:?}", board.logs);
        board.ride(2000, true);
        assert_eq!((board.mode(), board.starts()), (Mode::Engaged, 2), "{failure}: a fresh press engages");
    }
}

/// Longest suspension of the supervision while parameters are stored, and the watchdog's timeout meanwhile \[ms\].
const SUSPEND_MS: u32 = 8000;
const EXTENDED_MS: u32 = 2000;

/// Situation: the product at rest, its configuration in flash, all tasks run.
/// Action: a parameter is changed and stored; the flash never completes.
/// Must hold: supervision is suspended for 8 s, and no longer: then a new start after the watchdog's 2 s, and just one;
/// the silent task is stored; the previously stored configuration is in force.
#[test]
fn the_supervision_is_not_suspended_without_end() {
    if !image::ready() {
        return;
    }
    let mut board = SteadyBoard::start(&["fault=flash-stuck", "at_ms=1000"]);
    board.ride(1500, false);
    let key = Key { group: "limits", name: "max_torque_nm" };
    board.request(&Message::Set { key, value: Some(5.0) });
    board.ride(40, false);
    assert_eq!(board.values, [Some(5.0)]);
    board.request(&Message::Store);
    let from = board.time_ms();
    while board.starts() == 1 && board.time_ms() < from + 2 * SUSPEND_MS {
        board.ride(1, false);
    }
    let took = board.time_ms() - from;
    let due = SUSPEND_MS + EXTENDED_MS;
    assert!((due - 20..due + 30).contains(&took), "{took} ms");
    board.request(&Message::Get { key });
    board.request(&Message::ListFaults { from: 0 });
    board.ride(2000, false);
    assert_eq!((board.starts(), board.done), (2, 1), "one new start, nothing stored but before");
    assert_eq!(board.values, [Some(5.0), Some(7.0)]);
    let fault = &board.faults[0];
    assert_eq!((fault.kind, fault.boot, &*fault.text), (FaultKind::Watchdog, 1, "line"));
}
