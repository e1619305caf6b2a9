//! Eigenvalues over speed as curves.

use nalgebra::Complex;
use std::ops::Range;

type Four = [Complex<f64>; 4];

/// Four curves: at every speed each goes on with the eigenvalue that takes them all least far.
pub(super) fn curves(eigenvalues: &[Four]) -> [Vec<Complex<f64>>; 4] {
    let mut curves: [Vec<Complex<f64>>; 4] = Default::default();
    let mut last: Option<Four> = None;
    for &values in eigenvalues {
        let next = last.map_or(values, |last| nearest(&last, &values));
        for (curve, value) in curves.iter_mut().zip(next) {
            curve.push(value);
        }
        last = Some(next);
    }
    curves
}

/// The order of `values` that is closest to `last`.
fn nearest(last: &Four, values: &Four) -> Four {
    let mut best = (f64::INFINITY, *values);
    for code in 0..256_usize {
        let order = [code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6];
        if order.iter().fold(0, |seen, i| seen | 1 << i) != 0b1111 {
            continue;
        }
        let candidate = order.map(|i| values[i]);
        let distance = last.iter().zip(&candidate).map(|(a, b)| (a - b).norm_sqr()).sum();
        if distance < best.0 {
            best = (distance, candidate);
        }
    }
    best.1
}

/// Stretches of a curve and whether each is part of a complex pair. Neighbours share a point.
pub(super) fn pieces(curve: &[Complex<f64>]) -> Vec<(bool, Range<usize>)> {
    let mut pieces: Vec<(bool, Range<usize>)> = Vec::new();
    for k in 1..curve.len() {
        let pair = curve[k - 1].im != 0.0 || curve[k].im != 0.0;
        match pieces.last_mut() {
            Some((same, range)) if *same == pair => range.end = k + 1,
            _ => pieces.push((pair, k - 1..k + 1)),
        }
    }
    pieces
}

/// The ranges of speed without a positive real part, their ends interpolated.
pub(super) fn stable_ranges(speeds: &[f64], eigenvalues: &[Four]) -> Vec<(f64, f64)> {
    let growth: Vec<f64> =
        eigenvalues.iter().map(|e| e.iter().map(|e| e.re).fold(f64::NEG_INFINITY, f64::max)).collect();
    let mut ranges = Vec::new();
    let mut from = speeds.first().copied().filter(|_| growth.first().is_some_and(|&g| g <= 0.0));
    for k in 1..speeds.len().min(growth.len()) {
        let (before, now) = (growth[k - 1], growth[k]);
        let crossing = || speeds[k - 1] + (speeds[k] - speeds[k - 1]) * before / (before - now);
        match from {
            None if now <= 0.0 => from = Some(crossing()),
            Some(start) if now > 0.0 => {
                ranges.push((start, crossing()));
                from = None;
            }
            _ => {}
        }
    }
    ranges.extend(from.zip(speeds.last().copied()));
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn real(values: [f64; 4]) -> Four {
        values.map(|re| Complex::new(re, 0.0))
    }

    #[test]
    fn a_curve_stays_itself_where_the_order_by_size_changes() {
        let a = [
            Complex::new(0.1, 5.0),
            Complex::new(0.1, -5.0),
            Complex::new(0.0, 0.0),
            Complex::new(-9.0, 0.0),
        ];
        let b = [
            Complex::new(0.0, 0.0),
            Complex::new(-0.1, 5.0),
            Complex::new(-0.1, -5.0),
            Complex::new(-9.0, 0.0),
        ];
        let curves = curves(&[a, b]);
        assert_eq!(curves[0][1], Complex::new(-0.1, 5.0));
        assert_eq!(pieces(&curves[0]), [(true, 0..2)]);
        assert_eq!(pieces(&curves[2]), [(false, 0..2)]);
    }

    #[test]
    fn stable_ranges_end_where_growth_begins() {
        let values = [1.0, -1.0, -1.0, 3.0].map(|re| real([re, -4.0, -5.0, -6.0]));
        assert_eq!(stable_ranges(&[0.0, 1.0, 2.0, 3.0], &values), [(0.5, 2.25)]);
        assert_eq!(stable_ranges(&[0.0], &[real([-1.0; 4])]), [(0.0, 0.0)]);
        assert_eq!(stable_ranges(&[], &[]), []);
    }
}
