//! A rider's body from a separate file, found by name as the Python package BicycleParameters does.

use super::check::check;
use super::combine::RIDER_KEYS;
use super::error::{BicycleError, SetError};
use super::set::Bicycle;
use super::uncertain::{Measured, Uncertain};
use crate::range::{RangeError, within};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Splits `BICYCLE+RIDER`; `None` if `name` has another form or is an existing file.
pub(super) fn split(name: &str) -> Option<(&str, &str)> {
    let parts = name.rsplit_once('+').filter(|(bicycle, rider)| !bicycle.is_empty() && !rider.is_empty());
    parts.filter(|_| !Path::new(name).exists())
}

/// File of a bicycle's folder in the package's `data/bicycles`: for `Rigid`,
/// `Rigid/Parameters/RigidBenchmark.txt`.
pub(super) fn packaged(path: &Path) -> PathBuf {
    match path.file_name().filter(|_| path.is_dir()) {
        Some(name) => path.join("Parameters").join(format!("{}Benchmark.txt", name.to_string_lossy())),
        None => path.into(),
    }
}

/// The rider's file: `rider` itself, or found by name next to the bicycle's file, as in the package:
/// `riders/Jason/Parameters/JasonRigidBenchmark.txt` next to `bicycles/Rigid/Parameters/RigidBenchmark.txt`.
pub(super) fn rider_file(bicycle: &str, rider: &str) -> PathBuf {
    if Path::new(rider).is_file() {
        return rider.into();
    }
    let file = packaged(Path::new(bicycle));
    let stem = file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let name = stem.strip_suffix("Benchmark").unwrap_or(&stem);
    let data = file.ancestors().nth(4).unwrap_or(Path::new(""));
    data.join("riders").join(rider).join("Parameters").join(format!("{rider}{name}Benchmark.txt"))
}

/// Adds the rider's body in `table`, from the file `path`, to the bicycle `base`, which was loaded as `bicycle`; `name` is
/// the name of both.
///
/// # Errors
/// The key, the value and its range; or the bicycle has a rider already.
pub(super) fn with_rider(
    name: &str,
    bicycle: &str,
    base: Bicycle,
    table: &Table,
    path: &Path,
) -> Result<Bicycle, BicycleError> {
    let wrong = |reason: SetError| BicycleError::Set { set: path.display().to_string(), reason };
    if let Some(key) = table.keys().find(|key| !RIDER_KEYS.contains(&key.as_str())) {
        return Err(wrong(SetError::RiderKey(key.clone())));
    }
    let mut body = Vec::new();
    for key in RIDER_KEYS {
        let value = table.get(key);
        // yB is optional: zero in the plane of symmetry.
        let value = value.cloned().or((key == "yB").then_some(Value::Float(0.0)));
        let value = value.ok_or_else(|| wrong(SetError::RiderMissing(key)))?;
        let number = Uncertain::of_value(&value);
        body.push(number.map_err(|error| wrong(SetError::OtherNumber { key: key.into(), error }))?);
    }
    check_body(&body).map_err(|error| wrong(error.into()))?;
    if base.rider_included == Some(true) {
        return Err(wrong(SetError::HasRider(bicycle.into())));
    }
    let bicycle_values = match base.measured {
        Some(Measured { bicycle, rider: None }) => bicycle,
        _ => base.parameters.to_values().map(Uncertain::exact).to_vec(),
    };
    let measured = Measured { bicycle: bicycle_values, rider: Some(body) };
    let parameters = measured.parameters();
    let mut warnings = check(&parameters).map_err(|error| wrong(error.into()))?;
    warnings.extend(base.warnings.iter().filter(|w| !warnings.contains(w)).cloned().collect::<Vec<_>>());
    let source = format!("{} and {}", base.source.as_deref().unwrap_or(bicycle), path.display());
    let measured = Some(measured).filter(Measured::is_uncertain);
    Ok(Bicycle {
        name: name.into(),
        source: Some(source),
        note: base.note,
        rider_included: Some(true),
        warnings,
        measured,
        parameters,
    })
}

fn check_body(body: &[Uncertain]) -> Result<(), RangeError> {
    const RANGES: [(f64, f64); 8] = [
        (1e-3, 500.0),
        (-5.0, 5.0),
        (-0.1, 0.1),
        (-5.0, 0.0),
        (1e-9, 500.0),
        (-500.0, 500.0),
        (1e-9, 500.0),
        (1e-9, 500.0),
    ];
    for ((key, one), (min, max)) in RIDER_KEYS.iter().zip(body).zip(RANGES) {
        within(&format!("`{key}`"), one.value, min, max)?;
    }
    Ok(())
}
