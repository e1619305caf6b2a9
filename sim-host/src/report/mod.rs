//! Outputs of the program: documents, tables, figures, files.

pub mod board;
pub mod compare;
pub mod design;
pub mod document;
pub mod figure;
pub mod output;
pub mod picture;
pub mod plane;
pub mod replay;
pub mod resolved;
pub mod rider;
pub mod sensor;
pub mod sweep;
pub mod table;
pub mod terminal;
pub mod weave;
