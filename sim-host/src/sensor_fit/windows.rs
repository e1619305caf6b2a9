//! Cuts recordings into windows of one second and classifies each as standstill, riding or neither.

use super::spectrum::Spectrum;
use crate::plant::Sensor;
use crate::replay::{Sample, Samples, Track};

/// One recording.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Samples of the sensors.
    pub samples: Samples,
    /// Distance counted by the wheel sensor \[m\] over time \[s\], if recorded with the speed.
    pub distance_m: Vec<(f64, f64)>,
}

/// Wheel speed below which the bicycle is at standstill \[m/s\].
const STANDING_M_S: f64 = 0.05;
/// Speed above which the bicycle rides \[m/s\].
const RIDING_M_S: f64 = 1.0;
/// A standstill window is still if each axis deviates at most this many times as much as in the stillest
/// twentieth.
const STILL: f64 = 1.25;
/// Share of repeated samples of an axis above which the sensor sleeps, or its value lies between two steps.
const ASLEEP: f64 = 0.6;
/// Length of a window \[s\].
pub(super) const WINDOW_S: f64 = 1.0;

/// Motion of the bicycle in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// At standstill.
    Standing,
    /// Riding at this speed \[m/s\].
    Riding(f64),
}

/// A window without a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// Index of its first sample, and one after its last.
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

    /// Values of an axis in a window.
    pub(super) fn values(&self, window: &Window, axis: usize) -> Vec<f64> {
        self.track.samples[window.from..window.to].iter().map(|sample| sample.value[axis]).collect()
    }

    /// Spectrum of an axis in a window.
    pub(super) fn spectrum(&self, window: &Window, axis: usize) -> Spectrum {
        Spectrum::new(&self.values(window, axis), self.period_s)
    }

    /// Windows in which the bicycle rides, with its speed \[m/s\].
    pub(super) fn riding(&self) -> impl Iterator<Item = (&Window, f64)> {
        self.windows.iter().filter_map(|window| match window.motion {
            Motion::Riding(speed) => Some((window, speed)),
            Motion::Standing => None,
        })
    }

    /// Standard deviation of each axis about its linear trend in a window.
    fn sway(&self, window: &Window, axes: usize) -> Vec<f64> {
        (0..axes).map(|axis| Spectrum::new(&self.values(window, axis), self.period_s).deviation).collect()
    }

    /// Whether every axis still gives new values.
    fn awake(&self, window: &Window, axes: usize) -> bool {
        let repeats = |axis: usize| {
            let values = self.values(window, axis);
            values.windows(2).filter(|two| two[0] == two[1]).count() as f64 / values.len() as f64
        };
        (0..axes).all(|axis| self.track.made_up[axis] || repeats(axis) <= ASLEEP)
    }

    /// Windows at standstill in which the sensor does not sleep, with the deviation of each axis.
    fn standing(&self, axes: usize) -> Vec<(&Window, Vec<f64>)> {
        let standing = self.windows.iter().filter(|window| window.motion == Motion::Standing);
        let awake = standing.filter(|window| self.awake(window, axes));
        awake.map(|window| (window, self.sway(window, axes))).collect()
    }
}

/// Windows in which the bicycle is still, for each of the recordings.
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

/// Motion of the bicycle during the samples, if it is uniform.
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
