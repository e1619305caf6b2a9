//! Studies defined as sweeps in a TOML file, each with its answer as a page.

mod error;
mod figure;
mod file;
mod options;
mod page;
mod part_result;
mod threshold;

pub use error::{PartError, StudyError};
pub use figure::figures;
pub use file::{Part, Study, parse};
pub use options::{OptionValue, StudyOptions};
pub use page::{Spent, page};
pub use threshold::{Threshold, threshold};
