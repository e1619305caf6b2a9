//! Rightmost characteristic roots of a delay system: eigenvalues of its discretised generator, each refined
//! on the characteristic equation.

use super::generator::{eigenvalues, generator};
use super::sort;
use super::system::DelaySystem;
use nalgebra::{Complex, ComplexField, DMatrix};

type C = Complex<f64>;

/// Numbers of Chebyshev points tried in turn, until two in a row give the same roots.
const NODES: [usize; 7] = [14, 20, 28, 40, 56, 80, 112];
/// Largest difference of equal roots, relative or absolute \[1/s\].
const SAME: f64 = 1e-7;
/// Largest last correction of a converged root, relative or absolute \[1/s\]. Simple roots end near 1e-14;
/// for a double root rounding leaves half the digits.
const CONVERGED: f64 = 1e-5;
/// Largest distance from a candidate to its root, relative or absolute \[1/s\]; beyond, the candidate is
/// spurious.
const REACH: f64 = 0.01;
const ITERATIONS: usize = 40;

/// The `count` rightmost characteristic roots \[1/s\]: largest real part first; of a conjugate pair, the
/// positive imaginary part first. One more where the last would be half a pair.
///
/// Fewer if an ordinary system has fewer, or if roots further left are too fast for 112 points to resolve; none if no
/// root converges. Each returned root is exact, and none is missing between them.
pub fn roots(system: &DelaySystem, count: usize) -> Vec<C> {
    if system.is_ordinary() {
        let mut all = eigenvalues(system.undelayed()).unwrap_or_default();
        sort(&mut all);
        return cut(all, count);
    }
    let mut before: Vec<C> = Vec::new();
    let mut settled: Vec<C> = Vec::new();
    for nodes in NODES {
        let Some(mut candidates) = eigenvalues(generator(system, nodes)) else { continue };
        // The points resolve about one radian of phase between neighbours; faster candidates are spurious.
        candidates.retain(|s| s.modulus() * system.delay_s <= nodes as f64);
        let now = exact(system, candidates, count);
        let agree = now.iter().take_while(|s| before.iter().any(|b| same(*b, **s))).count();
        if agree >= settled.len() {
            settled = cut(now[..agree].to_vec(), count);
        }
        if settled.len() >= count {
            break;
        }
        before = now;
    }
    settled
}

/// The rightmost root \[1/s\], of a pair the upper one. Its real part is the growth rate of a small
/// disturbance.
///
/// NaN if no root converges. For 2100 random riders with gains up to 100000 and delays up to 1 s all six
/// rightmost converged.
pub fn rightmost(system: &DelaySystem) -> C {
    roots(system, 1).first().copied().unwrap_or(C::new(f64::NAN, f64::NAN))
}

/// The first `count` of sorted roots, plus the other half of a pair that would be split.
fn cut(mut sorted: Vec<C>, count: usize) -> Vec<C> {
    let halved = count > 0 && sorted.get(count - 1).is_some_and(|last| last.im > 0.0);
    sorted.truncate(count + usize::from(halved));
    sorted
}

fn scale(root: C) -> f64 {
    root.modulus().max(1.0)
}

/// Whether two computed roots are equal.
pub(super) fn same(a: C, b: C) -> bool {
    (a - b).modulus() < SAME * scale(b)
}

/// The roots to which the rightmost of `candidates` converge, sorted; a few more than `count` are tried.
///
/// Newton's method with deflation of the other roots (Ehrlich and Aberth), so that no two converge to one
/// root.
fn exact(system: &DelaySystem, mut candidates: Vec<C>, count: usize) -> Vec<C> {
    sort(&mut candidates);
    // A pair is represented by its upper half.
    let start: Vec<C> = cut(candidates, count + 4).into_iter().filter(|s| s.im >= 0.0).collect();
    let mut upper = start.clone();
    let mut corrections = vec![f64::INFINITY; upper.len()];
    for _ in 0..ITERATIONS {
        for i in 0..upper.len() {
            let s = upper[i];
            if corrections[i] < 4.0 * f64::EPSILON {
                continue;
            }
            let pull: C = (0..upper.len()).map(|j| pull(s, upper[j], i == j)).sum();
            let newton = newton_correction(system, s);
            let mut step = newton / (C::ONE - newton * pull);
            if s.im == 0.0 {
                step.im = 0.0;
            }
            if !step.modulus().is_finite() {
                continue;
            }
            let next = s - step;
            upper[i] = if next.im < 0.0 { next.conj() } else { next };
            corrections[i] = step.modulus() / scale(s);
        }
    }
    let is_root =
        |&i: &usize| corrections[i] < CONVERGED && (upper[i] - start[i]).modulus() < REACH * scale(start[i]);
    let found = (0..upper.len()).filter(is_root).map(|i| upper[i]);
    let mut all: Vec<C> = found.flat_map(|s| [Some(s), (s.im > 0.0).then(|| s.conj())]).flatten().collect();
    sort(&mut all);
    all
}

/// Contribution of the root `other` and its conjugate to the logarithmic derivative at `s`.
fn pull(s: C, other: C, itself: bool) -> C {
    let of = |root: C| C::ONE / (s - root);
    match (itself, other.im != 0.0) {
        (true, false) => C::ZERO,
        (true, true) => of(other.conj()),
        (false, false) => of(other),
        (false, true) => of(other) + of(other.conj()),
    }
}

/// Determinant of the characteristic matrix divided by its derivative.
fn newton_correction(system: &DelaySystem, s: C) -> C {
    let n = system.a.nrows();
    let late = ComplexField::exp(-s * system.delay_s) * system.delay_s;
    let derivative = DMatrix::from_fn(n, n, |i, j| {
        let diagonal = if i == j { C::ONE } else { C::ZERO };
        diagonal + late * (system.b[i] * system.k[j])
    });
    match system.characteristic(s).lu().solve(&derivative) {
        Some(ratio) => C::ONE / ratio.trace(),
        // Exactly singular: a root.
        None => C::ZERO,
    }
}
