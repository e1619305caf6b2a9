//! Keys of BicycleParameters' files that the model does not use: checked against the model's values, then
//! left out.

use super::error::SetError;
use super::uncertain::Uncertain;
use toml::Table;

/// Letters of the model's bodies: rear wheel, rear frame, handlebar and fork, front wheel.
const BODIES: &str = "RBHF";
/// Bodies that are parts of H: handlebar and fork separately.
const PARTS_OF_H: [char; 2] = ['G', 'S'];
/// Largest distance of a body's centre from the plane of symmetry \[m\].
const PLANE_M: f64 = 1e-3;

/// Letter of the body in `key`: G in `IGxx`, `mG`, `xG`.
fn body(key: &str) -> Option<char> {
    let letters: Vec<char> = key.chars().collect();
    match letters[..] {
        ['I', body, a, b] if "xyzab".contains(a) && "xyzab".contains(b) => Some(body),
        ['m' | 'x' | 'y' | 'z', body] => Some(body),
        _ => None,
    }
    .filter(char::is_ascii_uppercase)
}

/// Whether a key is one of these.
pub(super) fn is_extra(key: &str) -> bool {
    matches!(key, "IRzz" | "IFzz" | "yB" | "yH" | "v") || body(key).is_some_and(|b| PARTS_OF_H.contains(&b))
}

/// The body of a key if the model does not have it.
pub(super) fn unknown_body(key: &str) -> Option<char> {
    body(key).filter(|b| !BODIES.contains(*b))
}

/// Warnings from the unused keys, and a remark that lists them.
///
/// # Errors
/// A value contradicts the model's own.
pub(super) fn left_out(table: &Table) -> Result<(Vec<String>, Option<String>), SetError> {
    let get = |key: &str| match table.get(key) {
        Some(value) => {
            let number = Uncertain::of_value(value).map(Some);
            number.map_err(|error| SetError::OtherNumber { key: key.into(), error })
        }
        None => Ok(None),
    };
    let mut warnings = Vec::new();
    for (other, own) in [("IRzz", "IRxx"), ("IFzz", "IFxx")] {
        if let (Some(a), Some(b)) = (get(other)?, get(own)?)
            && apart(a, b)
        {
            warnings.push(format!(
                "{other} = {} is not {own} = {}: a wheel is round, {own} is used",
                a.value, b.value
            ));
        }
    }
    for key in ["yB", "yH"] {
        if let Some(y) = get(key)?.filter(|y| y.value.abs() > PLANE_M) {
            warnings
                .push(format!("{key} = {} m: frames are in the plane of symmetry here, 0 is used", y.value));
        }
    }
    let masses = (get("mG")?, get("mS")?, get("mH")?);
    if let (Some(g), Some(s), Some(h)) = masses {
        let parts = Uncertain { value: g.value + s.value, sd: libm::hypot(g.sd, s.sd) };
        if apart(parts, h) {
            return Err(SetError::Parts { g: g.value, s: s.value, h: h.value });
        }
    }
    let keys: Vec<&str> = table.keys().map(String::as_str).filter(|key| is_extra(key)).collect();
    Ok((warnings, (!keys.is_empty()).then(|| format!("not used: {}", keys.join(", ")))))
}

/// Whether two numbers differ by more than 3 standard deviations, or by a relative 1e-6.
fn apart(a: Uncertain, b: Uncertain) -> bool {
    (a.value - b.value).abs() > (3.0 * libm::hypot(a.sd, b.sd)).max(1e-6 * a.value.abs())
}
