//! Quantisation step of a sensor's values, and repetition of samples.

use super::estimates::{digits, observed, share};
use super::found::Found;
use super::windows::{Motion, Recorded};
use crate::weave::Estimate;

/// Largest deviation from whole steps, as a fraction of a step; beyond, the differences have no common step.
const WORST_FIT: f64 = 0.12;
/// Differences of more steps than this are not used.
const MOST_STEPS: f64 = 50.0;
/// Range of the search for the step, as divisors of the usual smallest difference.
const DIVISORS: u32 = 24;
/// If all axes repeat for longer, the sensor sleeps \[s\].
const SLEEP_S: f64 = 1.0;

pub(super) fn fit(all: &[Recorded], found: &mut Found) {
    let seconds: f64 = all.iter().map(|one| one.track.samples.len() as f64 * one.period_s).sum();
    for axis in 0..found.axes() {
        if all.iter().all(|one| one.track.made_up[axis]) {
            continue;
        }
        let differences: Vec<f64> = all
            .iter()
            .flat_map(|one| {
                one.track.samples.windows(2).map(|two| (two[1].value[axis] - two[0].value[axis]).abs())
            })
            .filter(|difference| *difference > 1e-9)
            .collect();
        match step(differences) {
            Some(step) => {
                found.number("step between values", Some(axis), found.unit(), step, seconds);
                found.numbers.quantum.resize(found.axes(), 0.0);
                found.numbers.quantum[axis] = digits(step.value);
            }
            None => {
                let axis =
                    found.sensor.axes().get(axis).map_or(String::new(), |name| format!(" of axis {name}"));
                found.left_out(format!("step: the values{axis} have no common step"));
            }
        }
    }
    for (name, riding) in [("standing", false), ("riding", true)] {
        repeats(all, found, name, riding);
    }
}

/// The largest step of which nearly all small differences are whole multiples.
fn step(mut differences: Vec<f64>) -> Option<Estimate> {
    differences.sort_by(f64::total_cmp);
    let least = *differences.get(differences.len() / 200)?;
    (1..=DIVISORS).find_map(|divisor| whole_steps(&differences, least / f64::from(divisor)))
}

/// The step near `guess` by least squares, if the small differences fit it.
fn whole_steps(differences: &[f64], guess: f64) -> Option<Estimate> {
    let mut step = guess;
    let few = differences.iter().filter(|d| **d < MOST_STEPS * guess);
    let few: Vec<f64> = few.copied().collect();
    let mut error = f64::INFINITY;
    // Small differences first: the larger a difference, the more exactly the step must be known to count it.
    for most in [3.0, 10.0, MOST_STEPS] {
        let counted = few.iter().filter(|d| **d < (most + 0.5) * step).map(|d| (*d, (*d / step).round()));
        let counted: Vec<(f64, f64)> = counted.collect();
        let squares: f64 = counted.iter().map(|(_, n)| n * n).sum();
        if squares == 0.0 {
            return None;
        }
        let next = counted.iter().map(|(d, n)| d * n).sum::<f64>() / squares;
        let rest: f64 = counted.iter().map(|(d, n)| (d - n * next).powi(2)).sum();
        let rms = (rest / counted.len() as f64).sqrt();
        if rms > WORST_FIT * next {
            return None;
        }
        (step, error) = (next, rms / squares.sqrt());
    }
    Some(Estimate::new(step, error, 1.96))
}

/// Share and longest duration of repeated samples of all axes.
fn repeats(all: &[Recorded], found: &mut Found, name: &str, riding: bool) {
    let axes = found.axes();
    let (mut pairs, mut same, mut each) = (0_usize, 0_usize, [0_usize; 3]);
    let (mut longest, mut seconds) = (0.0_f64, 0.0);
    for one in all {
        let mut run_s = 0.0;
        for window in &one.windows {
            if matches!(window.motion, Motion::Riding(_)) != riding {
                run_s = 0.0;
                continue;
            }
            let end = (window.to + 1).min(one.track.samples.len());
            seconds += (window.to - window.from) as f64 * one.period_s;
            for two in one.track.samples[window.from..end].windows(2) {
                let equal: Vec<bool> =
                    (0..axes).map(|axis| two[0].value[axis] == two[1].value[axis]).collect();
                equal.iter().zip(&mut each).for_each(|(equal, count)| *count += usize::from(*equal));
                pairs += 1;
                if equal.iter().all(|equal| *equal) {
                    same += 1;
                    run_s += two[1].t_s - two[0].t_s;
                    longest = longest.max(run_s);
                } else {
                    run_s = 0.0;
                }
            }
        }
    }
    if pairs == 0 {
        return found.left_out(format!("repeats, {name}: less than one second"));
    }
    let all_axes = share(same, pairs);
    found.number(&format!("share of samples that repeat, {name}"), None, "1", all_axes, seconds);
    found.number(&format!("longest time without a new value, {name}"), None, "s", observed(longest), seconds);
    if !riding {
        if axes == 3 && longest > SLEEP_S {
            let what = "sleep: at standstill the sensor repeats a sample for seconds, which is not modelled";
            found.left_out(what.into());
        }
        return;
    }
    if axes < 3 {
        let error = "repeat: a repeated value of a single axis is a signal between two steps";
        return found.left_out(error.into());
    }
    // Axes also repeat together by chance.
    let chance: f64 = each[..axes].iter().map(|count| *count as f64 / pairs as f64).product();
    if same > 0 && all_axes.low > chance {
        found.numbers.repeat = Some(digits(all_axes.value - chance));
    } else {
        found.left_out("repeat: all axes together repeat no more often than by chance".into());
    }
}
