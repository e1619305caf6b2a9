//! The plain search: every ride exact and to its end.

use super::scan::{Border, Edge, SECTIONS, column, edges, fell, rates};
use super::{Column, ScanPoint, Search, Work};
use crate::ride::{Conditions, FallCause, Ride, Start, rides};
use std::convert::Infallible;

/// [`rides`] as an infallible function for [`explored`].
pub(super) fn ridden(conditions: &Conditions) -> impl Fn(&[Start]) -> Result<Vec<Ride>, Infallible> {
    |starts| Ok(rides(conditions, starts))
}

/// The column by exact rides only.
pub(super) fn plain(conditions: &Conditions, search: &Search, start: &dyn Fn(f64) -> Start) -> Column {
    let Ok(column) = explored(&ridden(conditions), search, start, false);
    column
}

/// Scans a line of disturbances and narrows the borders; with `first_only` in groups up to the first with a fall, and only
/// the first border.
pub(super) fn explored<E>(
    rides: &impl Fn(&[Start]) -> Result<Vec<Ride>, E>,
    search: &Search,
    start: &dyn Fn(f64) -> Start,
    first_only: bool,
) -> Result<Column, E> {
    let mut work = Work::default();
    let mut ride = |rates: &[f64]| -> Result<Vec<Ride>, E> {
        let starts: Vec<Start> = rates.iter().map(|&r| start(r)).collect();
        let done = rides(&starts)?;
        work.add(&done);
        Ok(done)
    };
    let rates = rates(search);
    let mut done: Vec<Ride> = Vec::new();
    for group in rates.chunks(if first_only { SECTIONS } else { rates.len().max(1) }) {
        done.extend(ride(group)?);
        if done.iter().any(Ride::fell) {
            break;
        }
    }
    let points = rates.iter().zip(&done).map(|(&rate, ride)| ScanPoint { rate, outcome: ride.outcome });
    let scan: Vec<ScanPoint> = points.collect();
    let mut found = edges(&scan);
    found.truncate(if first_only { 1 } else { usize::MAX });
    let of = |rate: f64| rates.iter().position(|r| *r == rate).map(|i| done[i]);
    let mut borders = Vec::with_capacity(found.len());
    for edge in found {
        let beyond = of(edge.fell).and_then(|ride| ride.outcome.fall());
        borders.push(narrow(&mut ride, edge, beyond, search.tolerance, of(edge.safe))?);
    }
    Ok(column(start(0.0).speed_m_s, search, scan, &borders, done.last().copied(), work))
}

/// Narrows a border to `tolerance`. `beyond` is the cause of the fall at one end, `at` the ride at the other.
pub(super) fn narrow<E>(
    ride: &mut impl FnMut(&[f64]) -> Result<Vec<Ride>, E>,
    mut edge: Edge,
    mut beyond: Option<FallCause>,
    tolerance: f64,
    mut at: Option<Ride>,
) -> Result<Border, E> {
    while !edge.narrow(tolerance) {
        let rates = edge.sections();
        let done = ride(&rates)?;
        let safe = match done.iter().position(|ride| fell(ride.outcome)) {
            Some(first) => {
                (edge.fell, beyond) = (rates[first], done[first].outcome.fall());
                first.checked_sub(1)
            }
            None => Some(SECTIONS - 1),
        };
        if let Some(safe) = safe {
            (edge.safe, at) = (rates[safe], Some(done[safe]));
        }
    }
    Ok(Border { safe: edge.safe, ride: at, beyond })
}
