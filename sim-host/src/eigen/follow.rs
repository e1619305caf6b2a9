//! Following roots by continuity along a parameter.

use nalgebra::Complex;

type C = Complex<f64>;

/// A gap between two steps can't be followed further down than this share of the first step.
const FINEST: f64 = 1e-4;

/// Roots on their way along a parameter; `None` for one that has left those computed.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    at: f64,
    now: Vec<Option<C>>,
    /// Change per unit of the parameter.
    slope: Vec<C>,
    step: f64,
}

impl Followed {
    /// Begins with `roots` at the parameter `at`.
    pub(super) fn new(at: f64, roots: &[C]) -> Self {
        Self {
            at,
            now: roots.iter().copied().map(Some).collect(),
            slope: vec![C::ZERO; roots.len()],
            step: f64::INFINITY,
        }
    }

    /// The roots where it has got to.
    pub(super) fn now(&self) -> &[Option<C>] {
        &self.now
    }

    /// Goes on to the parameter `to` in steps of at most `step`, shorter where it is not plain which
    /// root is which. `roots` computes all that may be met.
    pub(super) fn go(&mut self, to: f64, step: f64, roots: &impl Fn(f64) -> Vec<C>) {
        self.step = self.step.min(step);
        while self.at != to {
            let rest = to - self.at;
            let next = if rest.abs() <= self.step { to } else { self.at + self.step.copysign(rest) };
            let found = roots(next);
            let expected: Vec<Option<C>> =
                self.now.iter().zip(&self.slope).map(|(r, s)| r.map(|r| r + s * (next - self.at))).collect();
            let matched = match plain(&expected, &found) {
                Some(matched) => matched,
                None if self.step <= step * FINEST => closest(&self.now, &found),
                None => {
                    self.step *= 0.5;
                    continue;
                }
            };
            for ((slope, now), matched) in self.slope.iter_mut().zip(&self.now).zip(&matched) {
                *slope = now.zip(*matched).map_or(C::ZERO, |(a, b)| (b - a) / (next - self.at));
            }
            (self.at, self.now) = (next, matched);
            self.step = (2.0 * self.step).min(step);
        }
    }
}

/// To each expected root the nearest found, if that is plain: nearer by half than the second, and
/// no two to one. Then no other assignment has a smaller sum of distances.
fn plain(expected: &[Option<C>], found: &[C]) -> Option<Vec<Option<C>>> {
    let mut taken = vec![false; found.len()];
    let mut matched = Vec::with_capacity(expected.len());
    for expected in expected {
        let Some(expected) = expected else {
            matched.push(None);
            continue;
        };
        let mut nearest = (0, f64::INFINITY);
        let mut second = f64::INFINITY;
        for (i, root) in found.iter().enumerate() {
            let distance = (root - expected).norm();
            if distance < nearest.1 {
                (nearest, second) = ((i, distance), nearest.1);
            } else {
                second = second.min(distance);
            }
        }
        if nearest.1 > 0.5 * second || std::mem::replace(taken.get_mut(nearest.0)?, true) {
            return None;
        }
        matched.push(Some(found[nearest.0]));
    }
    Some(matched)
}
