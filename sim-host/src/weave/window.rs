//! Which part of a recording is the motion after the knock.

use super::noise::period;

/// The part of the largest rate at which the knock is seen.
const SEEN: f64 = 0.5;
/// A recording that was cut after the knock has that part within so long after its first sample \[s\],
const CUT_S: f64 = 0.1;
/// and at least this part at the first sample.
const CUT: f64 = 0.15;
/// Within this time after a maximum there is no larger one \[s\].
const AHEAD_S: f64 = 0.1;
/// A longer time without a sample ends the window \[s\].
const GAP_S: f64 = 0.1;

/// No longer window is looked at unless that is told \[s\].
const LONGEST_S: f64 = 20.0;

/// Why a window begins where it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Begins {
    /// At the largest rate of the knock.
    Knock,
    /// With the recording, which begins inside the motion.
    Record,
    /// Where it was told to.
    Stated,
}

/// Why a window ends where it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Ends {
    /// With the recording.
    Record,
    /// Where the weave is smaller than the noise.
    Noise,
    /// At a gap in the recording.
    Gap,
    /// After the longest time that is looked at.
    Limit,
    /// Where it was told to.
    Stated,
}

/// A part of a recording, by the places of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first sample.
    pub from: usize,
    /// One beyond the last.
    pub to: usize,
    /// Why it begins there.
    pub begins: Begins,
    /// Why it ends there.
    pub ends: Ends,
}

/// The window of a recording with stamps \[s\] and axes of rates \[rad/s\]; `stated` are its ends, if someone did \[s\].
///
/// The size of the motion is the root of the sum of the axes' squares. The knock is seen where it first reaches half of the
/// largest, and the window begins at the maximum that follows. A recording that begins in motion and has that much within 0.1 s
/// was cut after the knock: its window begins with it.
pub fn window(times: &[f64], axes: &[&[f64]], stated: (Option<f64>, Option<f64>)) -> Window {
    let size = |i: usize| axes.iter().map(|axis| axis[i] * axis[i]).sum::<f64>().sqrt();
    let sizes: Vec<f64> = (0..times.len()).map(size).collect();
    let (from, begins) = match stated.0 {
        Some(from) => (times.partition_point(|t| *t < from), Begins::Stated),
        None => knock(times, &sizes),
    };
    let gap = GAP_S.max(5.0 * period(times));
    let gap = (from + 1..times.len()).find(|i| times[*i] - times[i - 1] > gap);
    let longest = times.get(from).map_or(f64::INFINITY, |t| t + LONGEST_S);
    let told_to = stated.1.map_or(times.len(), |to| times.partition_point(|t| *t <= to));
    let limit = if stated.1.is_some() { times.len() } else { times.partition_point(|t| *t <= longest) };
    let (mut to, mut ends) = (times.len(), Ends::Record);
    for (at, end) in [(gap.unwrap_or(times.len()), Ends::Gap), (limit, Ends::Limit), (told_to, Ends::Stated)]
    {
        if at < to {
            (to, ends) = (at, end);
        }
    }
    Window { from, to, begins, ends }
}

fn knock(times: &[f64], sizes: &[f64]) -> (usize, Begins) {
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let mut at = sizes.iter().position(|size| *size >= SEEN * largest).unwrap_or(0);
    if at == 0 || (times[at] - times[0] <= CUT_S && sizes[0] >= CUT * largest) {
        return (0, Begins::Record);
    }
    loop {
        let ahead = at..times.partition_point(|t| *t <= times[at] + AHEAD_S);
        match ahead.max_by(|a, b| sizes[*a].total_cmp(&sizes[*b])).filter(|next| sizes[*next] > sizes[at]) {
            Some(next) => at = next,
            None => return (at, Begins::Knock),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(n: usize) -> Vec<f64> {
        (0..n).map(|i| 0.01 * i as f64).collect()
    }

    #[test]
    fn it_begins_at_the_first_large_maximum() {
        let t = times(300);
        let rates: Vec<f64> = t
            .iter()
            .map(|t| if *t < 1.0 { 0.01 } else { libm::sin(7.0 * (t - 1.0)) * libm::exp(0.3 * (1.0 - t)) })
            .collect();
        let found = window(&t, &[&rates], (None, None));
        assert!((120..=126).contains(&found.from) && found.begins == Begins::Knock, "{found:?}");
        assert_eq!((found.to, found.ends), (300, Ends::Record));
        let cut = window(&t[122..], &[&rates[122..]], (None, None));
        assert_eq!((cut.from, cut.begins), (0, Begins::Record));
        let stated = window(&t, &[&rates], (Some(0.5), Some(2.0)));
        assert_eq!(
            (stated.from, stated.to, stated.begins, stated.ends),
            (50, 201, Begins::Stated, Ends::Stated)
        );
    }

    #[test]
    fn a_gap_ends_it() {
        let mut t = times(100);
        t[60..].iter_mut().for_each(|t| *t += 0.2);
        let found = window(&t, &[&[1.0; 100]], (None, None));
        assert_eq!((found.from, found.to, found.ends), (0, 60, Ends::Gap));
    }
}
