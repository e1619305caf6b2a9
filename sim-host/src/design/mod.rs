//! Designing a law: the gain schedule with the largest worst basin over riders and sensor delays, judged beside
//! the known laws on riders and bicycles it was not designed with. See `docs/design.md`.

mod arena;
mod judge;
mod knots;
mod search;

pub use arena::{Arena, arena};
pub use judge::{Judged, competitors, judge};
pub use knots::{GAINS, Knots};
pub use search::{Found, Plan, Progress, optimise};
