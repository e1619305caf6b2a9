//! Studies: each computes the answer to a question and writes it as a Markdown page with figures.

pub mod balance_assist;
pub mod catalogue;
pub mod equal_vaf;
pub mod motor_fit;
pub mod page;
pub mod prototype;
pub mod published_weave;
pub mod swept;
pub mod trial;
pub mod weave_recorded;
