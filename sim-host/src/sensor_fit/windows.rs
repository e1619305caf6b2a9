//! Recordings cut into seconds, each of them standing, riding or neither.

use super::Recording;
use super::spectrum::Spectrum;
use crate::plant::Sensor;
use crate::replay::{Sample, Track};

/// A wheel slower than this stands \[m/s\].
const STANDING_M_S: f64 = 0.05;
/// A bicycle faster than this rides \[m/s\].
const RIDING_M_S: f64 = 1.0;
/// A standing window is still if no axis sways more than this many times what the stillest twentieth does.
const STILL: f64 = 1.25;
/// A sensor of which an axis repeats more often sleeps, or lies between two of its steps.
const ASLEEP: f64 = 0.6;
/// Length of a window \[s\].
pub(super) const WINDOW_S: f64 = 1.0;

/// What the bicycle does in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// It stands.
    Standing,
    /// It rides at this speed \[m/s\].
    Riding(f64),
}

/// A second without a gap in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// Its first sample, and the one after its last.
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) motion: Motion,
}

/// The samples of the sensor in one recording.
pub(super) struct Recorded<'a> {
    pub(super) recording: &'a Recording,
    pub(super) track: &'a Track,
    /// Median time between samples \[s\].
    pub(super) period_s: f64,
    pub(super) windows: Vec<Window>,
}

impl<'a> Recorded<'a> {
    /// None if the recording lacks the sensor.
    pub(super) fn new(recording: &'a Recording, sensor: Sensor) -> Option<Self> {
        let track = recording.samples.track(sensor)?;
        let period_s = track.period_s()?;
        let speed = recording.samples.track(Sensor::RearWheel);
        let speed = speed.or_else(|| recording.samples.track(Sensor::FrontWheel))?;
        let windows = windows(&track.samples, period_s, &speed.samples);
        Some(Self { recording, track, period_s, windows })
    }

    /// The values of an axis in a window.
    pub(super) fn values(&self, window: &Window, axis: usize) -> Vec<f64> {
        self.track.samples[window.from..window.to].iter().map(|sample| sample.value[axis]).collect()
    }

    /// The spectrum of an axis in a window.
    pub(super) fn spectrum(&self, window: &Window, axis: usize) -> Spectrum {
        Spectrum::new(&self.values(window, axis), self.period_s)
    }

    /// The windows in which the bicycle rides, with its speed \[m/s\].
    pub(super) fn riding(&self) -> impl Iterator<Item = (&Window, f64)> {
        self.windows.iter().filter_map(|window| match window.motion {
            Motion::Riding(speed) => Some((window, speed)),
            Motion::Standing => None,
        })
    }

    /// How much each axis sways about a straight line in a window.
    fn sway(&self, window: &Window, axes: usize) -> Vec<f64> {
        (0..axes).map(|axis| Spectrum::new(&self.values(window, axis), self.period_s).deviation).collect()
    }

    /// Whether every axis goes on saying something new.
    fn awake(&self, window: &Window, axes: usize) -> bool {
        let repeats = |axis: usize| {
            let values = self.values(window, axis);
            values.windows(2).filter(|two| two[0] == two[1]).count() as f64 / values.len() as f64
        };
        (0..axes).all(|axis| self.track.made_up[axis] || repeats(axis) <= ASLEEP)
    }

    /// The windows in which the bicycle stands and the sensor does not sleep, with how much each axis sways.
    fn standing(&self, axes: usize) -> Vec<(&Window, Vec<f64>)> {
        let standing = self.windows.iter().filter(|window| window.motion == Motion::Standing);
        let awake = standing.filter(|window| self.awake(window, axes));
        awake.map(|window| (window, self.sway(window, axes))).collect()
    }
}

/// The windows in which the bicycle stands still, in each of the recordings.
pub(super) fn still<'a>(all: &'a [Recorded<'a>], axes: usize) -> Vec<Vec<&'a Window>> {
    let standing: Vec<_> = all.iter().map(|one| one.standing(axes)).collect();
    let least = |axis: usize| {
        let mut sways: Vec<f64> = standing.iter().flatten().map(|(_, sway)| sway[axis]).collect();
        sways.sort_by(f64::total_cmp);
        sways.get(sways.len() / 20).copied().unwrap_or_default()
    };
    let most: Vec<f64> = (0..axes).map(|axis| STILL * least(axis)).collect();
    let quiet = |(window, sway): &(&'a Window, Vec<f64>)| {
        sway.iter().zip(&most).all(|(sway, most)| sway <= most).then_some(*window)
    };
    standing.iter().map(|windows| windows.iter().filter_map(quiet).collect()).collect()
}

fn windows(samples: &[Sample], period_s: f64, speed: &[Sample]) -> Vec<Window> {
    let length = ((WINDOW_S / period_s).round() as usize).max(4);
    let whole = |(i, window): (usize, &[Sample])| {
        let gap = window.windows(2).any(|two| two[1].t_s - two[0].t_s > 1.5 * period_s);
        let motion = if gap { None } else { motion(window, speed) };
        motion.map(|motion| Window { from: i * length, to: (i + 1) * length, motion })
    };
    samples.chunks_exact(length).enumerate().filter_map(whole).collect()
}

/// What the bicycle does while the samples are taken, if it is one thing.
fn motion(window: &[Sample], speed: &[Sample]) -> Option<Motion> {
    let (from, to) = (window[0].t_s, window[window.len() - 1].t_s);
    let first = speed.partition_point(|sample| sample.t_s <= from).saturating_sub(1);
    let last = speed.partition_point(|sample| sample.t_s <= to);
    let speeds: Vec<f64> = speed[first..last].iter().map(|sample| sample.value[0]).collect();
    let low = speeds.iter().copied().reduce(f64::min)?;
    let high = speeds.iter().copied().reduce(f64::max)?;
    if low.abs().max(high.abs()) <= STANDING_M_S {
        Some(Motion::Standing)
    } else if low > RIDING_M_S {
        Some(Motion::Riding(speeds.iter().sum::<f64>() / speeds.len() as f64))
    } else {
        None
    }
}
