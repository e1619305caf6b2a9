//! Which samples of a recording are usable.

use super::record::{Record, Signal};

/// Deviation of the time between two samples from its median that counts as a gap, relative.
pub(super) const GAP: f64 = 0.5;
/// The torque changes while a controller acts: at least once in this time to either side \[s\].
const DRIVEN_S: f64 = 0.25;
/// Samples in a row at the largest torque that show a limit.
const AT_LIMIT: usize = 3;
/// Below this part of the largest torque it is not at its limit.
const NEAR_LIMIT: f64 = 0.999;
/// Angle and rate of the steer beyond which the sensor counts as wrong \[rad\], \[rad/s\].
const STEER_MOST: (f64, f64) = (1.0, 20.0);
/// Shortest recording, and shortest part with a torque \[s\].
pub(super) const SHORTEST_S: f64 = 3.0;
/// Fewest samples of a fit.
pub(super) const FEWEST: usize = 150;

/// A recording from which nothing can be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// Vectors of different length.
    #[error("the vectors of the recording have different lengths")]
    Lengths,
    /// Too few samples.
    #[error("{seconds:.2} s with {samples} samples; at least {SHORTEST_S} s and {FEWEST} samples are needed")]
    Short {
        /// Duration \[s\].
        seconds: f64,
        /// Samples.
        samples: usize,
    },
    /// Times that do not increase.
    #[error("the times do not increase: {before} s, then {after} s at sample {sample}")]
    Unsorted {
        /// Index of the second.
        sample: usize,
        /// The earlier time \[s\].
        before: f64,
        /// The later time \[s\].
        after: f64,
    },
    /// A torque without values.
    #[error("the torque has no value")]
    NoTorque,
    /// A torque that hardly ever changes.
    #[error(
        "the torque changes during {seconds:.2} s only; at least {SHORTEST_S} s are needed: no controller acted, or its torque was not recorded"
    )]
    Idle {
        /// Time in which it changes \[s\].
        seconds: f64,
    },
}

/// The usable samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// Median time between two samples \[s\].
    pub period_s: f64,
    /// Where the torque changes, within its limit, and the steer angle sensor is plausible.
    pub driven: Vec<bool>,
    /// The torque's limit \[N m\], if it was reached.
    pub limit_nm: Option<f64>,
    /// Fraction of the samples with a changing torque at this limit.
    pub limited: f64,
    /// Where the steer angle sensor is plausible.
    pub plausible: Vec<bool>,
    /// First samples after gaps, from 0 to the number of samples.
    pub breaks: Vec<usize>,
}

impl Checked {
    /// Duration of marked samples \[s\].
    pub fn seconds(&self, marked: &[bool]) -> f64 {
        marked.iter().filter(|mark| **mark).count() as f64 * self.period_s
    }

    /// Whether a torque is at its limit, where the drive may have less.
    pub(super) fn at_limit(&self, torque_nm: f64) -> bool {
        self.limit_nm.is_some_and(|limit| torque_nm.abs() >= NEAR_LIMIT * limit)
    }

    /// Number of samples in a time.
    pub(super) fn samples(&self, time_s: f64) -> usize {
        (time_s / self.period_s).round().max(1.0) as usize
    }
}

/// Finds the usable samples.
///
/// # Errors
/// A recording that is too short, not in the order of time, or without a controller's torque.
pub fn check(record: &Record) -> Result<Checked, RecordError> {
    let Record { times_s, torque_nm, speed_m_s, channels, distance_m } = record;
    let n = times_s.len();
    let lengths =
        channels.iter().map(|channel| channel.values.len()).chain([torque_nm.len(), speed_m_s.len()]);
    if lengths.chain(distance_m.iter().map(Vec::len)).any(|length| length != n) {
        return Err(RecordError::Lengths);
    }
    let sorted = |two: &[f64]| two[1] > two[0];
    if let Some(i) = times_s.windows(2).position(|two| !sorted(two)) {
        return Err(RecordError::Unsorted { sample: i + 1, before: times_s[i], after: times_s[i + 1] });
    }
    let seconds = times_s.last().zip(times_s.first()).map_or(0.0, |(last, first)| last - first);
    if n < FEWEST || seconds < SHORTEST_S {
        return Err(RecordError::Short { seconds, samples: n });
    }
    let mut steps: Vec<f64> = times_s.windows(2).map(|two| two[1] - two[0]).collect();
    steps.sort_by(f64::total_cmp);
    let period_s = steps[steps.len() / 2];
    if torque_nm.iter().all(|torque| !torque.is_finite()) {
        return Err(RecordError::NoTorque);
    }
    let limit_nm = limit(torque_nm);
    let moving = moving(torque_nm, (DRIVEN_S / period_s).round().max(1.0) as usize);
    let beyond = |torque: f64| limit_nm.is_some_and(|limit| torque.abs() >= NEAR_LIMIT * limit);
    let plausible = plausible(record);
    let changing = moving.iter().filter(|moves| **moves).count();
    let limited = (0..n).filter(|i| moving[*i] && beyond(torque_nm[*i])).count();
    let driven: Vec<bool> = (0..n).map(|i| moving[i] && plausible[i] && !beyond(torque_nm[i])).collect();
    let checked = Checked {
        period_s,
        driven,
        limit_nm,
        limited: limited as f64 / changing.max(1) as f64,
        plausible,
        breaks: record.breaks(period_s),
    };
    let seconds = checked.seconds(&checked.driven);
    if seconds < SHORTEST_S { Err(RecordError::Idle { seconds }) } else { Ok(checked) }
}

/// The largest torque, if it occurs several times in a row.
fn limit(torque_nm: &[f64]) -> Option<f64> {
    let most = torque_nm.iter().map(|torque| torque.abs()).fold(0.0, f64::max);
    let stands =
        |run: &[f64]| run.iter().all(|torque| torque.abs() >= NEAR_LIMIT * most && *torque == run[0]);
    (most > 0.0 && torque_nm.windows(AT_LIMIT).any(stands)).then_some(most)
}

/// Where the torque is known and changes within `near` samples.
fn moving(torque_nm: &[f64], near: usize) -> Vec<bool> {
    let changes = torque_nm.windows(2).enumerate().filter(|(_, two)| two[0] != two[1]);
    let mut moving = vec![false; torque_nm.len()];
    for (i, _) in changes.filter(|(_, two)| two.iter().all(|torque| torque.is_finite())) {
        let to = (i + near + 2).min(moving.len());
        moving[i.saturating_sub(near)..to].fill(true);
    }
    moving.iter().zip(torque_nm).map(|(moves, torque)| *moves && torque.is_finite()).collect()
}

/// Where neither steer angle nor steer rate is beyond what a steer does.
fn plausible(record: &Record) -> Vec<bool> {
    let within = |signal, most: f64, i: usize| {
        record.channel(signal).is_none_or(|values| values[i].is_nan() || values[i].abs() <= most)
    };
    let of = |i| within(Signal::Steer, STEER_MOST.0, i) && within(Signal::SteerRate, STEER_MOST.1, i);
    (0..record.times_s.len()).map(of).collect()
}
