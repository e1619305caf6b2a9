//! Questions answered by sweeps that are written down, with the answer as a page.

mod answer;
mod figure;
mod file;
mod keep;
mod page;

pub use figure::figures;
pub use file::{Part, Study, StudyError, parse};
pub use keep::{Kept, kept};
pub use page::{Spent, page};
