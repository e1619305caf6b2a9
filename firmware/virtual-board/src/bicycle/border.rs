//! Finds the border of a basin along one disturbance.

/// Bracket of the border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// Largest disturbance below the border without a fall.
    pub outlasted: f64,
    /// Smallest disturbance beyond the border with a fall.
    pub fallen: f64,
}

/// Finds the border nearest to `near`: growing steps outwards, then bisection until both sides are at most `tolerance`
/// apart. Assumes no fall at zero.
///
/// # Errors
/// Those of the ride.
pub fn border<E>(
    near: f64,
    tolerance: f64,
    mut falls: impl FnMut(f64) -> Result<bool, E>,
) -> Result<Border, E> {
    let mut at = near.max(tolerance);
    let mut stride = tolerance;
    let began_fallen = falls(at)?;
    let (mut outlasted, mut fallen);
    loop {
        let next = if began_fallen { (at - stride).max(0.0) } else { at + stride };
        (outlasted, fallen) = if began_fallen { (next, at) } else { (at, next) };
        if (began_fallen && next == 0.0) || falls(next)? != began_fallen {
            break;
        }
        (at, stride) = (next, 2.0 * stride);
    }
    while fallen - outlasted > tolerance {
        let middle = 0.5 * (outlasted + fallen);
        if falls(middle)? { fallen = middle } else { outlasted = middle }
    }
    Ok(Border { outlasted, fallen })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_the_border_from_either_side() {
        for near in [0.3, 5.9, 6.1, 20.0] {
            let found = border(near, 0.25, |knock| Ok::<_, ()>(knock > 6.0)).unwrap();
            assert!(found.outlasted <= 6.0 && 6.0 < found.fallen && found.fallen - found.outlasted <= 0.25);
        }
    }
}
