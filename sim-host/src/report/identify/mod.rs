//! Document, table and text of `sim-host identify RECORD`.

mod chart;
mod document;
mod rows;
mod text;

pub use chart::chart;
pub use document::{
    BlackBox, DelayEntry, DelayEstimate, GainValue, IdentifyDocument, IdentifyManyDocument, OptimumEntry,
    RecordEntry, ReductionEntry, ResolvedIdentify, Unidentified,
};
pub use rows::{ReductionRow, rows};
pub use text::text;
