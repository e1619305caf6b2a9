//! Outputs of the program: documents, tables, figures, files.

pub mod board;
pub mod closed_loop;
pub mod compare;
pub mod document;
pub mod figure;
pub(crate) mod html;
pub mod identify;
pub mod mcap;
pub mod netcdf;
pub mod output;
pub mod perturbation;
pub mod picture;
pub mod plane;
pub mod replay;
pub mod resolved;
pub mod rider;
pub mod sensor;
pub mod table;
pub mod terminal;
pub mod tool;
pub mod weave;
