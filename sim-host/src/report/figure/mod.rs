//! Figures of results: pure functions from data to a [`Picture`].

mod basin;
mod canvas;
mod colour;
mod eigen;
mod inside;
mod legend;
mod modes;
mod outlines;
mod panel;
mod picture;
mod ride;
pub(super) mod scale;
mod shape;
mod time_scale;

pub use basin::{BasinFigure, basin};
pub use eigen::{EigenFigure, eigen};
pub use picture::{Picture, PictureError};
pub(super) use ride::Curve;
pub use ride::{RideFigure, ride};

#[cfg(test)]
mod tests;
