//! Writes the results of a whole sweep to files.

use super::document::{SweepDocument, cells_table, heights_table};
use super::maps::pictures;
use super::netcdf::netcdf;
use super::{Folder, Grid, SweepError};
use crate::report::netcdf::Format;
use crate::report::picture::{caption, svg_with_caption};

/// Writes `sweep.json`, `sweep.nc`, `sweep.csv`, `heights.csv` and `figures/*.svg` to `folder`, replacing
/// older files of these names, and removes what only the computation needed.
///
/// # Errors
/// A file can't be written.
pub fn write(grid: &Grid, document: &SweepDocument, folder: &Folder) -> Result<(), SweepError> {
    folder.write("sweep.nc", &netcdf(grid, document).bytes(Format::Classic)?)?;
    folder.write("sweep.csv", &cells_table(document)?)?;
    folder.write("heights.csv", &heights_table(document)?)?;
    let about = caption(&document.heading());
    for (name, picture) in pictures(grid) {
        let svg = svg_with_caption(&picture.svg(), &about);
        folder.write(&format!("figures/{name}.svg"), svg.as_bytes())?;
    }
    let json = serde_json::to_string_pretty(document)?;
    folder.write("sweep.json", (json + "\n").as_bytes())?;
    folder.tidy();
    Ok(())
}
