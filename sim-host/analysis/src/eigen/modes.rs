//! Modes of a model over speed, followed by continuity.

use super::follow::{Followed, Found};
use super::qr::spectrum;
use super::roots::{roots, same};
use super::sort;
use super::system::{DelaySystem, Model};
use nalgebra::Complex;

/// Speed at which modes are named \[m/s\]; a bicycle's modes are well separated there.
pub const REFERENCE_SPEED_M_S: f64 = 10.0;
/// Largest step over speed \[m/s\].
const SPEED_STEP: f64 = 0.1;
/// Largest step of the feedback's strength from 0 to 1.
const STRENGTH_STEP: f64 = 0.05;
/// Additional roots computed, so that the followed ones are not lost when others overtake them.
const SPARE: usize = 2;

/// A mode: the two roots that form a pair at the reference speed, or one real root there.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// "weave", "capsize", "caster", or "rider 1", "rider 2" ... for modes that a rider adds, "actuator 1"
    /// ... without a rider.
    pub name: String,
    /// Its roots at all speeds \[1/s\]; `None` where a root lies left of all computed ones.
    pub roots: Vec<Vec<Option<Complex<f64>>>>,
}

/// The modes at `speeds` \[m/s\]: weave, capsize, caster and, with a rider, those of the `count` rightmost
/// roots at the reference speed.
///
/// The names are those of the uncontrolled bicycle at [`REFERENCE_SPEED_M_S`]: weave is its complex pair,
/// caster the more negative real root, capsize the other (Meijaard et al. 2007). From there the roots are
/// followed while the feedback's strength grows from 0 to 1, then over speed. Each root keeps its name: below
/// `v_d` weave is two real roots. Where two modes meet, form a pair and separate again, each leaves on its
/// side.
pub fn modes(model: &Model, speeds: &[f64], count: usize) -> Vec<Mode> {
    modes_until(model, speeds, count, &|| false).unwrap_or_default()
}

/// As [`modes`]; `stop` is called at every step over speed and strength, and there are no modes once it returns true.
pub fn modes_until(
    model: &Model,
    speeds: &[f64],
    count: usize,
    stop: &dyn Fn() -> bool,
) -> Option<Vec<Mode>> {
    let (names, start) = named(model, count, stop)?;
    let find = |v: f64| (!stop()).then(|| found(&model.at(v), start.len()));
    let mut curves: Vec<Vec<Option<Complex<f64>>>> = vec![vec![None; speeds.len()]; start.len()];
    let mut order: Vec<usize> = (0..speeds.len()).collect();
    order.sort_by(|&i, &j| speeds[i].total_cmp(&speeds[j]));
    let (below, above): (Vec<usize>, Vec<usize>) =
        order.into_iter().partition(|&i| speeds[i] <= REFERENCE_SPEED_M_S);
    for direction in [below.into_iter().rev().collect(), above] {
        let mut followed = Followed::new(REFERENCE_SPEED_M_S, &start);
        for i in direction {
            followed.go(speeds[i], SPEED_STEP, &find)?;
            for (curve, root) in curves.iter_mut().zip(followed.now()) {
                curve[i] = *root;
            }
        }
    }
    let mut modes: Vec<Mode> = Vec::new();
    for (name, curve) in names.into_iter().zip(curves) {
        match modes.iter_mut().find(|mode| mode.name == name) {
            Some(mode) => mode.roots.push(curve),
            None => modes.push(Mode { name, roots: vec![curve] }),
        }
    }
    Some(modes)
}

/// The rightmost roots of a system of which `count` are followed.
fn found(system: &DelaySystem, count: usize) -> Found {
    Found { roots: roots(system, count + SPARE), all: system.is_ordinary() }
}

/// Names and roots at the reference speed; `None` once `stop` returns true.
fn named(model: &Model, count: usize, stop: &dyn Fn() -> bool) -> Option<(Vec<String>, Vec<Complex<f64>>)> {
    let v = REFERENCE_SPEED_M_S;
    let find = |strength: f64| {
        let system = model.scaled(v, strength);
        (!stop()).then(|| found(&system, system.a.nrows()))
    };
    let mut bicycle = spectrum(&model.linear().state_matrix(v, 0.0)).unwrap_or_default();
    // Real roots last, the most negative at the end.
    sort(&mut bicycle);
    bicycle.sort_by_key(|root| root.im == 0.0);
    let mut followed = Followed::new(0.0, &bicycle);
    followed.go(1.0, STRENGTH_STEP, &find)?;
    let named = ["weave", "weave", "capsize", "caster"].into_iter().zip(followed.now());
    let mut modes: Vec<(String, Complex<f64>)> =
        named.filter_map(|(name, root)| Some((name.to_owned(), (*root)?))).collect();
    let mut number = 0;
    for root in roots(&model.at(v), count) {
        if modes.iter().any(|(_, known)| same(*known, root)) {
            continue;
        }
        let name = match modes.iter().find(|(_, known)| same(*known, root.conj())) {
            Some((name, _)) => name.clone(),
            None => {
                number += 1;
                format!("{} {number}", model.adds())
            }
        };
        modes.push((name, root));
    }
    Some(modes.into_iter().unzip())
}
