//! Studies: a question, computed, and its answer as a page of Markdown with figures.

pub mod balance_assist;
pub mod catalogue;
pub mod motor_fit;
pub mod page;
pub mod prototype;
pub mod swept;
pub mod trial;
pub mod weave_recorded;
