//! Outputs of `identify weave`: document, table, text, figure.

mod chart;
mod document;
mod table;
mod text;

pub use chart::{Curves, chart};
pub use document::{Predicted, RecordingEntry, RefusedEntry, ResolvedWeave, WeaveDocument, WeaveEntry};
pub use table::{WeaveRow, rows};
pub use text::text;
