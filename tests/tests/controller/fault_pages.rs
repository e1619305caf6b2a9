//! Every cause has a permanent number, a page, and a row in the list.

use control::{CAUSES, Cause, Causes};
use sim_host::board::causes::NamedCause;
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

/// Situation: docs/faults: a page for each cause, and the list of all.
/// Action: compare with the causes of `control`.
/// Must hold: each cause has one page, headed by its number, name and meaning, with the three sections; the rows of the list
/// are number, name, page and meaning of each cause. No page and no row more.
#[test]
fn the_pages_and_the_list_are_those_of_control() {
    let pages: BTreeSet<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "README.md")
        .collect();
    assert_eq!(pages.len(), CAUSES.len());
    let mut rows = Vec::new();
    for cause in CAUSES {
        let NamedCause { code, name, meaning, page } = NamedCause::from(cause);
        let file = page.strip_prefix("docs/faults/").unwrap();
        assert!(pages.contains(file), "{page}");
        let text = std::fs::read_to_string(folder().join(file)).unwrap();
        assert!(text.starts_with(&format!("# {code}: {name}\n\n{meaning}\n\n## When\n")), "{page}");
        for section in ["## What the controller does", "## What to look at"] {
            assert!(text.contains(section), "{page}: {section}");
        }
        rows.push(format!("| {code} | [{name}]({file}) | {meaning} |"));
    }
    let list = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let listed: Vec<&str> = list.lines().skip_while(|line| !line.starts_with("| ---")).skip(1).collect();
    assert_eq!(listed, rows);
}
