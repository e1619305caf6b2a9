//! Heights of a basin, exact and on a coarse grid of disturbances, and the figures of merit computed from them.

use super::case::GRID;
pub use crate::basin::area;
use crate::basin::{Basin, Column};

/// Heights over speed: `(speed, height)` in m/s and rad/s.
pub type Outline = Vec<(f64, f64)>;

/// The outline at the located borders.
pub fn exact(basin: &Basin) -> Outline {
    basin.outline()
}

/// The outline on the thesis's probable grid: the last multiple of [`GRID`] before the first that falls.
pub fn coarse(basin: &Basin) -> Outline {
    basin.columns.iter().map(|c| (c.speed, on_grid(c))).collect()
}

fn on_grid(column: &Column) -> f64 {
    let multiples = column.scan.iter().filter(|p| ((p.rate / GRID).round() * GRID - p.rate).abs() < 1e-9);
    let standing = multiples.take_while(|p| p.outcome.time_to_fall_s().is_none());
    standing.last().map_or(0.0, |p| p.rate)
}

/// The outline on a grid of `step` \[rad/s\], from the located border.
pub fn floored(basin: &Basin, step: f64) -> Outline {
    basin.columns.iter().map(|c| (c.speed, (c.upper / step + 1e-9).floor() * step)).collect()
}

/// Mean of the heights \[rad/s\]; NaN for an empty outline.
pub fn mean(outline: &[(f64, f64)]) -> f64 {
    outline.iter().map(|p| p.1).sum::<f64>() / outline.len() as f64
}

/// The part of an outline between two speeds.
pub fn between(outline: &[(f64, f64)], from: f64, to: f64) -> Outline {
    outline.iter().copied().filter(|p| p.0 >= from - 1e-9 && p.0 <= to + 1e-9).collect()
}

/// Root-mean-square distance of two outlines over the same speeds \[rad/s\] (eq. 2.22 with the factor 1/n that the
/// print lacks).
pub fn rmse(a: &[(f64, f64)], b: &[(f64, f64)]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(p, q)| (p.1 - q.1).powi(2)).sum();
    (squares / a.len().min(b.len()) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basin::{ScanPoint, Work};
    use crate::ride::{FallCause, Outcome};

    #[test]
    fn the_coarse_grid_stops_at_its_first_fall() {
        let fell = |rate: f64| {
            if rate > 1.6 { Outcome::Fallen { time_s: 1.0, by: FallCause::Roll } } else { Outcome::Recovered }
        };
        let scan: Vec<_> = (1..=12)
            .map(|i| f64::from(i) * 0.25)
            .map(|rate| ScanPoint { rate, outcome: fell(rate) })
            .collect();
        let column = Column {
            speed: 3.0,
            upper: 1.66,
            capped: false,
            islands: vec![],
            scan,
            outcome: None,
            border: None,
            beyond: None,
            work: Work::default(),
        };
        let basin = Basin { columns: vec![column.clone(), Column { speed: 4.0, ..column }] };
        assert_eq!(coarse(&basin), [(3.0, 1.5), (4.0, 1.5)]);
        assert_eq!(floored(&basin, 0.4)[0], (3.0, 1.6));
        assert_eq!((area(&exact(&basin)), mean(&coarse(&basin))), (1.66, 1.5));
        assert!((rmse(&exact(&basin), &coarse(&basin)) - 0.16).abs() < 1e-12);
        assert_eq!(between(&coarse(&basin), 3.5, 9.0).len(), 1);
    }
}
