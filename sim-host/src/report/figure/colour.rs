//! Colours that are distinguishable for colour-blind readers and in print.

use kuva::plot::ColorMap;

/// Lines, text and outlines.
pub(super) const INK: &str = "#222222";
/// Secondary lines.
pub(super) const GREY: &str = "#888888";
/// The self-stable range of the uncontrolled bicycle.
pub(super) const STABLE: &str = "#9aa5b1";
/// The basin of attraction.
pub(super) const BASIN: &str = "#fff0b3";
/// Islands: ranges without a fall beyond the first fall.
pub(super) const ISLAND: &str = "#9fd8c4";
/// A fall.
pub(super) const FALL: &str = "#b2182b";

/// Okabe and Ito's palette without its yellow, which is too light for lines.
pub(super) const SERIES: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#222222", "#e69f00", "#56b4e9"];

/// Number of shades of a colour scale.
pub(super) const SHADES: usize = 48;

/// Shade `i` of [`SHADES`] for times to fall: cold for short, warm for long. The palest end of the scale is omitted,
/// since it would be invisible beside the basin.
pub(super) fn shade(i: usize) -> String {
    ColorMap::Plasma.map(0.82 * i as f64 / (SHADES - 1) as f64)
}
