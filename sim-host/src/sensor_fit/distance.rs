//! Averaging time and delay of a wheel's speed, from the distance that the same wheel counted.

use super::estimates::{digits, pooled};
use super::found::Found;
use super::windows::Recorded;

/// Length of a stretch that is fitted separately \[s\].
const STRETCH_S: f64 = 10.0;
/// Smallest change of speed in a usable stretch \[m/s\].
const CHANGE_M_S: f64 = 0.1;
/// Longest averaging time tried \[s\].
const LONGEST_S: f64 = 8.0;
/// A larger decrease of the distance within one sample is a reset \[m\].
const SET_ANEW_M: f64 = 0.05;
/// Largest residual of the best mean, relative to the change of speed; beyond, the speed belongs to another
/// wheel.
const WORST_FIT: f64 = 0.3;

/// Best fit of a stretch: averaging time, delay \[s\] and scale.
struct Fit {
    window_s: f64,
    delay_s: f64,
    scale: f64,
}

pub(super) fn fit(all: &[Recorded], found: &mut Found) {
    if all.iter().all(|one| one.recording.distance_m.is_empty()) {
        let what = "lag and mean: no reference for the speed was recorded; the wheel's distance would be one (--distance)";
        return found.left_out(what.into());
    }
    let each: Vec<Vec<Fit>> = all.iter().map(stretches).collect();
    let of = |value: fn(&Fit) -> f64| -> Vec<Vec<f64>> {
        each.iter().map(|fits| fits.iter().map(value).collect()).collect()
    };
    let seconds = each.iter().flatten().count() as f64 * STRETCH_S;
    let numbers =
        (pooled(&of(|fit| fit.window_s)), pooled(&of(|fit| fit.delay_s)), pooled(&of(|fit| fit.scale)));
    let (Some(window), Some(delay), Some(scale)) = numbers else {
        return found.left_out("lag and mean: the speed changes in too few stretches of 10 s".into());
    };
    found.number("mean over", None, "s", window, seconds);
    found.number("delay beside the way", None, "s", delay, seconds);
    found.number("scale beside the way", None, "1", scale, seconds);
    found.numbers.window_s = Some(digits(window.value));
    if delay.low > 0.0 {
        found.numbers.delay_s = Some(digits(delay.value));
    }
}

fn stretches(one: &Recorded) -> Vec<Fit> {
    let distance_m = &one.recording.distance_m;
    let length = (STRETCH_S / one.period_s).round() as usize;
    let fit = |samples: &[crate::replay::Sample]| {
        let (from, to) = (samples[0].t_s - LONGEST_S - 1.0, samples[samples.len() - 1].t_s);
        let first = distance_m.partition_point(|(t, _)| *t < from);
        let last = distance_m.partition_point(|(t, _)| *t <= to);
        let distance_m = &distance_m[first..last];
        let whole = distance_m.first().is_some_and(|(t, _)| *t < from + 0.1);
        let set_anew = distance_m.windows(2).any(|two| two[1].1 < two[0].1 - SET_ANEW_M);
        let points: Vec<(f64, f64)> = samples.iter().map(|sample| (sample.t_s, sample.value[0])).collect();
        if !whole || set_anew { None } else { best(&points, distance_m, one.period_s) }
    };
    one.track.samples.chunks_exact(length).filter_map(fit).collect()
}

/// Least-squares averaging time and delay, on successively finer grids.
fn best(points: &[(f64, f64)], distance_m: &[(f64, f64)], period_s: f64) -> Option<Fit> {
    let n = points.len() as f64;
    let mean = points.iter().map(|(_, v)| v).sum::<f64>() / n;
    let change: f64 = points.iter().map(|(_, v)| (v - mean).powi(2)).sum();
    if (change / n).sqrt() < CHANGE_M_S {
        return None;
    }
    let evaluated = |window_s: f64, delay_s: f64| {
        let mean = |t: f64| {
            let later = at(distance_m, t - delay_s);
            (later - at(distance_m, t - delay_s - window_s)) / window_s
        };
        let sums = points.iter().step_by(5).fold([0.0; 3], |[vm, mm, vv], (t, v)| {
            let m = mean(*t);
            [vm + v * m, mm + m * m, vv + v * v]
        });
        let scale = sums[0] / sums[1];
        (sums[2] - scale * sums[0], scale)
    };
    let (mut centre, mut reach) = ((0.5 * LONGEST_S, 0.5), (0.5 * LONGEST_S, 0.5));
    for _ in 0..5 {
        let grid = (-8..=8).flat_map(|i| (-5..=5).map(move |j| (f64::from(i) / 8.0, f64::from(j) / 5.0)));
        let tried = grid.map(|(i, j)| {
            let window_s = (centre.0 + i * reach.0).clamp(period_s, LONGEST_S);
            let delay_s = (centre.1 + j * reach.1).clamp(0.0, 1.0);
            (evaluated(window_s, delay_s).0, (window_s, delay_s))
        });
        centre = tried.min_by(|a, b| a.0.total_cmp(&b.0))?.1;
        reach = (reach.0 / 4.0, reach.1 / 3.0);
    }
    let (rest, scale) = evaluated(centre.0, centre.1);
    let fits = 5.0 * rest < WORST_FIT * WORST_FIT * change;
    fits.then_some(Fit { window_s: centre.0, delay_s: centre.1, scale })
}

/// Distance at a time, interpolated between two counts \[m\].
fn at(distance_m: &[(f64, f64)], t_s: f64) -> f64 {
    let after = distance_m.partition_point(|(t, _)| *t < t_s).clamp(1, distance_m.len() - 1);
    let ((t0, a), (t1, b)) = (distance_m[after - 1], distance_m[after]);
    a + ((t_s - t0) / (t1 - t0)).clamp(0.0, 1.0) * (b - a)
}
