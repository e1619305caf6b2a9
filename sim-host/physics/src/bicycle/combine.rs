//! Combines a bicycle with a rider's body from a separate file, found by name, as the Python package
//! BicycleParameters does (`combine_bike_rider`).

use super::Parameters;
use super::catalogue::{Bicycle, BicycleError, load, read_table};
use super::uncertain::{Measured, Uncertain};
use std::path::{Path, PathBuf};
use toml::Value;

/// Keys of a rider's body, in the bicycle's axes: mass \[kg\], centre of mass \[m\], inertia about the centre
/// of mass \[kg m^2\].
pub const RIDER_KEYS: [&str; 8] = ["mB", "xB", "yB", "zB", "IBxx", "IBxz", "IByy", "IBzz"];

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
fn rider_file(bicycle: &str, rider: &str) -> PathBuf {
    if Path::new(rider).is_file() {
        return rider.into();
    }
    let file = packaged(Path::new(bicycle));
    let stem = file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let name = stem.strip_suffix("Benchmark").unwrap_or(&stem);
    let data = file.ancestors().nth(4).unwrap_or(Path::new(""));
    data.join("riders").join(rider).join("Parameters").join(format!("{rider}{name}Benchmark.txt"))
}

/// Loads a bicycle and adds a rider's body from a second file.
///
/// # Errors
/// As [`load`], for either file.
pub(super) fn load_with(name: &str, bicycle: &str, rider: &str) -> Result<Bicycle, BicycleError> {
    let base = load(bicycle)?;
    let path = rider_file(bicycle, rider);
    let table = read_table(&path)?;
    let wrong = |reason: String| BicycleError::Set { set: path.display().to_string(), reason };
    if let Some(key) = table.keys().find(|key| !RIDER_KEYS.contains(&key.as_str())) {
        return Err(wrong(format!("unknown key `{key}`; a rider's body has {}", RIDER_KEYS.join(", "))));
    }
    let mut body = Vec::new();
    for key in RIDER_KEYS {
        let value = table.get(key);
        // yB is optional: zero in the plane of symmetry.
        let value = value.cloned().or((key == "yB").then_some(Value::Float(0.0)));
        let value = value.ok_or_else(|| wrong(format!("`{key}` is missing")))?;
        body.push(number(&value).map_err(|error| wrong(format!("`{key}`: {error}")))?);
    }
    check_body(&body).map_err(wrong)?;
    if base.rider_included == Some(true) {
        return Err(wrong(format!("the bicycle {bicycle} has a rider already (rider_included = true)")));
    }
    let bicycle_values = match base.measured {
        Some(Measured { bicycle, rider: None }) => bicycle,
        _ => base.parameters.to_values().map(Uncertain::exact).to_vec(),
    };
    let measured = Measured { bicycle: bicycle_values, rider: Some(body) };
    let parameters = measured.parameters();
    let mut warnings = super::check::check(&parameters).map_err(wrong)?;
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

/// A number from a file, with or without uncertainty.
///
/// # Errors
/// The value is not a number; states its type.
pub(super) fn number(value: &Value) -> Result<Uncertain, String> {
    match value {
        Value::Float(x) => Ok(Uncertain::exact(*x)),
        Value::Integer(i) => Ok(Uncertain::exact(*i as f64)),
        Value::String(text) if text.contains("+/-") || text.contains('±') => Uncertain::parse(text),
        other => Err(format!("must be a number, not the {} {other}", other.type_str())),
    }
}

fn check_body(body: &[Uncertain]) -> Result<(), String> {
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
        if !(one.value >= min && one.value <= max) {
            return Err(format!("`{key}` = {} is outside {min} to {max}", one.value));
        }
    }
    Ok(())
}

/// The bicycle with a rider's body (in the order of [`RIDER_KEYS`]) fixed to its rear frame.
pub fn combined(bicycle: &Parameters, rider: &[f64; RIDER_KEYS.len()]) -> Parameters {
    let p = *bicycle;
    let [m, x, y, z, xx, xz, yy, zz] = *rider;
    let mass = m + p.mB;
    let middle = |rider: f64, frame: f64| (m * rider + p.mB * frame) / mass;
    let (cx, cy, cz) = (middle(x, p.xB), middle(y, 0.0), middle(z, p.zB));
    // Parallel-axis theorem; the frame's centre is taken in the plane y = 0 of the whole, as in the package.
    let (r, f) = ((x - cx, y - cy, z - cz), (p.xB - cx, 0.0, p.zB - cz));
    let sum = |of: fn((f64, f64, f64)) -> f64| m * of(r) + p.mB * of(f);
    Parameters {
        mB: mass,
        xB: cx,
        zB: cz,
        IBxx: xx + p.IBxx + sum(|(_, y, z)| y * y + z * z),
        IBxz: xz + p.IBxz - sum(|(x, _, z)| x * z),
        IByy: yy + p.IByy + sum(|(x, _, z)| x * x + z * z),
        IBzz: zz + p.IBzz + sum(|(x, y, _)| x * x + y * y),
        ..p
    }
}
