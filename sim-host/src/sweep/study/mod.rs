//! Studies: questions answered by sweeps that are written down, with the answer as a page.

mod answer;
mod catalogue;
mod figure;
mod keep;
mod page;

pub use catalogue::{Part, Study, StudyError, load, shipped};
pub use figure::figures;
pub use keep::{Kept, kept};
pub use page::{Spent, page};
