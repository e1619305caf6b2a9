//! Figure of basins of attraction over speed.

use super::basin_axes::BasinFigure;
use super::inside::inside_and_outside;
use super::outlines::outlines;
use super::picture::Picture;

/// The figure of one basin, or of the outlines of several.
///
/// One basin: its inside filled, hatched where a ride lasts the time limit without recovering; outside, a dot for each
/// ride of the scan in the colour of its time to fall.
pub fn basin(figure: &BasinFigure) -> Picture {
    match figure.series {
        [(name, basin)] => inside_and_outside(figure, name, basin),
        _ => outlines(figure),
    }
}
