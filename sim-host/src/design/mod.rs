//! Design of a law: the gain schedule that maximises the smallest basin area over riders and sensor delays,
//! compared with the known laws on hold-out riders and bicycles. See `docs/design.md`.

pub mod document;
mod evaluation;
mod knots;
mod scenarios;
mod search;

pub use evaluation::{Evaluation, competitors, evaluate, evaluate_in};
pub use knots::{GAINS, Knots};
pub use scenarios::{Scenarios, scenarios};
pub use search::{DesignError, Found, Plan, Progress, optimise};
