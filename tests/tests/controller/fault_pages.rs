//! Every cause has its permanent number, its page, and its line in the list.

use control::{CAUSES, Cause, Causes};
use std::collections::BTreeSet;
use std::path::PathBuf;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/faults")
}

/// Situation: the published numbers.
/// Action: compare.
/// Must hold: unchanged; new ones come after.
#[test]
fn published_numbers_never_change() {
    let given = [
        (Cause::GyroLost, 1),
        (Cause::AccelLost, 5),
        (Cause::SteerLost, 9),
        (Cause::SteerRateLost, 13),
        (Cause::FrontWheelLost, 17),
        (Cause::RearWheelLost, 21),
        (Cause::RiderTorqueLost, 25),
        (Cause::MotorLost, 29),
        (Cause::WheelsDisagree, 33),
        (Cause::GuardNotFinite, 39),
        (Cause::PolarityUnchecked, 46),
        (Cause::Fallen, 48),
        (Cause::SwitchOff, 53),
        (Cause::PathLost, 56),
        (Cause::PolarityWrong, 57),
        (Cause::RollUnknown, 58),
        (Cause::Crash, 59),
    ];
    for (cause, code) in given {
        assert_eq!(cause.code(), code, "{cause:?}");
    }
    let codes: BTreeSet<u8> = CAUSES.iter().map(|c| c.code()).collect();
    assert_eq!(codes, (1..=59).collect(), "each number once, none left out");
    assert!(CAUSES.iter().enumerate().all(|(i, c)| usize::from(c.code()) == i + 1));
}

/// Situation: sets of causes.
/// Action: make, join, list.
/// Must hold: the listed causes are those inserted, by rising number.
#[test]
fn a_set_lists_its_causes() {
    let set = Causes::all(&[Cause::PathLost, Cause::GyroLost]);
    assert_eq!(set.iter().collect::<Vec<_>>(), [Cause::GyroLost, Cause::PathLost]);
    assert!(set.has(Cause::GyroLost) && !set.has(Cause::GyroRange) && !set.is_empty());
    assert_eq!(Causes::all(&CAUSES).iter().collect::<Vec<_>>(), CAUSES);
    assert!(!set.any(Causes::of(Cause::Fallen)) && set.any(Causes::of(Cause::PathLost)));
    assert_eq!(set.and(Causes::of(Cause::PathLost)), Causes::of(Cause::PathLost));
}

/// Situation: the pages in docs/faults.
/// Action: look up each cause's.
/// Must hold: one page each, headed by number and name, with the three sections, listed in the README; no page more.
#[test]
fn every_cause_has_its_page() {
    let list = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let pages: BTreeSet<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "README.md")
        .collect();
    assert_eq!(pages.len(), CAUSES.len());
    for cause in CAUSES {
        let start = format!("{:02}-", cause.code());
        let name = pages.iter().find(|name| name.starts_with(&start)).unwrap_or_else(|| panic!("{cause:?}"));
        let page = std::fs::read_to_string(folder().join(name)).unwrap();
        assert!(page.starts_with(&format!("# {}: {cause:?}\n", cause.code())), "{name}");
        for section in ["## When", "## What the controller does", "## What to look at"] {
            assert!(page.contains(section), "{name}: {section}");
        }
        assert!(list.contains(&format!("| {} | [{cause:?}]({name}) |", cause.code())), "{name}");
    }
}
