//! Follows roots by continuity along a parameter.

use nalgebra::{Complex, ComplexField};

type C = Complex<f64>;

/// Smallest step, as a fraction of the first step.
const FINEST: f64 = 1e-4;

/// Roots of a system at one value of the parameter.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// The rightmost roots.
    pub(super) roots: Vec<C>,
    /// Whether these are all roots.
    pub(super) all: bool,
}

/// A root is given up when it is expected this far left of the leftmost computed root, relative to that root.
const BEYOND: f64 = 0.1;

/// Roots followed along a parameter; `None` for one that has left the computed range.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    at: f64,
    now: Vec<Option<C>>,
    /// Derivative with respect to the parameter.
    slope: Vec<C>,
    step: f64,
}

impl Followed {
    /// Starts with `roots` at the parameter `at`.
    pub(super) fn new(at: f64, roots: &[C]) -> Self {
        Self {
            at,
            now: roots.iter().copied().map(Some).collect(),
            slope: vec![C::ZERO; roots.len()],
            step: f64::INFINITY,
        }
    }

    /// Roots at the current parameter.
    pub(super) fn now(&self) -> &[Option<C>] {
        &self.now
    }

    /// Continues to the parameter `to` in steps of at most `step`, shorter where the assignment of roots is
    /// ambiguous. `None` once `find` gives none.
    pub(super) fn go(&mut self, to: f64, step: f64, find: &impl Fn(f64) -> Option<Found>) -> Option<()> {
        self.step = self.step.min(step);
        while self.at != to {
            let rest = to - self.at;
            let next = if rest.abs() <= self.step { to } else { self.at + self.step.copysign(rest) };
            let found = find(next)?;
            let edge = if found.all { None } else { found.roots.last() };
            let edge = edge.map_or(f64::NEG_INFINITY, |last| last.re - BEYOND * last.modulus());
            let ahead = |(root, slope): (&Option<C>, &C)| {
                root.map(|r| r + slope * (next - self.at)).filter(|expected| expected.re >= edge)
            };
            let expected: Vec<Option<C>> = self.now.iter().zip(&self.slope).map(ahead).collect();
            let matched = match plain(&expected, &found.roots) {
                Some(matched) => matched,
                None if self.step <= step * FINEST => closest(&self.now, &found.roots),
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
        Some(())
    }
}

/// Assigns to each expected root the nearest found one if that is unambiguous: at most half as far as the
/// second, and no two to one. Then no other assignment has a smaller sum of distances.
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
            let distance = (root - expected).modulus();
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

/// Assigns to each root the nearest found one, closest pair first. Two roots that meet keep their order, by
/// real and then by imaginary part. Of two real ones that become a pair, the larger becomes the upper; of a
/// pair that becomes real, the upper becomes the larger.
fn closest(now: &[Option<C>], found: &[C]) -> Vec<Option<C>> {
    let mut distances: Vec<(f64, usize, usize)> = Vec::new();
    for (i, root) in now.iter().enumerate() {
        distances.extend(
            root.iter()
                .flat_map(|r| found.iter().map(move |f| (f - r).modulus()))
                .zip(0..)
                .map(|(distance, j)| (distance, i, j)),
        );
    }
    distances.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut matched: Vec<Option<usize>> = vec![None; now.len()];
    for (_, i, j) in distances {
        if matched[i].is_none() && !matched.contains(&Some(j)) {
            matched[i] = Some(j);
        }
    }
    let mut matched: Vec<Option<C>> = matched.into_iter().map(|j| j.map(|j| found[j])).collect();
    for i in 0..now.len() {
        for j in 0..i {
            let (Some(a), Some(b), Some(x), Some(y)) = (now[i], now[j], matched[i], matched[j]) else {
                continue;
            };
            let (straight, crossed) =
                ((a - x).modulus() + (b - y).modulus(), (a - y).modulus() + (b - x).modulus());
            if crossed < 1.5 * straight && before(&a, &b) != before(&x, &y) {
                matched.swap(i, j);
            }
        }
    }
    matched
}

fn before(a: &C, b: &C) -> bool {
    (a.re, a.im) < (b.re, b.im)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The roots of `s^2 - 2 m s + p`.
    fn quadratic(m: f64, p: f64) -> [C; 2] {
        let d = ComplexField::sqrt(C::new(m * m - p, 0.0));
        [C::new(m, 0.0) + d, C::new(m, 0.0) - d]
    }

    fn follow(to: f64, start: &[C], find: impl Fn(f64) -> Vec<C>) -> Vec<C> {
        let mut followed = Followed::new(0.0, start);
        followed.go(to, 0.1, &|p| Some(Found { roots: find(p), all: true })).unwrap();
        followed.now().iter().map(|r| r.unwrap()).collect()
    }

    #[test]
    fn roots_pass_each_other_and_stay_themselves() {
        let find = |p: f64| vec![C::new(1.0 - p, 5.0), C::new(-1.0 + p, 0.3 * p), C::new(p - 1.0, 5.5)];
        let end = follow(2.0, &find(0.0), |p| find(p).into_iter().rev().collect());
        assert_eq!(end, find(2.0));
    }

    #[test]
    fn two_that_meet_and_part_keep_their_order() {
        // Real until 1.03, a pair until 2.03, real again.
        let find = |p: f64| quadratic(-1.0, 1.0 + 0.2 * (p - 1.03) * (2.03 - p)).to_vec();
        let end = follow(3.0, &find(0.0), find);
        assert!(end[0].im == 0.0 && end[0].re > -1.0 && end[1].re < -1.0, "{end:?}");
        let middle = follow(1.5, &find(0.0), find);
        assert!(middle[0].im > 0.0 && middle[1].im < 0.0, "{middle:?}");
    }

    #[test]
    fn a_root_beyond_the_edge_is_lost() {
        let find = |p: f64| {
            let found = [0.0, -1.0 - p].into_iter().filter(|re| *re > -1.45);
            Some(Found { roots: found.map(|re| C::new(re, 0.0)).collect(), all: false })
        };
        let mut followed = Followed::new(0.0, &[C::new(0.0, 0.0), C::new(-1.0, 0.0)]);
        followed.go(1.0, 0.1, &find).unwrap();
        assert_eq!(followed.now(), [Some(C::new(0.0, 0.0)), None]);
    }

    #[test]
    fn following_ends_where_no_roots_are_given() {
        let find = |p: f64| (p < 0.35).then(|| Found { roots: vec![C::new(p, 0.0)], all: true });
        let mut followed = Followed::new(0.0, &[C::ZERO]);
        assert_eq!(followed.go(0.3, 0.1, &find), Some(()));
        assert_eq!(followed.go(1.0, 0.1, &find), None);
    }
}
