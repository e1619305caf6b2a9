//! Studies defined as sweeps in a TOML file, each with its answer as a page.

mod figure;
mod file;
mod page;
mod part_result;
mod threshold;

pub use figure::figures;
pub use file::{OptionValue, Part, Study, StudyError, StudyOptions, parse};
pub use page::{Spent, page};
pub use threshold::{Threshold, threshold};
