//! Counts of what was received from a board, whole, damaged or unknown.

use crate::counted::counted;
use schemars::JsonSchema;
use serde::Serialize;

/// Counts of received frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Reception {
    /// Frames received whole.
    pub frames: u64,
    /// Frames received damaged.
    pub damaged: u32,
    /// Whole frames whose content this program does not know.
    pub unknown: u64,
    /// Bytes at the end of a recording that belong to an incomplete frame.
    pub rest: usize,
}

impl Reception {
    /// What could not be decoded, as text; `None` if all was.
    pub fn unread(&self) -> Option<String> {
        let Self { damaged, unknown, rest, .. } = *self;
        let parts = [
            (damaged > 0).then(|| counted(damaged, "frame damaged", "frames damaged")),
            (unknown > 0).then(|| counted(unknown, "frame not understood", "frames not understood")),
            (rest > 0).then(|| format!("it ends within a frame ({rest} bytes)")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }
}
