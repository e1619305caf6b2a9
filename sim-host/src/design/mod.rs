//! Designing a law: the gain schedule with the largest worst basin over riders and sensor delays, judged beside
//! the known laws on riders and bicycles it was not designed with. See `docs/design.md`.

mod evaluation;
mod knots;
mod scenarios;
mod search;

pub use evaluation::{Judged, competitors, judge};
pub use knots::{GAINS, Knots};
pub use scenarios::{Scenarios, arena};
pub use search::{Found, Plan, Progress, optimise};
