//! How much of what a board said was understood.

use schemars::JsonSchema;
use serde::Serialize;

/// What was heard, whole or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Reception {
    /// Frames that came whole.
    pub frames: u64,
    /// Frames that came damaged.
    pub damaged: u32,
    /// Whole frames that say what this program does not know.
    pub unknown: u64,
    /// Bytes at the end of a recording that are the beginning of a frame.
    pub rest: usize,
}

impl Reception {
    /// What of it could not be read, in words; `None` if all could.
    pub fn unread(&self) -> Option<String> {
        let Self { damaged, unknown, rest, .. } = *self;
        let parts = [
            (damaged > 0).then(|| format!("{damaged} frames damaged")),
            (unknown > 0).then(|| format!("{unknown} frames not understood")),
            (rest > 0).then(|| format!("it ends within a frame ({rest} bytes)")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }
}
