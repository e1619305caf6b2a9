//! Axes of a chart: from data to a linear or logarithmic range with ticks.

use super::scale::{nice, ticks};

/// An axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Ends of the range; fitted to the data if `None`.
    pub range: Option<(f64, f64)>,
    /// Whether it is logarithmic.
    pub log: bool,
    /// Names at 1, 2...; numbers if empty.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis.
    pub fn new(label: &str) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// The axis with the range `low` to `high`.
    pub fn over(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    /// An axis of names, at 1, 2...
    pub fn of_names(label: &str, names: Vec<String>) -> Self {
        let range = Some((0.4, names.len() as f64 + 0.6));
        Self { label: label.into(), range, log: false, names }
    }

    /// The axis, logarithmic.
    pub fn log(self) -> Self {
        Self { log: true, ..self }
    }
}

/// An axis with its range, in decades if it is logarithmic.
pub(super) struct Fitted {
    log: bool,
    pub(super) range: (f64, f64),
    names: Vec<String>,
}

impl Fitted {
    /// The given range, or one around `values`, with a margin if `room` is true.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, room: bool) -> Self {
        let scaled = |v: f64| if axis.log { libm::log10(v) } else { v };
        let range = match axis.range {
            Some((low, high)) => (scaled(low), scaled(high)),
            None if axis.log => {
                let of_values = values.filter(|v| *v > 0.0).map(libm::log10);
                let ends =
                    of_values.fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| (r.0.min(v), r.1.max(v)));
                if ends.0 > ends.1 {
                    (0.0, 1.0)
                } else {
                    (ends.0.floor(), ends.1.ceil().max(ends.0.floor() + 1.0))
                }
            }
            None if room => roomy(values.filter(|v| v.is_finite()).collect()),
            None => nice(values, 6),
        };
        Self { log: axis.log, range, names: axis.names.clone() }
    }

    /// Position of a value in the range; `None` if it has none.
    pub(super) fn place(&self, v: f64) -> Option<f64> {
        let v = if self.log { libm::log10(v) } else { v };
        v.is_finite().then_some(v)
    }

    /// Ticks for an axis of `length` pixels, about `apart` pixels apart.
    pub(super) fn ticks(&self, length: f64, apart: f64) -> Vec<(f64, String)> {
        if !self.names.is_empty() {
            return (1..).map(f64::from).zip(self.names.iter().cloned()).collect();
        }
        if !self.log {
            return ticks(self.range, (length / apart) as usize);
        }
        let (from, to) = (self.range.0.ceil() as i32, self.range.1.floor() as i32);
        let most = (length / apart).max(2.0) as i32;
        let step = ((to - from) as f64 / f64::from(most)).ceil().max(1.0) as usize;
        (from..=to).step_by(step).map(|decade| (f64::from(decade), format!("1e{decade}"))).collect()
    }
}

/// A range with round ends and a margin, so that lines do not lie on the frame; a range from zero keeps that end.
fn roomy(values: Vec<f64>) -> (f64, f64) {
    let (low, high) = nice(values.iter().copied(), 6);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let room = 0.04 * (high - low);
    (if least == 0.0 { low } else { low - room }, high + room)
}
