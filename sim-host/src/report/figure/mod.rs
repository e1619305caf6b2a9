//! Figures of results: pure functions from data to a [`Picture`].

mod basin;
mod basin_axes;
mod canvas;
mod chart;
mod chart_axes;
mod colour;
mod eigen;
mod heatmap;
mod inside;
mod legend;
mod marker;
mod modes;
mod outlines;
mod panel;
mod picture;
mod plane;
mod replay;
mod ride;
pub(super) mod scale;
mod shape;
mod thin;
mod time_scale;

pub use basin::basin;
pub use basin_axes::{Band, BasinFigure};
pub use chart::{Chart, Line, Look, Plot, Series, chart};
pub use chart_axes::Axis;
pub use eigen::{EigenFigure, eigen};
pub use heatmap::{HeatMap, Map, heatmap};
pub use marker::Marker;
pub use picture::{Picture, PictureError};
pub use plane::{PlaneFigure, plane};
pub use replay::{ReplayFigure, replay};
pub(super) use ride::Curve;
pub use ride::{RideFigure, ride};
pub(super) use thin::thinned;

#[cfg(test)]
mod tests;
