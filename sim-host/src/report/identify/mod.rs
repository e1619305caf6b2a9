//! Document, table, text, figure and page of `sim-host identify RECORD`.

mod chart;
pub mod correlation;
mod document;
mod page;
mod plots;
mod rows;
mod text;
mod warnings;

pub use chart::chart;
pub use document::{
    BlackBox, DelayEntry, DelayEstimate, GainValue, IdentifyDocument, IdentifyManyDocument, OptimumEntry,
    RecordEntry, ReductionEntry, ResolvedIdentify, Unidentified,
};
pub use page::page;
pub use rows::{ReductionRow, rows};
pub use text::text;
