//! Jumps far ahead in time: a wrong time stamp, or a pause in the recording.

use std::fmt::{self, Display};

/// Time between two rows above which the time stamp is doubtful \[s\].
const PAUSE_S: f64 = 3600.0;
/// If at least one in this many samples jumps, the unit of the time is wrong, not a time stamp.
const RARE: usize = 10;

/// A time in a recording that is more than an hour later than the previous one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leap {
    /// Line of the later row, from 1; `None` if the recording has no lines.
    pub line: Option<u64>,
    /// Time of the sample before the jump \[s\].
    pub from_s: f64,
    /// Time of the sample after the jump \[s\].
    pub to_s: f64,
}

impl Display for Leap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "time jumps from {} s to {} s: check this time stamp", self.from_s, self.to_s)
    }
}

/// The jumps between the times of a sensor's samples \[s\]; `line_of` gives the line of a sample by its index. Empty if
/// there are many.
pub(super) fn leaps(times_s: &[f64], line_of: impl Fn(usize) -> Option<u64>) -> Vec<Leap> {
    let leap = |(at, two): (usize, &[f64])| Leap { line: line_of(at + 1), from_s: two[0], to_s: two[1] };
    let far = |leap: &Leap| leap.to_s - leap.from_s > PAUSE_S;
    let found: Vec<Leap> = times_s.windows(2).enumerate().map(leap).filter(far).collect();
    if RARE * found.len() < times_s.len() { found } else { Vec::new() }
}
