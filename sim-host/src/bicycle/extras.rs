//! Keys that files of BicycleParameters have and the model has not: held against the model's own, then left out.

use super::combine::number;
use super::uncertain::Uncertain;
use toml::Table;

/// The letters of the model's bodies: rear wheel, rear frame, handlebar and fork, front wheel.
const BODIES: &str = "RBHF";
/// Bodies that are parts of H: handlebar and fork by themselves.
const PARTS_OF_H: [char; 2] = ['G', 'S'];
/// How far a body's centre may be from the plane of symmetry \[m\].
const PLANE_M: f64 = 1e-3;

/// The letter of the body that `key` is about: `IGxx`, `mG`, `xG`.
fn body(key: &str) -> Option<char> {
    let letters: Vec<char> = key.chars().collect();
    match letters[..] {
        ['I', body, a, b] if "xyzab".contains(a) && "xyzab".contains(b) => Some(body),
        ['m' | 'x' | 'y' | 'z', body] => Some(body),
        _ => None,
    }
    .filter(char::is_ascii_uppercase)
}

/// Whether a key is of this kind.
pub(super) fn is_extra(key: &str) -> bool {
    matches!(key, "IRzz" | "IFzz" | "yB" | "yH" | "v") || body(key).is_some_and(|b| PARTS_OF_H.contains(&b))
}

/// What a key that is neither the model's nor of this kind is about, if it is another body's.
pub(super) fn unknown_body(key: &str) -> Option<String> {
    let body = body(key).filter(|b| !BODIES.contains(*b))?;
    Some(format!(
        "`{key}` is of a body `{body}`; the model has the bodies B, F, H and R, and G and S as parts of H"
    ))
}

/// Doubts from the keys that are left out, and what of them is to be said.
///
/// # Errors
/// When they contradict the model's own values.
pub(super) fn left_out(table: &Table) -> Result<(Vec<String>, Option<String>), String> {
    let get = |key: &str| match table.get(key) {
        Some(value) => number(value).map(Some).map_err(|why| format!("`{key}`: {why}")),
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
            let why = "G and S are taken as the parts of H, and are not";
            return Err(format!("mG = {} and mS = {} kg, but mH = {} kg: {why}", g.value, s.value, h.value));
        }
    }
    let keys: Vec<&str> = table.keys().map(String::as_str).filter(|key| is_extra(key)).collect();
    Ok((warnings, (!keys.is_empty()).then(|| format!("not used: {}", keys.join(", ")))))
}

/// Whether two numbers differ by more than 3 standard deviations, or 1e-6 of them.
fn apart(a: Uncertain, b: Uncertain) -> bool {
    (a.value - b.value).abs() > (3.0 * libm::hypot(a.sd, b.sd)).max(1e-6 * a.value.abs())
}
