//! Delay of a sensor relative to another that measures the same motion.

use super::estimates::{digits, pooled};
use super::found::Found;
use super::windows::{Motion, Recorded, WINDOW_S};
use crate::plant::Sensor;
use crate::replay::Sample;
use crate::weave::Estimate;
use crate::weave::student::quantile;

/// Windows compared together.
const TOGETHER: usize = 4;
/// Largest delay tried \[s\].
const MOST_S: f64 = 0.2;
/// Averaging time of both signals before the comparison \[s\].
const SMOOTH_S: f64 = 0.1;
/// Smallest correlation from which a delay is taken.
const ALIKE: f64 = 0.9;
/// Smallest range of the time that a bicycle takes per metre over which the trail is identifiable \[s/m\].
const RANGE_S_M: f64 = 0.1;

pub(super) fn fit(all: &[Recorded], found: &mut Found) {
    match found.sensor {
        Sensor::SteerRate => steer_rate(all, found),
        Sensor::Steer => steer(all, found),
        Sensor::FrontWheel | Sensor::RearWheel => super::distance::fit(all, found),
        Sensor::Gyro => {
            found.left_out("lag: no recorded quantity is known to be earlier than the gyro".into())
        }
        _ => found.left_out("lag: no reference for this sensor was recorded".into()),
    }
}

/// Value interpolated between two samples; none outside.
pub(super) fn at(samples: &[Sample], t_s: f64, axis: usize) -> Option<f64> {
    let after = samples.partition_point(|sample| sample.t_s < t_s);
    let b = samples.get(after)?;
    if b.t_s == t_s {
        return Some(b.value[axis]);
    }
    let a = samples.get(after.checked_sub(1)?)?;
    let part = (t_s - a.t_s) / (b.t_s - a.t_s);
    Some(a.value[axis] + part * (b.value[axis] - a.value[axis]))
}

/// Stretches of riding, each of a few consecutive windows: the samples, and the mean speed \[m/s\].
fn stretches<'a>(one: &'a Recorded<'a>) -> impl Iterator<Item = (&'a [Sample], f64)> {
    one.windows.windows(TOGETHER).step_by(TOGETHER / 2).filter_map(|windows| {
        let follow = windows.windows(2).all(|two| two[0].to == two[1].from);
        let speeds: Option<Vec<f64>> = windows
            .iter()
            .map(|window| match window.motion {
                Motion::Riding(speed) => Some(speed),
                Motion::Standing => None,
            })
            .collect();
        let speed = speeds?.iter().sum::<f64>() / TOGETHER as f64;
        let samples = &one.track.samples[windows[0].from..windows[TOGETHER - 1].to];
        follow.then_some((samples, speed))
    })
}

/// Mean over [`SMOOTH_S`], twice: removes the steps of an encoder, common to both signals.
fn smooth(values: &[f64], period_s: f64) -> Vec<f64> {
    let length = ((SMOOTH_S / period_s).round() as usize).max(1);
    let mean =
        |values: &[f64]| values.windows(length).map(|w| w.iter().sum::<f64>() / length as f64).collect();
    let once: Vec<f64> = mean(values);
    mean(&once)
}

/// Delay of `later` relative to `earlier`, both sampled each `period_s`, from the maximum of their
/// correlation.
fn lag_s(later: &[f64], earlier: &[f64], period_s: f64) -> Option<f64> {
    let (later, earlier) = (&smooth(later, period_s), &smooth(earlier, period_s));
    let most = (MOST_S / period_s) as usize;
    let n = later.len().min(earlier.len()).checked_sub(2 * most).filter(|n| *n > 2 * most)?;
    let correlation = |shift: usize| {
        let (a, b) = (&later[shift..shift + n], &earlier[most..most + n]);
        let mean = |x: &[f64]| x.iter().sum::<f64>() / n as f64;
        let (ma, mb) = (mean(a), mean(b));
        let sums = a.iter().zip(b).fold([0.0; 3], |[ab, aa, bb], (x, y)| {
            let (x, y) = (x - ma, y - mb);
            [ab + x * y, aa + x * x, bb + y * y]
        });
        sums[0] / (sums[1] * sums[2]).sqrt()
    };
    let all: Vec<f64> = (0..=2 * most).map(correlation).collect();
    let best = (1..2 * most).filter(|i| all[*i].is_finite()).max_by(|a, b| all[*a].total_cmp(&all[*b]))?;
    let (before, top, after) = (all[best - 1], all[best], all[best + 1]);
    let bend = before - 2.0 * top + after;
    let inside = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
    (top > ALIKE).then_some((best as f64 - most as f64 + inside) * period_s)
}

/// Delay of the steer rate relative to the change of the steer angle.
fn steer_rate(all: &[Recorded], found: &mut Found) {
    let lags = |one: &Recorded| -> Vec<f64> {
        let Some(angle) = one.recording.samples.track(Sensor::Steer) else { return Vec::new() };
        let each = stretches(one).filter_map(|(samples, _)| {
            let rate = |sample: &Sample| {
                let h = one.period_s;
                let [before, after] = [-h, h].map(|h| at(&angle.samples, sample.t_s + h, 0));
                Some((after? - before?) / (2.0 * h))
            };
            let change: Vec<f64> = samples.iter().map(rate).collect::<Option<_>>()?;
            let rates: Vec<f64> = samples.iter().map(|sample| sample.value[0]).collect();
            lag_s(&rates, &change, one.period_s)
        });
        each.collect()
    };
    let each: Vec<Vec<f64>> = all.iter().map(lags).collect();
    let seconds = each.iter().flatten().count() as f64 * WINDOW_S * TOGETHER as f64;
    let Some(lag) = pooled(&each) else {
        return found.left_out("lag: no changing steer angle was recorded beside the rate".into());
    };
    found.number("later than the change of the steer angle", None, "s", lag, seconds);
    take(lag, found);
}

/// Uses a significant delay as the model's.
fn take(lag: Estimate, found: &mut Found) {
    if lag.low > 0.0 {
        found.numbers.delay_s = Some(digits(lag.value));
    } else if lag.high > 0.0 {
        found.left_out(format!("lag: not distinguishable from zero; at most {} s", digits(lag.high)));
    } else {
        found.left_out("lag: not later than its reference".into());
    }
}

/// Delay of the steer angle relative to the yaw rate. The yaw rate leads speed times steer angle by trail
/// over speed. The two are separated only over different speeds: the delay is the part that does not depend
/// on speed.
fn steer(all: &[Recorded], found: &mut Found) {
    let lags = |one: &Recorded| -> Vec<(f64, f64)> {
        let samples = &one.recording.samples;
        let wheel = samples.track(Sensor::RearWheel).or_else(|| samples.track(Sensor::FrontWheel));
        let (Some(gyro), Some(wheel)) = (samples.track(Sensor::Gyro), wheel) else { return Vec::new() };
        let each = stretches(one).filter_map(|(samples, speed)| {
            let turning = |sample: &Sample| Some(at(&wheel.samples, sample.t_s, 0)? * sample.value[0]);
            let turning: Vec<f64> = samples.iter().map(turning).collect::<Option<_>>()?;
            let yaw = samples.iter().map(|sample| at(&gyro.samples, sample.t_s, 2));
            let yaw: Vec<f64> = yaw.collect::<Option<_>>()?;
            Some((1.0 / speed, lag_s(&yaw, &turning, one.period_s)?))
        });
        each.collect()
    };
    let points: Vec<(f64, f64)> = all.iter().flat_map(lags).collect();
    let least = points.iter().map(|(x, _)| *x).fold(f64::INFINITY, f64::min);
    let most = points.iter().map(|(x, _)| *x).fold(0.0, f64::max);
    if points.len() < 8 || most - least < RANGE_S_M {
        let what = "lag: the yaw rate leads by trail over speed, and the speeds differ too little to separate the two";
        return found.left_out(what.into());
    }
    let (intercept, slope) = line(&points);
    let seconds = points.len() as f64 * WINDOW_S * TOGETHER as f64;
    let lag = Estimate { value: -intercept.value, low: -intercept.high, high: -intercept.low, ..intercept };
    let trail = Estimate { value: -slope.value, low: -slope.high, high: -slope.low, ..slope };
    found.number("later than the yaw rate", None, "s", lag, seconds);
    found.number("trail by which the yaw rate leads", None, "m", trail, seconds);
    take(lag, found);
}

/// Straight line through points: intercept and slope. Neighbouring stretches overlap by half.
fn line(points: &[(f64, f64)]) -> (Estimate, Estimate) {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / n, sy + y / n));
    let across: f64 = points.iter().map(|(a, _)| (a - x).powi(2)).sum();
    let slope = points.iter().map(|(a, b)| (a - x) * (b - y)).sum::<f64>() / across;
    let intercept = y - slope * x;
    let rest: f64 = points.iter().map(|(a, b)| (b - intercept - slope * a).powi(2)).sum();
    let freedom = (0.5 * n - 2.0).max(1.0);
    let square = rest / (n - 2.0) * (n / (0.5 * n));
    let t = quantile(freedom);
    let error = (square * (1.0 / n + x * x / across)).sqrt();
    (Estimate::new(intercept, error, t), Estimate::new(slope, (square / across).sqrt(), t))
}
