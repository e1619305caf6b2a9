//! Finds the value of an axis up to which a fraction of the area remains.

/// Smallest fraction of the reference's area that counts as sufficient.
pub(super) const LEAST: f64 = 0.95;

/// Range of an axis over which the area remains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Threshold {
    /// At all values.
    Everywhere,
    /// Not even at the value nearest to the reference.
    Nowhere,
    /// Up to `at`, interpolated between the last value of the grid at which it remains and the first at which it does
    /// not.
    Until {
        /// Interpolated.
        at: f64,
        /// The last value that keeps it.
        kept: f64,
        /// The first that does not.
        lost: f64,
    },
}

/// Where `points` (value, part of the area), coming from the reference's side, first fall below
/// `least`. Between values interpolated on a straight line, over the logarithm if all are above zero.
pub fn threshold(points: &[(f64, f64)], least: f64) -> Threshold {
    let Some(lost) = points.iter().position(|p| p.1 < least) else { return Threshold::Everywhere };
    let Some(before) = lost.checked_sub(1) else { return Threshold::Nowhere };
    let ((x0, y0), (x1, y1)) = (points[before], points[lost]);
    let part = (y0 - least) / (y0 - y1);
    let log = points.iter().all(|p| p.0 > 0.0);
    let at = if log { x0 * libm::pow(x1 / x0, part) } else { x0 + part * (x1 - x0) };
    Threshold::Until { at, kept: x0, lost: x1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_loss_counts() {
        let points = [(0.0, 1.0), (10.0, 1.02), (20.0, 0.90), (30.0, 0.99)];
        let Threshold::Until { at, kept, lost } = super::threshold(&points, 0.96) else {
            panic!("it is lost")
        };
        assert_eq!((kept, lost), (10.0, 20.0));
        assert!((at - 15.0).abs() < 1e-9, "{at}");
        assert_eq!(super::threshold(&points, 0.5), Threshold::Everywhere);
        assert_eq!(super::threshold(&points, 1.01), Threshold::Nowhere);
    }

    #[test]
    fn above_zero_the_logarithm_is_interpolated() {
        let Threshold::Until { at, .. } = super::threshold(&[(100.0, 1.0), (1.0, 0.0)], 0.5) else {
            panic!("it is lost")
        };
        assert!((at - 10.0).abs() < 1e-9, "{at}");
    }
}
