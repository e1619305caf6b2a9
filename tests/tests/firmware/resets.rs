//! What the image does when something goes wrong in it: every task as on the board, in QEMU.

use crate::rig::Rig;
use control::Mode;
use link::Key;
use link::message::Message;
use link::report::{FaultKind, ResetCause};
use xtask::{image, rides};

/// When the mishap happens \[ms\]: long after the switch was pressed and the assist has its authority.
const AT_MS: u32 = 2500;

/// Situation: the product, engaged, its configuration in flash; all tasks run.
/// Action: 2.5 s after the start a task waits for ever, a task never ends, control never ends, a panic, a bus fault, the
/// supply falls; the switch stays pressed; later it is released and pressed again.
/// Must hold: engaged until then; a new start within the stated time, and just one; no torque from then on, and no
/// engagement until the fresh press, then engagement; the fault is kept with its kind, start, mode and words; the cause of
/// the new start is told; the stored configuration is in force.
#[test]
fn whatever_goes_wrong_ends_in_a_new_start_without_torque() {
    if !image::ready() {
        return;
    }
    use FaultKind::{BrownOut, Exception, Panic, Watchdog};
    let thread = "the lowest priority stood still";
    for (mishap, ms, kind, boot, text, cause) in [
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
        let (at, word) = (format!("at_ms={AT_MS}"), format!("mishap={mishap}"));
        let mut rig = Rig::start(&[&word, &at]);
        rig.ride(1000, false);
        let stored = rides::product();
        while rig.starts() == 1 && rig.time_ms() < AT_MS - 1 {
            rig.ride(1, true);
        }
        assert_eq!(
            rig.mode(),
            Mode::Engaged,
            "{mishap}: until then, {:?}, {}",
            rig.latest,
            rig.board.output()
        );
        while rig.starts() == 1 && rig.time_ms() < AT_MS + 1000 {
            rig.ride(1, true);
        }
        let took = rig.time_ms() - AT_MS;
        assert!(ms.contains(&took), "{mishap}: {took} ms");
        for _ in 0..2000 {
            rig.ride(1, true);
            assert!(rig.torque_nm() == 0.0 && !rig.mode().drives(), "{mishap}: {:?}", rig.latest);
        }
        let mut checked = stored.clone();
        checked.calibration.polarity_checked = true;
        rig.ask(&Message::AskHello);
        rig.ask(&Message::ListFaults { from: 0 });
        rig.ride(500, false);
        assert_eq!(
            rig.hash,
            Some(link::report::config_hash(&checked)),
            "{mishap}: what was stored is in force"
        );
        let kept = &rig.kept[0];
        assert_eq!((kept.kind, kept.boot), (kind, boot), "{mishap}: {kept:?}");
        assert!(kept.text.contains(text), "{mishap}: {kept:?}");
        assert_eq!(kept.mode, Mode::Engaged, "{mishap}: {kept:?}");
        assert!((AT_MS - 2..AT_MS + 171).contains(&kept.steps), "{mishap}: {kept:?}");
        let told = format!("start 2 after {}; parameters: stored ones", cause.name());
        assert!(rig.logs.iter().any(|log| log.contains(&told)), "{mishap}: {:?}", rig.logs);
        rig.ride(2000, true);
        assert_eq!((rig.mode(), rig.starts()), (Mode::Engaged, 2), "{mishap}: a fresh press engages");
    }
}

/// Longest that silence does not count while parameters are stored \[ms\].
const SUSPEND_MS: u32 = 5000;

/// Situation: the product at rest, its configuration in flash, all tasks run.
/// Action: a parameter is changed and stored; the flash never takes it.
/// Must hold: silence is excused for 5 s, and no longer: then a new start within 60 to 170 ms, and just one; the silent task
/// is kept; what was stored before is in force.
#[test]
fn a_store_that_never_ends_is_not_excused_for_ever() {
    if !image::ready() {
        return;
    }
    let mut rig = Rig::start(&["mishap=flash-stuck", "at_ms=1000"]);
    rig.ride(1500, false);
    let key = Key { group: "limits", name: "max_torque_nm" };
    rig.ask(&Message::Set { key, value: Some(5.0) });
    rig.ride(40, false);
    assert_eq!(rig.values, [Some(5.0)]);
    rig.ask(&Message::Store);
    let from = rig.time_ms();
    while rig.starts() == 1 && rig.time_ms() < from + 2 * SUSPEND_MS {
        rig.ride(1, false);
    }
    let took = rig.time_ms() - from;
    assert!((SUSPEND_MS + 60..SUSPEND_MS + 170).contains(&took), "{took} ms");
    rig.ask(&Message::Get { key });
    rig.ask(&Message::ListFaults { from: 0 });
    rig.ride(2000, false);
    assert_eq!((rig.starts(), rig.done), (2, 1), "one new start, nothing stored but before");
    assert_eq!(rig.values, [Some(5.0), Some(7.0)]);
    let kept = &rig.kept[0];
    assert_eq!((kept.kind, kept.boot, &*kept.text), (FaultKind::Watchdog, 1, "line"));
}
