//! The simplex method of Nelder and Mead in the form of MATLAB's `fminsearch` (Lagarias et al. 1998), with the initial
//! values and tolerances of the thesis's fits.

/// Changes of the function and of the parameters below which the search ends.
const TOLERANCE: f64 = 1e-4;
/// Function evaluations per parameter.
const EVALUATIONS: usize = 200;

/// The best point of a search from `start`.
pub fn minimum<const N: usize>(start: [f64; N], f: impl Fn(&[f64; N]) -> f64) -> [f64; N] {
    // Values that are not finite count as worst.
    let f = |x: &[f64; N]| Some(f(x)).filter(|y| y.is_finite()).unwrap_or(f64::MAX);
    let mut corners: Vec<([f64; N], f64)> = vec![(start, f(&start))];
    for i in 0..N {
        let mut x = start;
        x[i] = if x[i] == 0.0 { 0.00025 } else { 1.05 * x[i] };
        corners.push((x, f(&x)));
    }
    let mut left = (EVALUATIONS * N).saturating_sub(N + 1);
    loop {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (corners[0], corners[N]);
        let size = corners.iter().flat_map(|(x, _)| x.iter().zip(&best.0)).map(|(a, b)| (a - b).abs());
        if left < 2 || worst.1 - best.1 <= TOLERANCE && size.fold(0.0, f64::max) <= TOLERANCE {
            return best.0;
        }
        let mut centre = [0.0; N];
        for (x, _) in &corners[..N] {
            centre.iter_mut().zip(x).for_each(|(c, x)| *c += x / N as f64);
        }
        // The point on the line from the worst corner through the centre, `s` times as far beyond it.
        let along = |s: f64| {
            let x = std::array::from_fn(|i| centre[i] + s * (centre[i] - worst.0[i]));
            (x, f(&x))
        };
        let reflected = along(1.0);
        left -= 1;
        let next = if reflected.1 < best.1 {
            left -= 1;
            let expanded = along(2.0);
            Some(if expanded.1 < reflected.1 { expanded } else { reflected })
        } else if reflected.1 < corners[N - 1].1 {
            Some(reflected)
        } else {
            left -= 1;
            let contracted = along(if reflected.1 < worst.1 { 0.5 } else { -0.5 });
            Some(contracted).filter(|c| c.1 < reflected.1.min(worst.1))
        };
        match next {
            Some(corner) => corners[N] = corner,
            None => {
                for (x, y) in &mut corners[1..] {
                    x.iter_mut().zip(&best.0).for_each(|(x, b)| *x = b + 0.5 * (*x - b));
                    *y = f(x);
                }
                left = left.saturating_sub(N);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::minimum;

    #[test]
    fn it_finds_rosenbrocks_valley() {
        let [x, y] = minimum([-1.2, 1.0], |[x, y]| 100.0 * (y - x * x).powi(2) + (1.0 - x).powi(2));
        assert!((x - 1.0).abs() < 1e-4 && (y - 1.0).abs() < 1e-4, "{x} {y}");
    }
}
