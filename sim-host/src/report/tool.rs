//! Version of the documents, and the program that wrote them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Version of all JSON documents.
pub const SCHEMA: u32 = 1;

/// The program that computed a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Tool {
    /// Always "sim-host".
    pub name: Cow<'static, str>,
    /// Version.
    pub version: Cow<'static, str>,
    /// Commit it was built from, "unknown" outside a repository.
    pub commit: Cow<'static, str>,
}

impl Tool {
    /// This program.
    pub const fn this() -> Self {
        Self {
            name: Cow::Borrowed("sim-host"),
            version: Cow::Borrowed(env!("CARGO_PKG_VERSION")),
            commit: Cow::Borrowed(env!("SIM_HOST_COMMIT")),
        }
    }
}
