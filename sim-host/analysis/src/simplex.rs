//! The simplex method of Nelder and Mead in the form of MATLAB's `fminsearch` (Lagarias et al. 1998): minimises a function
//! of several parameters from its values alone.

use std::cell::Cell;

/// A corner of a simplex: a point and the function's value there.
pub type Corner = (Vec<f64>, f64);

/// The best corner of a search that begins with the simplex of `points`, one more than the point's dimensions. It ends once `ended`
/// holds of the corners, the best first. `None` if `f` has no value at a point, which ends the search at once.
pub fn search(
    points: Vec<Vec<f64>>,
    mut f: impl FnMut(&[f64]) -> Option<f64>,
    ended: impl Fn(&[Corner]) -> bool,
) -> Option<Corner> {
    let mut valued = |x: Vec<f64>| f(&x).map(|y| (x, y));
    let mut corners: Vec<Corner> = points.into_iter().map(&mut valued).collect::<Option<_>>()?;
    let last = corners.len().checked_sub(1)?;
    loop {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        if ended(&corners) {
            return Some(corners.swap_remove(0));
        }
        let (best, worst) = (corners[0].clone(), corners[last].clone());
        let mut centre = vec![0.0; last];
        for (x, _) in &corners[..last] {
            centre.iter_mut().zip(x).for_each(|(c, x)| *c += x / last as f64);
        }
        // The point on the line from the worst corner through the centre, `s` times as far beyond the centre.
        let mut along = |s: f64| valued(centre.iter().zip(&worst.0).map(|(c, w)| c + s * (c - w)).collect());
        let reflected = along(1.0)?;
        let next = if reflected.1 < best.1 {
            let expanded = along(2.0)?;
            Some(if expanded.1 < reflected.1 { expanded } else { reflected })
        } else if reflected.1 < corners[last - 1].1 {
            Some(reflected)
        } else {
            let contracted = along(if reflected.1 < worst.1 { 0.5 } else { -0.5 })?;
            Some(contracted).filter(|c| c.1 < reflected.1.min(worst.1))
        };
        match next {
            Some(corner) => corners[last] = corner,
            None => {
                for corner in &mut corners[1..] {
                    *corner = valued(corner.0.iter().zip(&best.0).map(|(x, b)| b + 0.5 * (x - b)).collect())?;
                }
            }
        }
    }
}

/// Changes of the function and of the parameters below which `fminsearch` ends.
const TOLERANCE: f64 = 1e-4;
/// Its function evaluations per parameter.
const EVALUATIONS: usize = 200;

/// The best point of a search from `start` with the first simplex, the tolerances and the evaluations of `fminsearch`. Values that
/// are not finite count as worst.
pub fn minimum<const N: usize>(start: [f64; N], f: impl Fn(&[f64; N]) -> f64) -> [f64; N] {
    let point = |x: &[f64]| std::array::from_fn(|i| x[i]);
    let evaluations = Cell::new(0);
    let counted = |x: &[f64]| {
        evaluations.set(evaluations.get() + 1);
        Some(Some(f(&point(x))).filter(|y| y.is_finite()).unwrap_or(f64::MAX))
    };
    let mut points = vec![start.to_vec(); N + 1];
    for (i, x) in points[1..].iter_mut().enumerate() {
        x[i] = if x[i] == 0.0 { 0.00025 } else { 1.05 * x[i] };
    }
    let alike = |corners: &[Corner]| {
        let (best, others) = (&corners[0], &corners[1..]);
        let sizes = others.iter().flat_map(|(x, _)| x.iter().zip(&best.0)).map(|(a, b)| (a - b).abs());
        corners[N].1 - best.1 <= TOLERANCE && sizes.fold(0.0, f64::max) <= TOLERANCE
    };
    let ended = |corners: &[Corner]| evaluations.get() + 2 > EVALUATIONS * N || alike(corners);
    search(points, counted, ended).map_or(start, |(x, _)| point(&x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's function from the published start: found within the tolerance, in fewer evaluations than allowed.
    #[test]
    fn the_bottom_of_a_curved_valley_is_found() {
        let evaluations = Cell::new(0);
        let valley = |[x, y]: &[f64; 2]| {
            evaluations.set(evaluations.get() + 1);
            100.0 * (y - x * x).powi(2) + (1.0 - x).powi(2)
        };
        let [x, y] = minimum([-1.2, 1.0], valley);
        assert!((x - 1.0).abs() < 1e-3 && (y - 1.0).abs() < 1e-3, "{x} {y}");
        assert!((100..EVALUATIONS).contains(&evaluations.get()), "{}", evaluations.get());
        assert!(valley(&[x, y]) < 1e-6);
    }

    /// A function without a value ends the search at once, wherever it happens.
    #[test]
    fn a_function_without_a_value_ends_the_search() {
        for allowed in 0..40 {
            let mut evaluations = 0;
            let bowl = |x: &[f64]| {
                evaluations += 1;
                (evaluations <= allowed).then(|| x[0] * x[0] + 3.0 * x[1] * x[1])
            };
            let simplex = vec![vec![1.0, 1.0], vec![2.0, 1.0], vec![1.0, 2.0]];
            assert_eq!(search(simplex, bowl, |_| false), None);
            assert_eq!(evaluations, allowed + 1);
        }
    }
}
