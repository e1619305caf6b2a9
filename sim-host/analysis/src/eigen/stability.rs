//! Speed ranges in which straight riding is stable, for any linear model.

use super::critical::{CriticalSpeeds, SEARCH_TO_M_S, bisect, critical_speeds, grows, rightmost_pair};
use super::roots::roots;
use super::system::Model;
use rayon::prelude::*;

/// Step of the search \[m/s\].
const STEP_M_S: f64 = 0.02;
/// Number of roots examined: the rightmost pair and the real roots next to it.
const ROOTS: usize = 6;

/// Roots that cross the imaginary axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Crossing {
    /// A complex pair: weave, or another oscillation.
    Pair,
    /// A real root: capsize, or another drift.
    Real,
}

/// A speed at which small disturbances start or cease to grow.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct StabilityChange {
    /// The speed \[m/s\].
    pub speed: f64,
    /// Whether straight riding is stable above it.
    pub stable_above: bool,
    /// Roots that cross: "pair" or "real".
    #[schemars(with = "String", extend("enum" = ["pair", "real"]))]
    pub crossing: Crossing,
}

/// Stability of straight riding, from rest to [`SEARCH_TO_M_S`].
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// The critical speeds.
    pub critical: CriticalSpeeds,
    /// Speed ranges without an unstable root \[m/s\].
    pub ranges: Vec<(f64, f64)>,
    /// Ends of these ranges, without those of the search.
    pub changes: Vec<StabilityChange>,
}

/// Stability of a model. Changes are located by bisection to rounding; ranges narrower than 0.02 m/s can be
/// missed.
///
/// With a law and no rider the critical speeds are those of [`critical_speeds`]. Otherwise `v_w` and `v_c`
/// are the first speeds at which the rightmost pair becomes stable and at which a real root becomes positive;
/// `v_d` is not computed. `None` if there is a speed at which no root converges.
pub fn stability(model: &Model) -> Option<Stability> {
    stability_until(model, &|| false)
}

/// As [`stability`]; `stop` is called at every speed, and there is none once it returns true.
pub fn stability_until(model: &Model, stop: &(dyn Fn() -> bool + Sync)) -> Option<Stability> {
    let steps = (SEARCH_TO_M_S / STEP_M_S).round() as usize;
    let look = |v: f64| if stop() { None } else { Look::at(model, v) };
    let looks: Vec<Look> =
        (0..=steps).into_par_iter().map(|i| look(i as f64 * STEP_M_S)).collect::<Option<_>>()?;
    let (grows, pair_grows) = (definite(&looks, |look| look.grows), definite(&looks, |look| look.pair_grows));
    let between = |w: &[Look], below: &dyn Fn(&Look) -> bool| {
        bisect((w[0].speed, w[1].speed), |v| look(v).is_some_and(|look| below(&look)))
    };
    let changes: Vec<StabilityChange> = looks
        .windows(2)
        .zip(grows.windows(2))
        .filter(|(_, grows)| grows[0] != grows[1])
        .map(|(w, grows)| {
            let stable_above = grows[0];
            let speed = between(w, &|look| (look.growth > 0.0) == stable_above);
            let unstable = if stable_above { &w[0] } else { &w[1] };
            let crossing = if unstable.pair == unstable.growth { Crossing::Pair } else { Crossing::Real };
            StabilityChange { speed, stable_above, crossing }
        })
        .collect();
    let critical = match model.law_alone() {
        Some(law) => critical_speeds(model.linear(), law),
        None => CriticalSpeeds {
            v_d: None,
            v_w: looks
                .windows(2)
                .zip(pair_grows.windows(2))
                .find(|(_, grows)| grows[0] && !grows[1])
                .map(|(w, _)| between(w, &|look| look.pair > 0.0)),
            v_c: looks
                .windows(2)
                .find(|w| w[0].turn > 0.0 && w[1].turn <= 0.0)
                .map(|w| between(w, &|look| look.turn > 0.0)),
        },
    };
    (!stop()).then(|| Stability { critical, ranges: ranges(!grows[0], &changes), changes })
}

/// Replaces undecided signs (zero within rounding) by that of the speed below; at the first speed by that
/// above.
fn definite(looks: &[Look], of: impl Fn(&Look) -> Option<bool>) -> Vec<bool> {
    let mut last = looks.iter().find_map(&of).unwrap_or(false);
    let mut with_last = |look| {
        last = of(look).unwrap_or(last);
        last
    };
    looks.iter().map(&mut with_last).collect()
}

fn ranges(stable_at_rest: bool, changes: &[StabilityChange]) -> Vec<(f64, f64)> {
    let ends = stable_at_rest.then_some(0.0).into_iter().chain(changes.iter().map(|c| c.speed));
    let ends: Vec<f64> = ends.chain([SEARCH_TO_M_S]).collect();
    ends.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Quantities that determine stability at a speed.
struct Look {
    speed: f64,
    /// Largest real part \[1/s\].
    growth: f64,
    /// Whether `growth` is positive; `None` if zero within rounding.
    grows: Option<bool>,
    /// Largest real part of a complex pair \[1/s\].
    pair: f64,
    /// Whether `pair` is positive; `None` if zero within rounding.
    pair_grows: Option<bool>,
    /// Characteristic determinant at zero; it changes its sign where a real root does.
    turn: f64,
}

impl Look {
    /// `None` if no root converges.
    fn at(model: &Model, speed: f64) -> Option<Self> {
        let system = model.at(speed);
        let roots = roots(&system, ROOTS);
        let turn = (-system.undelayed()).determinant();
        let (growth, pair) = (roots.first()?.re, rightmost_pair(&roots));
        Some(Self {
            speed,
            growth,
            grows: grows(growth, &roots),
            pair,
            pair_grows: grows(pair, &roots),
            turn,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_lie_between_changes() {
        let change = |speed, stable_above| StabilityChange { speed, stable_above, crossing: Crossing::Pair };
        assert_eq!(ranges(false, &[]), []);
        assert_eq!(ranges(true, &[]), [(0.0, 20.0)]);
        assert_eq!(ranges(false, &[change(2.0, true), change(5.0, false)]), [(2.0, 5.0)]);
        let thrice = [change(2.0, false), change(5.0, true)];
        assert_eq!(ranges(true, &thrice), [(0.0, 2.0), (5.0, 20.0)]);
    }
}
