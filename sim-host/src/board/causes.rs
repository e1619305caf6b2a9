//! Names and meanings of causes and limits.

use control::{ActiveLimits, Cause, Causes};
use schemars::JsonSchema;
use serde::Serialize;

/// The list of all causes with names, pages and meanings.
const LIST: &str = include_str!("../../../docs/faults/README.md");
/// Directory of the pages.
const PAGES: &str = "docs/faults";

/// A cause with its name and meaning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NamedCause {
    /// Its number.
    pub code: u8,
    /// Its name.
    pub name: &'static str,
    /// What it means, in a sentence.
    pub meaning: &'static str,
    /// The page with details.
    pub page: String,
}

/// The causes of a set, by rising number; bits unknown to this program are left out.
pub fn named(causes: Causes) -> Vec<NamedCause> {
    causes.iter().filter_map(find).collect()
}

fn find(cause: Cause) -> Option<NamedCause> {
    let begins = format!("| {} | [", cause.code());
    let row = LIST.lines().find_map(|line| line.strip_prefix(&begins))?;
    let (name, rest) = row.split_once("](")?;
    let (page, meaning) = rest.split_once(") | ")?;
    let meaning = meaning.trim_end_matches(" |");
    Some(NamedCause { code: cause.code(), name, meaning, page: format!("{PAGES}/{page}") })
}

/// The limits in the order of their bits, named as in `docs/cli.md`.
const LIMITS: [(ActiveLimits, &str); 10] = [
    (ActiveLimits::TAPER, "taper"),
    (ActiveLimits::MAGNITUDE, "torque"),
    (ActiveLimits::RATE, "rate"),
    (ActiveLimits::SPEED, "speed"),
    (ActiveLimits::RIDER_TORQUE, "rider torque"),
    (ActiveLimits::RIDER_MOTION, "rider motion"),
    (ActiveLimits::WINDOW, "window"),
    (ActiveLimits::END_STOP, "end-stop"),
    (ActiveLimits::LIMP, "limp"),
    (ActiveLimits::AUTHORITY, "authority"),
];

/// Names of the limits in a set.
pub fn limits(set: ActiveLimits) -> Vec<&'static str> {
    LIMITS.iter().filter(|(limit, _)| set.0 & limit.0 != 0).map(|(_, name)| *name).collect()
}
