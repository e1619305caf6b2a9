//! The torque as a function of the signals of one instant, some samples earlier:
//!
//! ```text
//! torque(t) = sum over signals of (gain + gain per speed * (speed - mean speed)) * signal(t - lag) + offset
//! ```
//!
//! In a closed loop the signals follow each other, so that some gains have no meaning on their own; `collinear` names
//! those signals.

use super::Part;
use super::checked::{Checked, FEWEST, SHORTEST_S};
use super::collinear::{Inseparable, separable};
use super::record::{Record, Signal};
use super::regress::{Fit, Weights, regress};
use crate::weave::Estimate;
use nalgebra::{DMatrix, DVector};

/// Longest lag of the search \[s\].
const LONGEST_LAG_S: f64 = 0.1;
/// Time over which residuals are correlated \[s\].
const MEMORY_S: f64 = 1.0;
/// A signal must have values in this part of the samples.
const RECORDED: f64 = 0.5;
/// Width of a speed band \[m/s\], and its shortest part \[s\].
const BAND: (f64, f64) = (1.0, 10.0);
/// A contribution below this part of the torque's standard deviation is none.
const LEAST_CONTRIBUTION: f64 = 0.02;

/// The gain from a signal to the torque; unit by [`Signal::gain_unit`].
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Gain {
    /// The signal.
    pub signal: Signal,
    /// Gain at the mean speed.
    pub gain: Estimate,
    /// Change of the gain with the speed \[gain unit s/m\]; null if it can't be identified.
    pub per_speed: Option<Estimate>,
    /// Standard deviation of the signal's part of the torque over that of the torque.
    pub contribution: f64,
    /// Whether it acts: the interval excludes zero, and the contribution is 2 % or more.
    pub acts: bool,
}

/// A gain that cannot be identified.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Refused {
    /// The signal.
    pub signal: Signal,
    /// Whether only the change of its gain with the speed is meant.
    pub per_speed: bool,
    /// The reason.
    pub why: String,
}

/// The law in a range of speeds.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Band {
    /// Lower end \[m/s\].
    pub from_m_s: f64,
    /// Upper end \[m/s\].
    pub to_m_s: f64,
    /// Mean speed \[m/s\].
    pub speed_m_s: f64,
    /// Duration of the samples \[s\].
    pub seconds: f64,
    /// The gains.
    pub gains: Vec<Gain>,
    /// Explained fraction of the variance of the samples that follow.
    pub vaf_followed: f64,
    /// Fraction of the samples that follow.
    pub followed: f64,
}

/// The law.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Law {
    /// Mean speed \[m/s\].
    pub speed_m_s: f64,
    /// From the signals to the torque \[s\].
    pub lag_s: f64,
    /// The gains.
    pub gains: Vec<Gain>,
    /// Torque without any signal \[N m\].
    pub offset_nm: Estimate,
    /// Gains that cannot be identified.
    pub refused: Vec<Refused>,
    /// Speed at which the gain of the roll rate vanishes, by its change with the speed \[m/s\].
    pub vanishes_m_s: Option<Estimate>,
    /// Explained fraction of the variance of the torque.
    pub vaf: f64,
    /// Explained fraction of the variance of the samples that follow.
    pub vaf_followed: f64,
    /// Fraction of the samples that follow; the others have another rule or another input.
    pub followed: f64,
    /// Duration of the samples used \[s\].
    pub seconds: f64,
    /// The law in ranges of the speed, if more than one was ridden.
    pub bands: Vec<Band>,
}

/// A column of the regression: a signal, and whether it is multiplied by the speed.
type Term = (Signal, bool);

/// Identifies the law.
pub fn law(record: &Record, checked: &Checked) -> Part<Law> {
    let recorded = recorded(record, checked);
    if recorded.is_empty() {
        return Part::not("no signal that a law could use is recorded");
    }
    let most = checked.samples(LONGEST_LAG_S);
    let rows = rows(record, checked, &recorded, most);
    let seconds = rows.len() as f64 * checked.period_s;
    if rows.len() < FEWEST || seconds < SHORTEST_S {
        return Part::not(format!(
            "all signals are known together during {seconds:.1} s of a changing torque"
        ));
    }
    let problem = Problem::new(record, checked, &recorded, rows);
    let lags = (0..=most).filter_map(|lag| Some((problem.plain_rest(lag)?, lag)));
    let Some((_, lag)) = lags.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Part::not("no signal changes");
    };
    let Some(solved) = problem.solve(&problem.rows, lag) else {
        return Part::not("no signal changes");
    };
    let at = |term: Term| solved.terms.iter().position(|other| *other == term);
    let (gain, slope) = (at((Signal::RollRate, false)), at((Signal::RollRate, true)));
    let vanishes = gain.zip(slope).filter(|(_, slope)| !solved.fit.estimate(*slope).holds(0.0));
    let speed_m_s = problem.mean_speed(&problem.rows);
    let vanishes_m_s = vanishes.map(|(gain, slope)| {
        let ratio = solved.fit.ratio(gain, slope);
        let (value, low, high) = (speed_m_s - ratio.value, speed_m_s - ratio.high, speed_m_s - ratio.low);
        Estimate { value, standard_error: ratio.standard_error, low, high }
    });
    Part::Found(Law {
        speed_m_s,
        lag_s: lag as f64 * checked.period_s,
        offset_nm: solved.fit.estimate(solved.terms.len()),
        gains: solved.gains,
        refused: solved.refused,
        vanishes_m_s,
        vaf: solved.fit.vaf,
        vaf_followed: solved.fit.vaf_followed,
        followed: solved.fit.followed,
        seconds,
        bands: problem.bands(lag),
    })
}

/// The signals with values in enough of the driven samples.
fn recorded<'a>(record: &'a Record, checked: &Checked) -> Vec<(Signal, &'a [f64])> {
    let driven: Vec<usize> = (0..checked.driven.len()).filter(|i| checked.driven[*i]).collect();
    let enough = |values: &[f64]| {
        driven.iter().filter(|i| values[**i].is_finite()).count() as f64 > RECORDED * driven.len() as f64
    };
    let all = Signal::ALL.into_iter().filter_map(|signal| Some((signal, record.channel(signal)?)));
    all.filter(|(_, values)| enough(values)).collect()
}

/// Driven samples whose signals are known up to the longest lag before, without a gap.
fn rows(record: &Record, checked: &Checked, recorded: &[(Signal, &[f64])], most: usize) -> Vec<usize> {
    let known = |i: usize| {
        checked.plausible[i]
            && record.speed_m_s[i].is_finite()
            && recorded.iter().all(|(_, values)| values[i].is_finite())
    };
    let mut rows = Vec::new();
    for run in checked.breaks.windows(2) {
        let mut since = run[0];
        for i in run[0]..run[1] {
            since = if known(i) { since } else { i + 1 };
            if checked.driven[i] && i >= since + most {
                rows.push(i);
            }
        }
    }
    rows
}

/// The regression of a recording.
struct Problem<'a> {
    record: &'a Record,
    signals: &'a [(Signal, &'a [f64])],
    rows: Vec<usize>,
    period_s: f64,
    memory: usize,
}

struct Solved {
    terms: Vec<Term>,
    gains: Vec<Gain>,
    refused: Vec<Refused>,
    fit: Fit,
}

impl<'a> Problem<'a> {
    fn new(
        record: &'a Record,
        checked: &Checked,
        signals: &'a [(Signal, &'a [f64])],
        rows: Vec<usize>,
    ) -> Self {
        Self { record, signals, rows, period_s: checked.period_s, memory: checked.samples(MEMORY_S) }
    }

    fn mean_speed(&self, rows: &[usize]) -> f64 {
        rows.iter().map(|row| self.record.speed_m_s[*row]).sum::<f64>() / rows.len() as f64
    }

    fn torque(&self, rows: &[usize]) -> DVector<f64> {
        DVector::from_iterator(rows.len(), rows.iter().map(|row| self.record.torque_nm[*row]))
    }

    /// All terms as columns: the signals, then the signals times the speed.
    fn columns(&self, rows: &[usize], lag: usize) -> (Vec<Term>, DMatrix<f64>) {
        let mean = self.mean_speed(rows);
        let n = self.signals.len();
        let x = DMatrix::from_fn(rows.len(), 2 * n, |i, j| {
            let row = rows[i] - lag;
            let value = self.signals[j % n].1[row];
            if j < n { value } else { value * (self.record.speed_m_s[row] - mean) }
        });
        let terms = (0..x.ncols()).map(|j| (self.signals[j % n].0, j >= n)).collect();
        (terms, x)
    }

    /// Mean absolute residual of least squares, to compare lags.
    fn plain_rest(&self, lag: usize) -> Option<f64> {
        let (_, x) = self.columns(&self.rows, lag);
        let (kept, _) = separable(&x);
        let (x, y) = (with_constant(&x.select_columns(&kept)), self.torque(&self.rows));
        let fit = regress(&x, &y, Weights::Equal, 1)?;
        Some((y - x * fit.coefficients).abs().mean())
    }

    fn solve(&self, rows: &[usize], lag: usize) -> Option<Solved> {
        let (all, x) = self.columns(rows, lag);
        let (kept, left) = separable(&x);
        let chosen = x.select_columns(&kept);
        let y = self.torque(rows);
        let fit = regress(&with_constant(&chosen), &y, Weights::Robust, self.memory)?;
        let terms: Vec<Term> = kept.iter().map(|j| all[*j]).collect();
        let spread = y.variance().sqrt();
        let gain = |(i, (signal, _)): (usize, &Term)| {
            let gain = fit.estimate(i);
            let slope = terms.iter().position(|term| *term == (*signal, true));
            let mut part = chosen.column(i) * gain.value;
            slope.iter().for_each(|slope| part += chosen.column(*slope) * fit.coefficients[*slope]);
            let contribution = part.variance().sqrt() / spread;
            Gain {
                signal: *signal,
                acts: !gain.holds(0.0) && contribution >= LEAST_CONTRIBUTION,
                gain,
                per_speed: slope.map(|slope| fit.estimate(slope)),
                contribution,
            }
        };
        let gains = terms.iter().enumerate().filter(|(_, (_, per_speed))| !per_speed).map(gain).collect();
        let refused = left.into_iter().map(|(j, reason)| {
            let (signal, per_speed) = all[j];
            Refused { signal, per_speed, why: why(all[j], reason, &all) }
        });
        Some(Solved { refused: refused.collect(), gains, fit, terms })
    }

    /// The law in ranges of the speed.
    fn bands(&self, lag: usize) -> Vec<Band> {
        let (width, shortest_s) = BAND;
        let band_of = |row: &usize| (self.record.speed_m_s[*row] / width).floor() as i64;
        let mut sorted: Vec<(i64, usize)> = self.rows.iter().map(|row| (band_of(row), *row)).collect();
        sorted.sort_unstable();
        let band = |part: &[(i64, usize)]| {
            let rows: Vec<usize> = part.iter().map(|(_, row)| *row).collect();
            let seconds = rows.len() as f64 * self.period_s;
            let long = seconds >= shortest_s && rows.len() >= FEWEST;
            let solved = long.then(|| self.solve(&rows, lag)).flatten()?;
            Some(Band {
                from_m_s: part[0].0 as f64 * width,
                to_m_s: (part[0].0 + 1) as f64 * width,
                speed_m_s: self.mean_speed(&rows),
                seconds,
                gains: solved.gains,
                vaf_followed: solved.fit.vaf_followed,
                followed: solved.fit.followed,
            })
        };
        let bands: Vec<Band> = sorted.chunk_by(|a, b| a.0 == b.0).filter_map(band).collect();
        if bands.len() > 1 { bands } else { Vec::new() }
    }
}

fn with_constant(x: &DMatrix<f64>) -> DMatrix<f64> {
    x.clone().insert_column(x.ncols(), 1.0)
}

/// Why a term can't be identified, in words.
fn why((signal, per_speed): Term, reason: Inseparable, all: &[Term]) -> String {
    let what = |(signal, per_speed): Term| {
        format!("{}{}", signal.name(), if per_speed { " times speed" } else { "" })
    };
    match reason {
        Inseparable::Constant if per_speed => "the speed does not change".into(),
        Inseparable::Constant => "it does not change".into(),
        Inseparable::Collinear { with, inflation } => format!(
            "in this closed loop {} is a linear function of the other signals, above all of {} (variance inflation {}); \
             its gain is part of theirs",
            what((signal, per_speed)),
            what(all[with]),
            if inflation > 1e6 { "above a million".into() } else { format!("{inflation:.0}") }
        ),
    }
}
