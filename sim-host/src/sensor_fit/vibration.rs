//! Vibration above 10 Hz caused by riding, as a function of speed.

use super::estimates::{digits, mean, pooled, root};
use super::found::Found;
use super::windows::{Recorded, WINDOW_S};
use crate::plant::{OCTAVES_HZ, Sensor};

/// Width of the speed bins in the report \[m/s\].
const BIN_M_S: f64 = 1.0;
/// Lines of the spectrum next to an octave's end that are not used.
const LEAK: f64 = 1.5;
/// Speeds above this are not reported \[m/s\].
const FASTEST_M_S: f64 = 20.0;

pub(super) fn fit(all: &[Recorded], found: &mut Found) {
    if !matches!(found.sensor, Sensor::Gyro | Sensor::Accel) {
        let what = "vibration: above 10 Hz motion cannot be separated from the sensor's own errors";
        return found.left_out(what.into());
    }
    let seconds = all.iter().map(|one| one.riding().count()).sum::<usize>() as f64 * WINDOW_S;
    if seconds < 3.0 {
        return found.left_out(format!("vibration: only {seconds} s of riding"));
    }
    for axis in (0..found.axes()).filter(|axis| all.iter().any(|one| !one.track.made_up[*axis])) {
        over_speed(all, axis, found);
        found.numbers.vibration.resize(found.axes(), [0.0; 4]);
        for (octave, low_hz) in OCTAVES_HZ.into_iter().enumerate() {
            octaves(all, axis, (octave, low_hz), seconds, found);
        }
    }
}

/// Root mean square above 10 Hz in speed bins, including the sensor's noise.
fn over_speed(all: &[Recorded], axis: usize, found: &mut Found) {
    let mut low = BIN_M_S;
    while low < FASTEST_M_S {
        let high = low + BIN_M_S;
        let powers: Vec<f64> = all
            .iter()
            .flat_map(|one| one.riding().map(move |(window, speed)| (one, window, speed)))
            .filter(|(_, _, speed)| (low..high).contains(speed))
            .map(|(one, window, _)| one.spectrum(window, axis).power(OCTAVES_HZ[0], 0.5 / one.period_s))
            .collect();
        if let Some(power) = mean(&powers) {
            let what = format!("above {} Hz, {low} to {high} m/s", OCTAVES_HZ[0]);
            found.number(&what, Some(axis), found.unit(), root(power), powers.len() as f64 * WINDOW_S);
        }
        low = high;
    }
}

/// Vibration in an octave per 1 m/s.
fn octaves(all: &[Recorded], axis: usize, (octave, low_hz): (usize, f64), seconds: f64, found: &mut Found) {
    let white = found.white_power[axis];
    let high_hz = |one: &Recorded| (2.0 * low_hz).min(0.5 / one.period_s);
    if all.iter().all(|one| high_hz(one) <= low_hz) {
        return;
    }
    let of = |one: &Recorded| -> Vec<f64> {
        let high_hz = high_hz(one);
        // Hann's window leaks lines next to an end into the octave.
        let margin_hz = LEAK / WINDOW_S;
        let each = one.riding().map(|(window, speed)| {
            let density = one.spectrum(window, axis).mean(low_hz + margin_hz, high_hz - margin_hz);
            (high_hz - low_hz) * (density - white) / (speed * speed)
        });
        each.collect()
    };
    let Some(power) = pooled(&all.iter().map(of).collect::<Vec<_>>()) else { return };
    let what = format!("vibration from {low_hz} Hz for 1 m/s");
    found.number(&what, Some(axis), &format!("{}/(m/s)", found.unit()), root(power), seconds);
    found.numbers.vibration[axis][octave] = digits(power.value.max(0.0).sqrt());
}
