//! Noise of a sensor at standstill: white noise, bias, and random walk of the bias.

use super::estimates::{digits, pooled, root};
use super::found::Found;
use super::windows::{Recorded, WINDOW_S, Window, still};
use crate::plant::Sensor;
use crate::weave::Estimate;
use crate::weave::student::quantile;

/// Frequency range of the white noise as fractions of the sample rate: above motion, below aliasing.
const WHITE: (f64, f64) = (0.25, 0.48);
/// Smallest number of changes of the bias from which its walk is taken.
const FEW: usize = 6;
/// Smallest time between two seconds at standstill whose means are compared \[s\].
const APART_S: f64 = 8.0;

pub(super) fn fit(all: &[Recorded], found: &mut Found) {
    let moved = [Sensor::Steer, Sensor::SteerRate, Sensor::FrontWheel, Sensor::RearWheel];
    if moved.contains(&found.sensor) {
        let what = "noise, bias and walk: a change at standstill is a moved fork or wheel";
        return found.left_out(what.into());
    }
    let axes = found.axes();
    let quiet = still(all, axes);
    let seconds = quiet.iter().flatten().count() as f64 * WINDOW_S;
    if seconds < 3.0 {
        let what = "noise, bias and walk: no standstill of 3 s with a changing value";
        found.left_out(what.into());
        return;
    }
    for axis in (0..axes).filter(|axis| all.iter().any(|one| !one.track.made_up[*axis])) {
        white(all, &quiet, axis, seconds, found);
    }
    if found.sensor == Sensor::Gyro {
        bias(all, &quiet, found);
        walk(all, &quiet, found);
    } else {
        let what = "bias and walk: the true value at standstill is unknown";
        found.left_out(what.into());
    }
}

/// Density of the white noise, at standstill and riding.
fn white(all: &[Recorded], quiet: &[Vec<&Window>], axis: usize, seconds: f64, found: &mut Found) {
    let of = |one: &Recorded, window: &Window| {
        let rate_hz = 1.0 / one.period_s;
        one.spectrum(window, axis).mean(WHITE.0 * rate_hz, WHITE.1 * rate_hz)
    };
    let standing: Vec<Vec<f64>> =
        all.iter().zip(quiet).map(|(one, windows)| windows.iter().map(|w| of(one, w)).collect()).collect();
    let unit = format!("{}/Hz^0.5", found.unit());
    let Some(power) = pooled(&standing) else { return };
    found.number("white noise, standing", Some(axis), &unit, root(power), seconds);
    found.white_power[axis] = power.value;
    // Quantisation adds its own noise to the simulated noise.
    let step = found.numbers.quantum.get(axis).copied().unwrap_or_default();
    let of_step = step * step * all[0].period_s / 6.0;
    found.numbers.white_density.resize(found.axes(), 0.0);
    found.numbers.white_density[axis] = digits((power.value - of_step).max(0.0).sqrt());
    let riding: Vec<Vec<f64>> =
        all.iter().map(|one| one.riding().map(|(w, _)| of(one, w)).collect()).collect();
    if let Some(power) = pooled(&riding) {
        let seconds = riding.iter().flatten().count() as f64 * WINDOW_S;
        found.number("white noise with vibration, riding", Some(axis), &unit, root(power), seconds);
    }
}

/// Bias of each recording, and its spread between them.
fn bias(all: &[Recorded], quiet: &[Vec<&Window>], found: &mut Found) {
    for axis in 0..found.axes() {
        let mean_of = |(one, windows): (&Recorded, &Vec<&Window>)| {
            let means: Vec<f64> = windows.iter().map(|window| mean(&one.values(window, axis))).collect();
            (means.len() >= 3).then(|| (mean(&means), means.len()))
        };
        let biases: Vec<(f64, usize)> = all.iter().zip(quiet).filter_map(mean_of).collect();
        if biases.is_empty() {
            return found.left_out("bias: no recording with 3 s of standstill".into());
        }
        let seconds = biases.iter().map(|(_, n)| *n as f64).sum::<f64>() * WINDOW_S;
        let square = mean(&biases.iter().map(|(bias, _)| bias * bias).collect::<Vec<_>>());
        let spread = root(variance(square, biases.len() as f64));
        let what = format!("bias, root mean square of {} recordings", biases.len());
        found.number(&what, Some(axis), found.unit(), spread, seconds);
        found.numbers.bias_spread.push(digits(spread.value));
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Random walk of the bias: increase of the difference between seconds at standstill with their distance in
/// time. All axes belong to one chip, so an axis with much more walk than the others shows motion of a person
/// who holds the bicycle.
fn walk(all: &[Recorded], quiet: &[Vec<&Window>], found: &mut Found) {
    let unit = format!("{}/s^0.5", found.unit());
    let mut axes = Vec::new();
    for axis in 0..found.axes() {
        let changes: Vec<(f64, f64)> =
            all.iter().zip(quiet).flat_map(|(one, windows)| changes(one, windows, axis)).collect();
        if changes.len() < FEW {
            let what = format!("walk: fewer than {FEW} pairs of seconds of standstill {APART_S} s apart");
            return found.left_out(what);
        }
        let (squares, apart_s) =
            changes.iter().fold((0.0, 0.0), |(d, t), (change, s)| (d + change * change, t + s));
        let n = changes.len() as f64;
        let square = variance(squares / n, n);
        let walk = |x: f64| (x - found.white_power[axis] / WINDOW_S) * n / apart_s;
        let power = Estimate {
            value: walk(square.value),
            standard_error: square.standard_error * n / apart_s,
            low: walk(square.low),
            high: walk(square.high),
        };
        found.number("walk of the bias", Some(axis), &unit, root(power), apart_s);
        axes.push(power);
    }
    for (axis, power) in axes.iter().enumerate() {
        let name = found.sensor.axes()[axis];
        let others = axes.iter().enumerate().filter(|(other, _)| *other != axis);
        if power.low <= 0.0 {
            found.left_out(format!("walk, axis {name}: not distinguishable from the white noise"));
        } else if others.into_iter().all(|(_, other)| other.high < power.low) {
            found.left_out(format!(
                "walk, axis {name}: larger than on the other axes: the bicycle is held and sways"
            ));
        } else {
            found.numbers.walk.resize(found.axes(), 0.0);
            found.numbers.walk[axis] = digits(power.value.sqrt());
        }
    }
}

/// Changes of the mean from one still window to the next that is far enough away, and the time between them
/// \[s\].
fn changes(one: &Recorded, windows: &[&Window], axis: usize) -> Vec<(f64, f64)> {
    let mut changes = Vec::new();
    let mut last: Option<&Window> = None;
    for window in windows {
        let time = |window: &Window| one.track.samples[window.from].t_s;
        match last {
            Some(before) if time(window) - time(before) < APART_S => {}
            Some(before) => {
                let change = mean(&one.values(window, axis)) - mean(&one.values(before, axis));
                changes.push((change, time(window) - time(before)));
                last = Some(window);
            }
            None => last = Some(window),
        }
    }
    changes
}

/// Variance with its interval by the chi-square distribution, with quantiles by Wilson and Hilferty.
fn variance(value: f64, freedom: f64) -> Estimate {
    let point = |z: f64| {
        freedom * (1.0 - 2.0 / (9.0 * freedom) + z * (2.0 / (9.0 * freedom)).sqrt()).max(0.05).powi(3)
    };
    let z = quantile(1e9);
    Estimate {
        value,
        standard_error: value * (2.0 / freedom).sqrt(),
        low: value * freedom / point(z),
        high: value * freedom / point(-z),
    }
}
