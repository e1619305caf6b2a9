//! Eigenmodes as lines over speed.

use crate::eigen::Mode;
use nalgebra::Complex;

type Root = Option<Complex<f64>>;

/// Continuous stretches of a root's real part over speed.
pub(super) fn real(speeds: &[f64], root: &[Root]) -> Vec<Vec<(f64, f64)>> {
    // The lower half of a pair coincides with the upper one.
    lines(speeds, root, |e| e.re, |a, b| a.im >= 0.0 || b.im >= 0.0)
}

/// Continuous stretches of a root's positive imaginary part over speed, extended to zero where a pair begins and ends.
pub(super) fn imaginary(speeds: &[f64], root: &[Root]) -> Vec<Vec<(f64, f64)>> {
    lines(speeds, root, |e| e.im, |a, b| a.im > 0.0 || b.im > 0.0)
}

fn lines(
    speeds: &[f64],
    root: &[Root],
    part: fn(&Complex<f64>) -> f64,
    drawn: fn(&Complex<f64>, &Complex<f64>) -> bool,
) -> Vec<Vec<(f64, f64)>> {
    let mut lines: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut joined = false;
    for (v, e) in speeds.windows(2).zip(root.windows(2)) {
        let Some((a, b)) = e[0].as_ref().zip(e[1].as_ref()).filter(|(a, b)| drawn(a, b)) else {
            joined = false;
            continue;
        };
        if !joined {
            lines.push(vec![(v[0], part(a))]);
        }
        if let Some(line) = lines.last_mut() {
            line.push((v[1], part(b)));
        }
        joined = true;
    }
    lines
}

/// Whether a real part of the mode lies within `range`.
pub(super) fn in_sight(mode: &Mode, range: (f64, f64)) -> bool {
    mode.roots.iter().flatten().flatten().any(|e| range.0 <= e.re && e.re <= range.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_where_a_root_is_lost_and_pairs_begin_at_zero() {
        let at = |re, im| Some(Complex::new(re, im));
        let speeds = [0.0, 1.0, 2.0, 3.0, 4.0];
        let upper = [at(1.0, 0.0), at(2.0, 3.0), at(3.0, 4.0), None, at(5.0, 6.0)];
        assert_eq!(real(&speeds, &upper), [[(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)]]);
        assert_eq!(imaginary(&speeds, &upper), [[(0.0, 0.0), (1.0, 3.0), (2.0, 4.0)]]);
        let lower = upper.map(|e| e.map(|e| e.conj()));
        assert_eq!(real(&speeds, &lower), [[(0.0, 1.0), (1.0, 2.0)]]);
        assert!(imaginary(&speeds, &lower).is_empty() && real(&[], &[]).is_empty());
    }
}
