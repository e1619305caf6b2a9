//! Figures of results: pure functions from data to a [`Picture`].

mod basin;
mod canvas;
mod colour;
mod eigen;
mod legend;
mod modes;
mod outlines;
mod panel;
mod ride;
pub(super) mod scale;
mod time_scale;

pub use basin::{BasinFigure, basin};
pub use canvas::{Picture, PictureError};
pub use eigen::{EigenFigure, eigen};
pub(super) use ride::Curve;
pub use ride::{RideFigure, ride};

#[cfg(test)]
mod tests;
