//! What a process waits for while others compute all that is left of a folder.

use super::claim::{Claim, now_unix_s};
use super::worker::Worker;
use std::fmt::{self, Display};
use std::time::{Duration, Instant};

/// Time without work after which a wait is told.
const FIRST: Duration = Duration::from_secs(1);
/// Time after which it is told again.
const AGAIN: Duration = Duration::from_secs(60);

/// A wait for units that other processes compute.
#[derive(Clone, Debug, PartialEq)]
pub struct Wait {
    /// Name of a unit: "cell", "record".
    unit: &'static str,
    /// Number of units that are not finished.
    pub units: usize,
    /// The processes that hold them, in the order of their first units.
    pub holders: Vec<Holder>,
    /// Estimated time until the last is finished \[s\], from the columns finished since each claim; `None` unless every
    /// claim has some.
    pub remaining_s: Option<f64>,
}

/// A process that holds units.
#[derive(Clone, Debug, PartialEq)]
pub struct Holder {
    /// The process.
    pub worker: Worker,
    /// Number of its units.
    pub units: usize,
    /// Time since the oldest of its claims \[s\].
    pub age_s: u64,
    /// Time since the oldest of their renewals \[s\].
    pub renewed_s: u64,
    /// Time by which a renewal is in the future: the clocks differ \[s\].
    pub ahead_s: u64,
}

impl Wait {
    /// The wait for `units` units of `columns` columns each, of which these claims are known.
    pub fn new(unit: &'static str, units: usize, columns: usize, claims: &[Claim]) -> Self {
        let now = now_unix_s();
        let mut holders: Vec<Holder> = Vec::new();
        for claim in claims {
            let Some(worker) = &claim.worker else { continue };
            let place = holders.iter().position(|holder| holder.worker == *worker).unwrap_or_else(|| {
                let worker = worker.clone();
                holders.push(Holder { worker, units: 0, age_s: 0, renewed_s: 0, ahead_s: 0 });
                holders.len() - 1
            });
            let holder = &mut holders[place];
            holder.units += 1;
            holder.age_s = holder.age_s.max(claim.age_s(now));
            holder.renewed_s = holder.renewed_s.max(claim.renewed_s(now));
            holder.ahead_s = holder.ahead_s.max(claim.ahead_s(now));
        }
        let each: Option<Vec<f64>> = claims.iter().map(|claim| claim.remaining_s(columns, now)).collect();
        let known = each.filter(|each| each.len() == units);
        Self { unit, units, holders, remaining_s: known.and_then(|each| each.into_iter().reduce(f64::max)) }
    }
}

impl Display for Wait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let several = if self.units == 1 { "" } else { "s" };
        write!(f, "waiting for {} {}{several} of other processes", self.units, self.unit)?;
        for (holder, separator) in self.holders.iter().zip([": "].into_iter().chain(std::iter::repeat("; ")))
        {
            let Holder { worker, units, age_s, renewed_s, ahead_s } = holder;
            write!(f, "{separator}{units} by {}, claimed {age_s} s ago, ", worker.name())?;
            match *ahead_s {
                0 => write!(f, "renewed {renewed_s} s ago")?,
                ahead => write!(f, "{}", in_the_future(ahead))?,
            }
        }
        self.remaining_s.map_or(Ok(()), |s| write!(f, "; about {s:.0} s left"))
    }
}

/// Words for a renewal that is `ahead_s` seconds in the future.
pub fn in_the_future(ahead_s: u64) -> String {
    format!("renewed {ahead_s} s in the future, the machines' clocks differ")
}

/// When a wait is told: after a second, then every minute.
#[derive(Debug, Default)]
pub struct Reminder {
    since: Option<Instant>,
    told: Option<Instant>,
}

impl Reminder {
    /// Called while waiting; true if it is time to tell of it.
    pub fn is_due(&mut self) -> bool {
        let since = *self.since.get_or_insert_with(Instant::now);
        let due = self.told.map_or(since.elapsed() >= FIRST, |told| told.elapsed() >= AGAIN);
        if due {
            self.told = Some(Instant::now());
        }
        due
    }

    /// The wait is over.
    pub fn over(&mut self) {
        *self = Self::default();
    }
}
