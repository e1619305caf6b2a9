//! Conversion of a raw number to the value in the channel's unit.

use super::super::database::is_gap;
use super::block::File;

/// Largest number of chained conversions.
const DEEPEST: u8 = 4;

/// A conversion.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Conversion {
    None,
    /// `a + b x`.
    Linear(f64, f64),
    /// `(a x^2 + b x + c) / (d x^2 + e x + f)`.
    Rational([f64; 6]),
    /// Linear interpolation between points, or the nearer point's value.
    Table {
        points: Vec<(f64, f64)>,
        lines: bool,
    },
    /// Values of ranges, both ends included, and the value outside all ranges.
    Ranges(Vec<(f64, f64, f64)>, f64),
    /// Texts for some numbers: those that mean "no value" become NaN, all others remain numbers and are converted.
    Texts {
        gaps: Vec<(f64, f64)>,
        others: Box<Conversion>,
    },
}

impl Conversion {
    /// The conversion at a link.
    ///
    /// # Errors
    /// The unsupported kind.
    pub(super) fn of(file: &File, at: Option<usize>) -> Result<Self, &'static str> {
        Self::nested(file, at, DEEPEST)
    }

    fn nested(file: &File, at: Option<usize>, depth: u8) -> Result<Self, &'static str> {
        let Some(at) = at else { return Ok(Conversion::None) };
        let block = file.block(at, b"##CC").ok_or("its conversion is not at its stated position")?;
        let value = |n: usize| block.f64(24 + 8 * n);
        let values = (block.data.len().saturating_sub(24) / 8).min(usize::from(block.u16(6)));
        let needs = |n: usize| if values < n { Err("its conversion is cut") } else { Ok(()) };
        match block.u8(0) {
            0 => Ok(Conversion::None),
            1 => needs(2).map(|()| Conversion::Linear(value(0), value(1))),
            2 => needs(6).map(|()| Conversion::Rational(std::array::from_fn(value))),
            3 => Err("a conversion by formula is not read"),
            kind @ (4 | 5) => {
                let points: Vec<(f64, f64)> =
                    (0..values / 2).map(|n| (value(2 * n), value(2 * n + 1))).collect();
                let rises = points.is_sorted_by(|a, b| a.0 < b.0) && !points.is_empty();
                if !rises {
                    return Err("the table of its conversion does not rise");
                }
                Ok(Conversion::Table { points, lines: kind == 4 })
            }
            6 => {
                needs(1)?;
                let ranges =
                    (0..values / 3).map(|n| (value(3 * n), value(3 * n + 1), value(3 * n + 2))).collect();
                Ok(Conversion::Ranges(ranges, value(values - 1)))
            }
            kind @ (7 | 8) => {
                let texts = if kind == 7 { values } else { values / 2 };
                let range = |n: usize| {
                    if kind == 7 { (value(n), value(n)) } else { (value(2 * n), value(2 * n + 1)) }
                };
                let gap = |n: &usize| block.link(4 + n).is_some_and(|at| is_gap(&file.text(Some(at))));
                let gaps = (0..texts).filter(gap).map(range).collect();
                let default = block.link(4 + texts).filter(|at| file.block(*at, b"##CC").is_some());
                let others = match depth {
                    0 => return Err("too many of its conversions are chained"),
                    _ => Self::nested(file, default, depth - 1)?,
                };
                Ok(Conversion::Texts { gaps, others: Box::new(others) })
            }
            _ => Err("a conversion of text is not read"),
        }
    }

    /// The value of a raw number.
    pub(super) fn value(&self, raw: f64) -> f64 {
        match self {
            Conversion::None => raw,
            Conversion::Linear(a, b) => a + b * raw,
            Conversion::Rational([a, b, c, d, e, f]) => {
                (a * raw * raw + b * raw + c) / (d * raw * raw + e * raw + f)
            }
            Conversion::Table { points, lines } => at(points, raw, *lines),
            Conversion::Ranges(ranges, default) => {
                let within = ranges.iter().find(|(first, last, _)| (*first..=*last).contains(&raw));
                within.map_or(*default, |(_, _, value)| *value)
            }
            Conversion::Texts { gaps, others } => {
                let is_in = |ranges: &[(f64, f64)]| {
                    ranges.iter().any(|(first, last)| (*first..=*last).contains(&raw))
                };
                if is_in(gaps) { f64::NAN } else { others.value(raw) }
            }
        }
    }
}

/// The value of a table with rising first numbers; constant beyond its ends.
fn at(points: &[(f64, f64)], raw: f64, lines: bool) -> f64 {
    let next = points.partition_point(|(x, _)| *x <= raw);
    let (Some(before), Some(after)) = (next.checked_sub(1).map(|n| points[n]), points.get(next)) else {
        return if raw.is_nan() { f64::NAN } else { points[next.min(points.len() - 1)].1 };
    };
    let part = (raw - before.0) / (after.0 - before.0);
    match (lines, part > 0.5) {
        (true, _) => before.1 + part * (after.1 - before.1),
        (false, false) => before.1,
        (false, true) => after.1,
    }
}
