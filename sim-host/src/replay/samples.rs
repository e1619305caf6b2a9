//! The samples of each sensor, in SI units and the bicycle's axes.

use super::leap::Leap;
use crate::plant::Sensor;
use crate::recording::Remark;

/// One sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time of the sample \[s\], on the recording's clock.
    pub t_s: f64,
    /// Its values in the order of [`Sensor::axes`], SI; unused axes are zero.
    pub value: [f64; 3],
}

/// A sensor's samples, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Which sensor.
    pub sensor: Sensor,
    /// Its samples: at least one, with rising times.
    pub samples: Vec<Sample>,
    /// Axes without a column, filled with a substitute value.
    pub made_up: [bool; 3],
}

impl Track {
    /// Median time between two samples \[s\]; `None` for a single sample.
    pub fn period_s(&self) -> Option<f64> {
        let mut gaps: Vec<f64> = self.samples.windows(2).map(|two| two[1].t_s - two[0].t_s).collect();
        gaps.sort_by(f64::total_cmp);
        gaps.get(gaps.len() / 2).copied()
    }
}

/// The samples of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// The recorded sensors.
    pub tracks: Vec<Track>,
    /// The rider's switch, if recorded: time of each sample \[s\], and whether it is on.
    pub engage: Vec<(f64, bool)>,
    /// The recording's own roll angle \[rad\] over time \[s\].
    pub roll_rad: Vec<(f64, f64)>,
    /// The recording's own steer torque \[N m\] over time \[s\].
    pub torque_nm: Vec<(f64, f64)>,
    /// The distance counted by a wheel sensor \[m\] over time \[s\].
    pub distance_m: Vec<(f64, f64)>,
    /// Optional sensors of the map that the recording lacks, each with its columns that are missing or have no value.
    pub absent: Vec<String>,
    /// Data that is unusable or looks wrong.
    pub remarks: Vec<Remark>,
    /// Jumps far ahead in time, of each sensor; also in the remarks.
    pub leaps: Vec<Leap>,
}

impl Samples {
    /// The samples of one sensor.
    pub fn track(&self, sensor: Sensor) -> Option<&Track> {
        self.tracks.iter().find(|track| track.sensor == sensor)
    }

    /// Time of the first and the last sample of any sensor \[s\].
    pub fn span_s(&self) -> Option<(f64, f64)> {
        let ends = |track: &Track| Some((track.samples.first()?.t_s, track.samples.last()?.t_s));
        self.tracks.iter().filter_map(ends).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}
