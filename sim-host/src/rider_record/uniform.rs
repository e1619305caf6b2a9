//! From signals with times of their own to samples at equal intervals.

use super::doubts::doubts;
use super::error::{FEWEST, RATES_HZ, RecordError};
use super::outliers::without;
use crate::identify::{Disturbances, Hold, Measured, Record, Signal};
use crate::range::{plain, within_key};
use crate::replay::{Perturbed, Timed};

/// Longest bridged time between two samples, in sample times; a longer one is a gap.
const GAP: f64 = 3.0;
/// Largest deviation from a sample's time that counts as none, in sample times.
const ON_TIME: f64 = 1e-3;
/// Time after a gap in the disturbance whose response is unknown \[s\].
const UNKNOWN_AFTER_S: f64 = 2.0;
const MOST: f64 = 2e6;

/// Options of the preparation.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Signals to fit.
    pub signals: Vec<Signal>,
    /// Course of the disturbances between two samples.
    pub hold: Hold,
    /// Forward speed \[m/s\] in place of the recorded one.
    pub speed_m_s: Option<f64>,
}

/// A record at equal intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// The record.
    pub record: Record,
    /// Time of its first sample \[s\].
    pub start_s: f64,
    /// Mean forward speed \[m/s\].
    pub speed_m_s: f64,
    /// Recorded speed at each sample \[m/s\]; empty if another one is given or none was recorded.
    pub speeds_m_s: Vec<f64>,
    /// Standard deviation of the recorded speed \[m/s\]; `None` if the speed was not recorded.
    pub speed_deviation_m_s: Option<f64>,
    /// What was left out, bridged or looks wrong.
    pub remarks: Vec<String>,
}

/// Remarks about signals; the same about several, as the columns of a table have the same times, is one.
#[derive(Default)]
struct SharedRemarks(Vec<(Vec<&'static str>, String)>);

impl SharedRemarks {
    fn add(&mut self, what: &'static str, remark: Option<String>) {
        let Some(remark) = remark else { return };
        match self.0.iter_mut().find(|(_, other)| *other == remark) {
            Some((all, _)) => all.push(what),
            None => self.0.push((vec![what], remark)),
        }
    }

    fn all(self) -> impl Iterator<Item = String> {
        self.0.into_iter().map(|(all, remark)| format!("{}: {remark}", all.join(", ")))
    }
}

/// The samples with rising times, and a remark about the others: those that are not later than the one before, and those
/// that are later than the one after, if that one is not behind, too.
fn rising(signal: &Timed) -> (Timed, Option<String>) {
    let mut rising: Timed = Vec::with_capacity(signal.len());
    let mut first = None;
    for (k, (t_s, value)) in signal.iter().enumerate() {
        let last_s = rising.last().map_or(f64::NEG_INFINITY, |last| last.0);
        let next_s = signal.get(k + 1).map_or(f64::INFINITY, |next| next.0);
        let turn = if *t_s <= last_s {
            (last_s, *t_s)
        } else if next_s < *t_s && next_s > last_s {
            (*t_s, next_s)
        } else {
            rising.push((*t_s, *value));
            continue;
        };
        first = first.or(Some(turn));
    }
    let left_out = signal.len() - rising.len();
    let remark = first.map(|(from, to)| {
        let [from_s, to_s] = [from, to].map(plain);
        let turn = if to == from {
            format!("stands at {from_s} s")
        } else {
            format!("goes back from {from_s} to {to_s} s")
        };
        format!("the time {turn}; {left_out} of {} samples left out", signal.len())
    });
    (rising, remark)
}

/// The middle value; zero of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Median time between two samples \[s\].
fn median_period(signal: &Timed) -> f64 {
    median(signal.windows(2).map(|two| two[1].0 - two[0].0))
}

/// A signal on the grid of times.
struct Gridded {
    values: Vec<f64>,
    valid: Vec<bool>,
}

/// Values at `start + k * sample_s`, linear between two samples or constant from the one before; not valid in gaps and beyond
/// the ends.
fn gridded(signal: &Timed, start_s: f64, sample_s: f64, count: usize, hold: Hold) -> Gridded {
    let (mut values, mut valid) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut next = 0;
    for k in 0..count {
        let t = start_s + k as f64 * sample_s;
        while next < signal.len() && signal[next].0 <= t + ON_TIME * sample_s {
            next += 1;
        }
        let (before, after) = (next.checked_sub(1).map(|i| signal[i]), signal.get(next));
        let (value, known) = match (before, after) {
            (Some((at, value)), _) if (t - at).abs() <= ON_TIME * sample_s => (value, true),
            (Some((from, a)), Some((to, b))) => {
                let share = (t - from) / (to - from);
                let value = if hold == Hold::Zero { a } else { a + (b - a) * share };
                (value, to - from <= GAP * sample_s)
            }
            (Some((from, value)), None) => (value, t - from <= GAP * sample_s),
            (None, _) => (0.0, false),
        };
        values.push(value);
        valid.push(known);
    }
    Gridded { values, valid }
}

/// A disturbance with its median in gaps, the likeliest value: between pulses there is none.
fn undisturbed_in_gaps(signal: &Timed, mut gridded: Gridded) -> Gridded {
    let middle = median(signal.iter().map(|(_, value)| *value));
    let gaps = gridded.values.iter_mut().zip(&gridded.valid).filter(|(_, valid)| !**valid);
    gaps.for_each(|(value, _)| *value = middle);
    gridded
}

/// Marks the samples that respond to a missing disturbance as unknown; says how many are missing, if any.
fn after_gaps(what: &str, of: &Gridded, sample_s: f64, unknown: &mut [bool]) -> Option<String> {
    let mut since = f64::INFINITY;
    for (unknown, valid) in unknown.iter_mut().zip(&of.valid) {
        since = if *valid { since + sample_s } else { 0.0 };
        *unknown |= since <= UNKNOWN_AFTER_S;
    }
    let (missing, count) = (of.valid.iter().filter(|valid| !**valid).count(), of.valid.len());
    (missing > 0).then(|| {
        format!(
            "{what}: {missing} of {count} samples missing; the response to them, until {UNKNOWN_AFTER_S} s later, is left out"
        )
    })
}

/// The forward speed \[m/s\], given or else the mean of the recorded one, and the standard deviation of the recorded one \[m/s\].
fn forward_speed(given_m_s: Option<f64>, recorded: &Timed) -> Result<(f64, Option<f64>), RecordError> {
    let count = recorded.len() as f64;
    let mean = recorded.iter().map(|(_, v)| v).sum::<f64>() / count;
    let speed_m_s = match (given_m_s, recorded.is_empty()) {
        (Some(speed), _) => speed,
        (None, false) => mean,
        (None, true) => return Err(RecordError::NoSpeed),
    };
    within_key("speed_m_s", "forward speed (m/s)", speed_m_s, 0.1, 30.0)?;
    let deviation = (recorded.iter().map(|(_, v)| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
    Ok((speed_m_s, (!recorded.is_empty()).then_some(deviation)))
}

/// Brings the signals to equal intervals: the median time between two samples of the steer angle, or of the first signal
/// to fit.
///
/// # Errors
/// A signal is missing or has too few samples, or the speed is not known.
pub fn prepare(signals: &Perturbed, settings: &Settings) -> Result<Prepared, RecordError> {
    let mut shared = SharedRemarks::default();
    let mut sorted = |what: &'static str, signal: &Timed| {
        let (rising, remark) = rising(signal);
        shared.add(what, remark);
        rising
    };
    let mut outliers = SharedRemarks::default();
    let mut plausible = |what: &'static str, unit: &'static str, signal: Timed| {
        let (kept, remark) = without(unit, signal);
        outliers.add(what, remark);
        kept
    };
    let mut measured = Vec::new();
    for signal in &settings.signals {
        let (what, unit, columns, of) = match signal {
            Signal::Steer => ("steer angle", "rad", "steer_rad or steer_deg", &signals.steer_rad),
            Signal::Roll => ("roll angle", "rad", "roll_rad or roll_deg", &signals.roll_rad),
            Signal::RollRate => {
                ("roll rate", "rad/s", "roll_rate_rad_s or roll_rate_deg_s", &signals.roll_rate_rad_s)
            }
        };
        if of.is_empty() {
            return Err(RecordError::Missing { what, columns });
        }
        let of = plausible(what, unit, sorted(what, of));
        if of.len() < FEWEST {
            return Err(RecordError::Few { what, samples: of.len() });
        }
        measured.push((*signal, what, of));
    }
    let force = sorted("lateral force", &signals.lateral_force_n);
    let torque = sorted("steer torque", &signals.steer_torque_nm);
    if force.is_empty() && torque.is_empty() {
        let columns = "lateral_force_n, lateral_force_kn, lateral_force_lbf or steer_torque_nm";
        return Err(RecordError::Missing { what: "perturbation", columns });
    }
    let speed = plausible("speed", "m/s", sorted("speed", &signals.speed_m_s));
    let mut remarks: Vec<String> = shared.all().chain(outliers.all()).collect();
    let Some((_, _, leading)) = measured.first() else {
        return Err(RecordError::Missing { what: "signal to fit", columns: "steer_rad" });
    };
    let sample_s = median_period(leading);
    let rate_hz = sample_s.recip();
    if !(RATES_HZ.0..=RATES_HZ.1).contains(&rate_hz) {
        return Err(RecordError::Rate { rate_hz });
    }
    let (start_s, end_s) = (leading[0].0, leading[leading.len() - 1].0);
    let duration_s = end_s - start_s;
    if duration_s * rate_hz > MOST {
        let longest_s = leading.windows(2).map(|two| two[1].0 - two[0].0).fold(0.0, f64::max);
        return Err(RecordError::Long { duration_s, rate_hz, longest_s });
    }
    let count = (duration_s * rate_hz + 0.5) as usize + 1;
    let grid = |signal: &Timed, hold| gridded(signal, start_s, sample_s, count, hold);
    let disturbed = [&force, &torque].map(|signal| undisturbed_in_gaps(signal, grid(signal, settings.hold)));
    let mut unknown = vec![false; count];
    for (what, of, recorded) in
        [("lateral force", &disturbed[0], &force), ("steer torque", &disturbed[1], &torque)]
    {
        if !recorded.is_empty() {
            remarks.extend(after_gaps(what, of, sample_s, &mut unknown));
        }
    }
    let mut fitted = Vec::new();
    for (signal, what, of) in &measured {
        let Gridded { values, mut valid } = grid(of, Hold::Linear);
        let missing = valid.iter().filter(|valid| !**valid).count();
        if missing > 0 {
            remarks.push(format!("{what}: {missing} of {count} samples missing; not fitted"));
        }
        valid.iter_mut().zip(&unknown).for_each(|(valid, unknown)| *valid &= !unknown);
        let left_out = valid.iter().filter(|valid| !**valid).count();
        if 2 * left_out > count {
            return Err(RecordError::Gaps { what, missing: left_out, samples: count });
        }
        fitted.push(Measured { signal: *signal, values, valid });
    }
    let (speed_m_s, speed_deviation_m_s) = forward_speed(settings.speed_m_s, &speed)?;
    let samples = (0..count).map(|k| [0, 1].map(|i| disturbed[i].values[k])).collect();
    let record =
        Record { disturbances: Disturbances { sample_s, samples, hold: settings.hold }, measured: fitted };
    remarks.extend(doubts(&record, speed_m_s, speed_deviation_m_s));
    let recorded = if settings.speed_m_s.is_none() { grid(&speed, Hold::Linear).values } else { Vec::new() };
    Ok(Prepared { record, speeds_m_s: recorded, start_s, speed_m_s, speed_deviation_m_s, remarks })
}
