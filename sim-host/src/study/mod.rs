//! Studies: a question, computed, and its answer as a page of Markdown with a figure.

pub mod balance_assist;
pub mod motor_fit;
pub mod page;
pub mod prototype;
pub mod trial;
