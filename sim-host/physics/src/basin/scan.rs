//! The scan of a line of disturbances: its rates, its edges between rides that fall and rides that do not, and the
//! column that follows from the narrowed edges.

use super::{Column, Island, ScanPoint, Search, Work};
use crate::ride::{FallCause, Outcome, Ride};

/// Rides between the two ends of an interval in one round of narrowing: the number of lanes.
pub(super) const SECTIONS: usize = 8;

/// An interval of disturbances with a border in it: a ride from one end does not fall, a ride from the other does. Either
/// can be the larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// Disturbance of a ride that does not fall \[rad/s\].
    pub(super) safe: f64,
    /// Disturbance of a ride that falls \[rad/s\].
    pub(super) fell: f64,
}

/// A narrowed edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Border {
    /// The largest or smallest disturbance found not to fall \[rad/s\].
    pub(super) safe: f64,
    /// Its ride, unless it is the undisturbed one.
    pub(super) ride: Option<Ride>,
    /// Cause of the fall on the other side.
    pub(super) beyond: Option<FallCause>,
}

impl Edge {
    /// Whether the border is known to the tolerance \[rad/s\].
    pub(super) fn narrow(&self, tolerance: f64) -> bool {
        (self.fell - self.safe).abs() <= tolerance
    }

    /// Disturbances that divide the interval, from the safe end \[rad/s\].
    pub(super) fn sections(&self) -> [f64; SECTIONS] {
        let cell = (self.fell - self.safe) / (SECTIONS + 1) as f64;
        std::array::from_fn(|i| self.safe + (i + 1) as f64 * cell)
    }

    /// The parts into which they divide it, from the safe end.
    pub(super) fn parts(&self) -> [Self; SECTIONS + 1] {
        let sections = self.sections();
        let end = |i: usize| sections.get(i).copied().unwrap_or(self.fell);
        std::array::from_fn(|i| Self { safe: if i == 0 { self.safe } else { end(i - 1) }, fell: end(i) })
    }
}

/// The disturbances of a scan \[rad/s\]. The last is the largest rate, even if it is not a multiple of the scan step.
pub(super) fn rates(search: &Search) -> Vec<f64> {
    let points = (search.max_rate / search.scan_step - 1e-9).ceil() as usize;
    (1..=points).map(|i| (i as f64 * search.scan_step).min(search.max_rate)).collect()
}

/// The edges of a scan, in order of increasing disturbance. The undisturbed ride does not fall.
pub(super) fn edges(scan: &[ScanPoint]) -> Vec<Edge> {
    let mut before = (0.0, false);
    let mut edges = Vec::new();
    for point in scan {
        let now = (point.rate, fell(point.outcome));
        match (before.1, now.1) {
            (false, true) => edges.push(Edge { safe: before.0, fell: now.0 }),
            (true, false) => edges.push(Edge { safe: now.0, fell: before.0 }),
            _ => {}
        }
        before = now;
    }
    edges
}

/// Whether a ride with this outcome fell.
pub(super) fn fell(outcome: Outcome) -> bool {
    outcome.fall().is_some()
}

/// The column of a scan and its narrowed edges. `last` is the ride of the largest disturbance, needed if none fell.
pub(super) fn column(
    speed: f64,
    search: &Search,
    scan: Vec<ScanPoint>,
    borders: &[Border],
    last: Option<Ride>,
    work: Work,
) -> Column {
    // Odd borders end a run of rides that do not fall, even ones begin the next.
    let mut islands: Vec<Island> = borders
        .get(1..)
        .unwrap_or_default()
        .chunks(2)
        .map(|ends| Island { from: ends[0].safe, to: ends.get(1).map_or(search.max_rate, |end| end.safe) })
        .collect();
    islands.retain(|island| island.from <= island.to);
    let capped = borders.is_empty();
    let (upper, border, beyond) = match borders.first() {
        Some(first) => (first.safe, first.ride, first.beyond),
        None => (search.max_rate, last, None),
    };
    let outcome = border.map(|ride| ride.outcome);
    let border = border.filter(|_| search.efforts);
    Column { speed, upper, capped, islands, scan, outcome, border, beyond, work }
}
