//! Writes a sweep as a NetCDF file (classic format); its dimensions are the axes and the speed.

use super::document::SweepDocument;
use super::names::variable;
use super::{Axis, Found, Grid, SweepError, Unit};
use crate::ride::{Effort, FallCause};
use netcdf3::{DataSet, FileWriter, Version, WriteError};

/// Unit of a numeric axis: the typed one, otherwise the option's; `1` if dimensionless.
fn unit_of<'a>(axis: &Axis, typed: &'a str) -> &'a str {
    match (axis.key.as_str(), typed) {
        ("torque-limit", "") => "N m",
        ("rate-limit", "") => "N m s-1",
        ("time-limit", "") => "s",
        (_, "") => "1",
        (_, typed) => typed,
    }
}

/// A numeric variable.
struct Numbers<'a> {
    name: &'a str,
    units: &'a str,
    long_name: &'a str,
    dims: &'a [&'a str],
    data: Vec<f64>,
}

impl From<WriteError> for SweepError {
    fn from(error: WriteError) -> Self {
        Self::NetCdf(format!("{error:?}"))
    }
}

impl From<netcdf3::InvalidDataSet> for SweepError {
    fn from(error: netcdf3::InvalidDataSet) -> Self {
        Self::NetCdf(format!("{error:?}"))
    }
}

/// Contents of the file; unknown values are NaN.
///
/// # Errors
/// An axis has a name that NetCDF does not allow, or a temporary file can't be written.
pub(super) fn netcdf(grid: &Grid, document: &SweepDocument) -> Result<Vec<u8>, SweepError> {
    let axes = &grid.plan.axes;
    let names: Vec<String> = axes.iter().map(variable).collect();
    let mut cell_dims: Vec<&str> = names.iter().map(String::as_str).collect();
    let cells = cell_dims.clone();
    cell_dims.push("speed");
    let mut set = DataSet::new();
    for (axis, name) in axes.iter().zip(&names) {
        set.add_fixed_dim(name, axis.values.len())?;
    }
    set.add_fixed_dim("speed", grid.plan.search.speeds.len())?;
    for (axis, name) in axes.iter().zip(&names) {
        match axis.numbers() {
            Some((_, unit)) => {
                set.add_var_f64(name, &[name])?;
                set.add_var_attr_string(name, "units", unit_of(axis, unit))?;
            }
            None => {
                let length = format!("{name}_length");
                set.add_fixed_dim(&length, longest(axis))?;
                set.add_var_u8(name, &[name, &length])?;
                set.add_var_attr_string(name, "_Encoding", "utf-8")?;
            }
        }
        set.add_var_attr_string(name, "long_name", format!("--over {}", axis.key))?;
    }
    let numbers = numbers(grid, &cells, &cell_dims);
    for Numbers { name, units, long_name, dims, .. } in &numbers {
        set.add_var_f64(name, dims)?;
        set.add_var_attr_string(name, "units", units)?;
        set.add_var_attr_string(name, "long_name", long_name)?;
    }
    let tool = &grid.plan.tool;
    set.add_global_attr_string("title", "Basins of attraction over a grid of conditions")?;
    set.add_global_attr_string("source", format!("{} {} commit {}", tool.name, tool.version, tool.commit))?;
    set.add_global_attr_string("configuration", document.heading().to_string())?;
    let file = tempfile::NamedTempFile::new().map_err(SweepError::Temporary)?;
    let mut writer = FileWriter::open(file.path())?;
    writer.set_def(&set, Version::Classic, 0)?;
    for (axis, name) in axes.iter().zip(&names) {
        match axis.numbers() {
            Some((values, _)) => writer.write_var_f64(name, &values)?,
            None => writer.write_var_u8(name, &letters(axis))?,
        }
    }
    for Numbers { name, data, .. } in &numbers {
        writer.write_var_f64(name, data)?;
    }
    writer.close()?;
    std::fs::read(file.path()).map_err(SweepError::Temporary)
}

fn numbers<'a>(grid: &Grid, cells: &'a [&str], all: &'a [&str]) -> Vec<Numbers<'a>> {
    let speeds = &grid.plan.search.speeds;
    let per_speed = |of: fn(&Found) -> f64| {
        let cell = |unit: &Option<Unit>| match unit {
            Some(unit) => unit.found.iter().map(of).collect(),
            None => vec![f64::NAN; speeds.len()],
        };
        grid.units.iter().flat_map(cell).collect::<Vec<_>>()
    };
    let per_cell = |of: &dyn Fn(&Unit) -> f64| {
        grid.units.iter().map(|u| u.as_ref().map_or(f64::NAN, of)).collect::<Vec<_>>()
    };
    let variable = |name, units, long_name, dims, data| Numbers { name, units, long_name, dims, data };
    vec![
        variable("speed", "m s-1", "forward speed", &all[all.len() - 1..], speeds.clone()),
        variable("height", "rad s-1", "largest disturbance not to fall", all, per_speed(|f| f.height)),
        variable(
            "capped",
            "1",
            "1 where nothing fell: height is a lower bound",
            all,
            per_speed(|f| f64::from(u8::from(f.capped))),
        ),
        variable(
            "peak_torque",
            "N m",
            "largest torque of the border ride",
            all,
            per_speed(|f| effort(f, |e| e.peak_torque_nm)),
        ),
        variable(
            "rms_torque",
            "N m",
            "root mean square torque of the border ride",
            all,
            per_speed(|f| effort(f, |e| e.rms_torque_nm)),
        ),
        variable(
            "peak_slew",
            "N m s-1",
            "largest change of torque of the border ride",
            all,
            per_speed(|f| effort(f, |e| e.peak_slew_nm_s)),
        ),
        variable("fall_cause", "1", FALL_CODES, all, per_speed(fall_code)),
        variable("area", "rad m s-2", "area under height", cells, per_cell(&|u| grid.area(u))),
        variable("mean_height", "rad s-1", "mean of height", cells, per_cell(&Unit::mean_height)),
        variable(
            "area_capped",
            "1",
            "1 where area and mean_height are lower bounds",
            cells,
            per_cell(&|u| f64::from(u8::from(u.capped()))),
        ),
    ]
}

/// Codes of `fall_cause`, in the order of [`FallCause::ALL`].
const FALL_CODES: &str = "fall criterion of the ride beyond height: 0 roll, 1 steer, 2 laid-flat, 3 too-quick, 4 no-motion; NaN no fall";

fn fall_code(found: &Found) -> f64 {
    let name = found.fall.as_deref();
    let code = FallCause::ALL.iter().position(|cause| Some(cause.name()) == name);
    code.map_or(f64::NAN, |code| code as f64)
}

fn effort(found: &Found, of: fn(&Effort) -> f64) -> f64 {
    found.effort.as_ref().map_or(f64::NAN, of)
}

fn longest(axis: &Axis) -> usize {
    axis.values.iter().map(String::len).max().unwrap_or(1).max(1)
}

/// The values as rows of letters, padded to the same length.
fn letters(axis: &Axis) -> Vec<u8> {
    let length = longest(axis);
    let padded = |value: &String| {
        let mut bytes = value.clone().into_bytes();
        bytes.resize(length, 0);
        bytes
    };
    axis.values.iter().flat_map(padded).collect()
}
