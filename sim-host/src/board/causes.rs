//! Causes and limits as text.

use control::{ActiveLimits, Cause, Causes, LIMITS};
use schemars::JsonSchema;
use serde::Serialize;

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

impl From<Cause> for NamedCause {
    fn from(cause: Cause) -> Self {
        Self { code: cause.code(), name: cause.name(), meaning: cause.meaning(), page: page(cause) }
    }
}

/// The causes of a set, by rising number; bits unknown to this program are left out.
pub fn named(causes: Causes) -> Vec<NamedCause> {
    causes.iter().map(NamedCause::from).collect()
}

/// Page of a cause: its number and its name in lower case with hyphens.
fn page(cause: Cause) -> String {
    let mut page = format!("{PAGES}/{:02}", cause.code());
    for letter in cause.name().chars() {
        if letter.is_ascii_uppercase() {
            page.push('-');
        }
        page.push(letter.to_ascii_lowercase());
    }
    page + ".md"
}

/// Names of the limits in a set.
pub fn limits(set: ActiveLimits) -> Vec<&'static str> {
    LIMITS.iter().filter(|named| set.contains(named.limit)).map(|named| named.name).collect()
}
