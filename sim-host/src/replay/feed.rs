//! Input of the controller from samples: at each control instant the newest sample of every sensor and its age.

use super::leap::Leap;
use super::map::Resample;
use super::samples::{Sample, Samples, Track};
use crate::bicycle::Start;
use crate::num::RandomStream;
use crate::plant::{Channel, Fault, FaultState, Held, Measured, Sensor, faulty};

/// Longest recording, in control periods: five hours at 1 kHz.
const MOST_TICKS: f64 = 18e6;

/// Options of the conversion from samples to control instants.
#[derive(Clone, Debug)]
pub struct FeedOptions<'a> {
    /// Length of a control period \[s\].
    pub period_s: f64,
    /// Value between two samples.
    pub resample: Resample,
    /// Longest time between two samples that is interpolated \[s\].
    pub longest_gap_s: f64,
    /// Faults injected into the recorded data; times count from the first sample.
    pub faults: &'a [Fault],
    /// Seed of the faults' random numbers.
    pub seed: u64,
}

/// Why a recording cannot be replayed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FeedError {
    /// No sensor has a sample.
    #[error("there is no sample")]
    Empty,
    /// The recording is too long to be replayed at once.
    #[error("it lasts from {start_s} to {end_s} s; at most {most_s} s can be replayed at once; {}", reason(.leap))]
    TooLong {
        /// Time of the first sample \[s\].
        start_s: f64,
        /// Time of the last sample \[s\].
        end_s: f64,
        /// Longest time that can be replayed \[s\].
        most_s: f64,
        /// The first jump far ahead in time, if any.
        leap: Option<Leap>,
    },
}

/// Probable reason of a recording that is too long.
fn reason(leap: &Option<Leap>) -> String {
    let line = |line: Option<u64>| line.map_or(String::new(), |line| format!("line {line}: "));
    leap.map_or("is the unit of the time right?".into(), |leap| format!("{}{leap}", line(leap.line)))
}

/// The control instants of a recording, in order.
#[derive(Debug)]
pub struct Feed<'a> {
    samples: &'a Samples,
    options: FeedOptions<'a>,
    start_s: f64,
    ticks: i64,
    tick: i64,
    /// Index of each track's next sample.
    next: Vec<usize>,
    held: [Held; Sensor::ALL.len()],
    faults: Vec<FaultState>,
}

impl<'a> Feed<'a> {
    /// Starts before the first control instant.
    ///
    /// # Errors
    /// The recording is too long, or has no sample.
    pub fn new(samples: &'a Samples, options: FeedOptions<'a>) -> Result<Self, FeedError> {
        let (start_s, end_s) = samples.span_s().ok_or(FeedError::Empty)?;
        let ticks = (end_s - start_s) / options.period_s;
        if ticks > MOST_TICKS {
            let most_s = MOST_TICKS * options.period_s;
            return Err(FeedError::TooLong { start_s, end_s, most_s, leap: samples.leaps.first().copied() });
        }
        let first = |channel: Channel| match channel {
            Channel::Sensor(sensor) => samples.track(sensor).map_or([0.0; 3], |track| track.samples[0].value),
            Channel::Motor | Channel::Engage | Channel::Clock => [0.0; 3],
        };
        let random = |purpose: usize| RandomStream::new(options.seed, Start::default().key(), purpose as u64);
        let state = |(index, fault): (usize, &Fault)| {
            FaultState::new(fault, options.period_s, first(fault.channel), random(index))
        };
        let faults = options.faults.iter().enumerate().map(state).collect();
        let none = Held { value: [0.0; 3], age_ticks: u16::MAX };
        Ok(Self {
            samples,
            start_s,
            ticks: (ticks + 1e-6) as i64 + 1,
            tick: 0,
            next: vec![0; samples.tracks.len()],
            held: [none; Sensor::ALL.len()],
            faults,
            options,
        })
    }

    /// Number of control instants.
    pub fn len(&self) -> u64 {
        self.ticks as u64
    }

    /// Whether there is no control instant.
    pub fn is_empty(&self) -> bool {
        self.ticks == 0
    }

    /// The next control instant: its time in the recording \[s\] and the controller's input, with the recorded switch
    /// or, without one, `pressed`; `None` after the last.
    pub fn next(&mut self, pressed: bool) -> Option<(f64, Measured)> {
        if self.tick >= self.ticks {
            return None;
        }
        let period_s = self.options.period_s;
        let t_s = self.start_s + self.tick as f64 * period_s;
        for (track, next) in self.samples.tracks.iter().zip(&mut self.next) {
            let arrived = arrived(track, next, t_s, &self.options);
            let channel = Channel::Sensor(track.sensor);
            let held = &mut self.held[track.sensor as usize];
            *held = match faulty(self.options.faults, &mut self.faults, channel, self.tick, arrived) {
                Some(value) => Held { value, age_ticks: 0 },
                None => Held { age_ticks: held.age_ticks.saturating_add(1), ..*held },
            };
        }
        let recorded = self.samples.engage.partition_point(|(from_s, _)| *from_s <= t_s);
        let engage = match recorded.checked_sub(1) {
            Some(at) => self.samples.engage[at].1,
            None => self.samples.engage.is_empty() && pressed,
        };
        let mut through = |channel, value: f64| {
            let sample = Some([value, 0.0, 0.0]);
            faulty(self.options.faults, &mut self.faults, channel, self.tick, sample)
                .map_or(0.0, |[value, ..]| value)
        };
        let engage = through(Channel::Engage, f64::from(u8::from(engage))) >= 0.5;
        let now_us = (through(Channel::Clock, self.tick as f64 * period_s) * 1e6).round() as i64 as u32;
        self.tick += 1;
        Some((t_s, Measured::new(self.held, now_us, engage)))
    }
}

/// The sample that is new at `t_s`, if any.
fn arrived(track: &Track, next: &mut usize, t_s: f64, options: &FeedOptions<'_>) -> Option<[f64; 3]> {
    let before = *next;
    // A millionth of a period late is in time: it is a rounding error.
    let limit_s = t_s + 1e-6 * options.period_s;
    while track.samples.get(*next).is_some_and(|sample| sample.t_s <= limit_s) {
        *next += 1;
    }
    let last = track.samples.get(next.checked_sub(1)?)?;
    match (options.resample, track.samples.get(*next)) {
        (Resample::Interpolate, Some(after)) if after.t_s - last.t_s <= options.longest_gap_s => {
            Some(between(last, after, t_s))
        }
        _ => (*next > before).then_some(last.value),
    }
}

/// Linear interpolation between two samples.
fn between(a: &Sample, b: &Sample, t_s: f64) -> [f64; 3] {
    let share = ((t_s - a.t_s) / (b.t_s - a.t_s)).clamp(0.0, 1.0);
    std::array::from_fn(|i| a.value[i] + share * (b.value[i] - a.value[i]))
}
