//! Finds the part of a recording with the motion after the disturbance.

use super::noise::period;

/// Fraction of the largest rate that marks the onset of the disturbance.
const ONSET: f64 = 0.5;
/// A recording that starts after the disturbance reaches that fraction within this time of its first sample
/// \[s\],
const CUT_S: f64 = 0.1;
/// and has at least this fraction at the first sample.
const CUT: f64 = 0.15;
/// A maximum counts if no larger value follows within this time \[s\].
const AHEAD_S: f64 = 0.1;
/// A longer time without samples ends the window \[s\].
const GAP_S: f64 = 0.1;

/// Longest window unless given \[s\].
const LONGEST_S: f64 = 20.0;

/// Start criterion of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Begins {
    /// At the largest rate of the disturbance.
    Knock,
    /// With the recording, which starts during the motion.
    Record,
    /// At the given time.
    Stated,
}

/// End criterion of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Ends {
    /// With the recording.
    Record,
    /// Where the weave falls below the noise.
    Noise,
    /// At a gap in the recording.
    Gap,
    /// After the longest time examined.
    Limit,
    /// At the given time.
    Stated,
}

/// Part of a recording, by indices of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first sample.
    pub from: usize,
    /// One after the last sample.
    pub to: usize,
    /// Start criterion.
    pub begins: Begins,
    /// End criterion.
    pub ends: Ends,
}

/// The window of a recording with times \[s\] and axes of rates \[rad/s\]; `stated` are its given ends \[s\].
///
/// The size of the motion is the square root of the sum of the axes' squares. The onset of the disturbance is
/// where the size first reaches half of its largest value; the window begins at the following maximum. If a
/// recording starts in motion and reaches that half within 0.1 s, it started after the disturbance and the
/// window begins with it.
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
    let stated_to = stated.1.map_or(times.len(), |to| times.partition_point(|t| *t <= to));
    let limit = if stated.1.is_some() { times.len() } else { times.partition_point(|t| *t <= longest) };
    let (mut to, mut ends) = (times.len(), Ends::Record);
    for (at, end) in
        [(gap.unwrap_or(times.len()), Ends::Gap), (limit, Ends::Limit), (stated_to, Ends::Stated)]
    {
        if at < to {
            (to, ends) = (at, end);
        }
    }
    Window { from, to, begins, ends }
}

fn knock(times: &[f64], sizes: &[f64]) -> (usize, Begins) {
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let mut at = sizes.iter().position(|size| *size >= ONSET * largest).unwrap_or(0);
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
