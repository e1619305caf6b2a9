//! Sampling of a sensor: period, jitter and phase relative to the gyro.

use super::estimates::{digits, observed, part_of};
use super::found::Found;
use super::windows::Recorded;
use crate::plant::Sensor;
use crate::replay::Sample;
use std::f64::consts::TAU;

/// Length of a block in which drift between sensor and log clock is negligible \[s\].
const BLOCK_S: f64 = 10.0;

/// Samples before and after a gap that tell a late sample, after which the others catch up, from lost ones.
const AROUND: usize = 10;

pub(super) fn fit(all: &[Recorded], found: &mut Found) {
    let seconds: f64 = all.iter().map(span_s).sum();
    let mut gaps: Vec<f64> =
        all.iter().flat_map(|one| one.track.samples.windows(2).map(|two| two[1].t_s - two[0].t_s)).collect();
    gaps.sort_by(f64::total_cmp);
    let period = part_of(&gaps, 0.5);
    found.number("period, median", None, "s", period, seconds);
    found.number("period, 99 in 100 at most", None, "s", part_of(&gaps, 0.99), seconds);
    found.number("period, longest seen", None, "s", observed(gaps[gaps.len() - 1]), seconds);
    found.numbers.period_s = Some(digits(period.value));
    let mut late: Vec<f64> = all.iter().flat_map(lateness).collect();
    late.sort_by(f64::total_cmp);
    if late.is_empty() {
        found.left_out(format!("jitter: no {BLOCK_S} s without a gap"));
    } else {
        let (most, worst) = (part_of(&late, 0.99), late[late.len() - 1]);
        found.number("lateness, 99 in 100 at most", None, "s", most, seconds);
        found.number("lateness, worst seen", None, "s", observed(worst), seconds);
        found.numbers.jitter_s = Some([digits(most.value), digits(worst)]);
    }
    phase(all, found, period.value);
}

fn span_s(one: &Recorded) -> f64 {
    let samples = &one.track.samples;
    samples[samples.len() - 1].t_s - samples[0].t_s
}

/// Delay of each sample in a block relative to evenly spaced samples, from the earliest \[s\].
fn lateness(one: &Recorded) -> Vec<f64> {
    let length = (BLOCK_S / one.period_s).round() as usize;
    let late = |(block, places): (&[Sample], &[f64])| {
        let times: Vec<f64> = block.iter().map(|sample| sample.t_s - block[0].t_s).collect();
        let n = times.len() as f64;
        let mean = |x: &[f64]| x.iter().sum::<f64>() / n;
        let (t, p) = (mean(&times), mean(places));
        let along: f64 = times.iter().zip(places).map(|(x, y)| (x - t) * (y - p)).sum();
        let slope = along / places.iter().map(|y| (y - p).powi(2)).sum::<f64>();
        let off: Vec<f64> = times.iter().zip(places).map(|(x, y)| x - t - slope * (y - p)).collect();
        let earliest = off.iter().copied().fold(f64::INFINITY, f64::min);
        off.into_iter().map(move |x| x - earliest).collect::<Vec<_>>()
    };
    let (samples, length, places) = (&one.track.samples, length.max(3), places(one));
    samples.chunks_exact(length).zip(places.chunks_exact(length)).flat_map(late).collect()
}

/// Number of each sample, counted from the first, with those that were lost. Samples are lost where the earliest of
/// the next [`AROUND`] samples is at least half a period behind the earliest of the last [`AROUND`].
fn places(one: &Recorded) -> Vec<f64> {
    let periods: Vec<f64> = one.track.samples.iter().map(|sample| sample.t_s / one.period_s).collect();
    let earliest = |delays: &mut dyn Iterator<Item = f64>| delays.fold(f64::INFINITY, f64::min);
    let mut places: Vec<f64> = Vec::with_capacity(periods.len());
    for at in 0..periods.len() {
        let next = places.last().map_or(0.0, |place| place + 1.0);
        let last = at.saturating_sub(AROUND)..at;
        let before =
            earliest(&mut periods[last.clone()].iter().zip(&places[last]).map(|(t, place)| t - place));
        let after = periods[at..].iter().take(AROUND).enumerate();
        let after = earliest(&mut after.map(|(more, t)| t - next - more as f64));
        let lost = if at == 0 { 0.0 } else { (after - before).round().max(0.0) };
        places.push(next + lost);
    }
    places
}

/// Phase: delay relative to the gyro's sample, within a period.
fn phase(all: &[Recorded], found: &mut Found, period_s: f64) {
    if found.sensor == Sensor::Gyro {
        return;
    }
    let mut angles = Vec::new();
    for one in all {
        let Some(gyro) = one.recording.samples.track(Sensor::Gyro) else { continue };
        let alike = gyro.period_s().is_some_and(|other| (other / period_s - 1.0).abs() < 0.01);
        if !alike {
            return found.left_out("phase: the gyro has another period".into());
        }
        for sample in &one.track.samples {
            let after = gyro.samples.partition_point(|other| other.t_s <= sample.t_s + 1e-9);
            let before = after.checked_sub(1).map(|i| sample.t_s - gyro.samples[i].t_s);
            angles.extend(before.filter(|s| *s < 1.5 * period_s).map(|s| TAU * s / period_s));
        }
    }
    let (sin, cos) = angles.iter().fold((0.0, 0.0), |(s, c), a| (s + libm::sin(*a), c + libm::cos(*a)));
    let turns = (libm::atan2(sin, cos) / TAU).rem_euclid(1.0);
    let phase_s = if turns > 0.999 { 0.0 } else { turns * period_s };
    let apart = |a: &f64| ((a / TAU - turns + 0.5).rem_euclid(1.0) - 0.5).abs() * period_s;
    let mut off: Vec<f64> = angles.iter().map(apart).collect();
    off.sort_by(f64::total_cmp);
    let Some(most) = off.get(off.len() * 99 / 100) else { return };
    let spread = crate::weave::Estimate::new(phase_s, *most, 1.0);
    found.number(
        "later than the gyro's sample, 99 in 100 between",
        None,
        "s",
        spread,
        angles.len() as f64 * period_s,
    );
    if phase_s > 0.0 {
        found.numbers.phase_s = Some(digits(phase_s));
    }
}
