//! The study as text, tables and a figure.

use super::{BAND, BICYCLE, Extent, GOOD, NAME, QUESTION, Set, TITLE};
use crate::basin::Drawn;
use crate::eigen::NEUTRAL_1_S;
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::study::page::table;
use std::fmt::Write;

/// Largest difference of equal variances accounted for \[%\].
const EQUAL: f64 = 1.0;

/// Two sets of a run with equal variances accounted for, the lower basin first.
type Pair<'a> = (&'a Set, &'a Set);

/// The sets of each run.
fn runs(sets: &[Set]) -> impl Iterator<Item = &[Set]> {
    sets.chunk_by(|a, b| (a.delay_ms, a.run) == (b.delay_ms, b.run))
}

/// The pairs of sets of one run with equal variance accounted for.
fn pairs(sets: &[Set]) -> Vec<Pair<'_>> {
    let of_run = |run: &'_ [Set]| -> Vec<(usize, usize)> {
        let all = (0..run.len()).flat_map(|i| (i + 1..run.len()).map(move |j| (i, j)));
        all.filter(|&(i, j)| (run[i].vaf - run[j].vaf).abs() <= EQUAL).collect()
    };
    runs(sets)
        .flat_map(|run| of_run(run).into_iter().map(move |(i, j)| (&run[i], &run[j])))
        .map(|(a, b)| if a.height <= b.height { (a, b) } else { (b, a) })
        .collect()
}

/// Agreement of the order of heights with that of variances accounted for within runs (Kendall's tau, ties left out):
/// -1 to 1.
fn agreement(sets: &[Set]) -> f64 {
    let (mut alike, mut all) = (0.0, 0.0);
    for run in runs(sets) {
        for (i, a) in run.iter().enumerate() {
            for b in &run[i + 1..] {
                let product = (a.vaf - b.vaf) * (a.height - b.height);
                if product != 0.0 {
                    alike += product.signum();
                    all += 1.0;
                }
            }
        }
    }
    alike / all
}

/// Smallest and largest value.
fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let wider = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), wider)
}

/// "5.1 to 7.8" to `digits`, one number, or a dash.
fn span(values: impl Iterator<Item = f64>, digits: usize) -> String {
    let values: Vec<f64> = values.collect();
    let (low, high) = range(values.iter().copied());
    match values.len() {
        0 => "-".into(),
        1 => format!("{low:.digits$}"),
        _ => format!("{low:.digits$} to {high:.digits$}"),
    }
}

/// A growth with two digits; zero without a sign of rounding.
fn signed(growth: f64) -> String {
    format!("{:+.2}", (100.0 * growth).round() / 100.0 + 0.0)
}

pub(super) fn text(sets: &[Set], band: &Drawn, extent: &Extent) -> String {
    let mut text = format!(
        "# {TITLE}\n\n\
         Made by `sim-host study {NAME}`. {QUESTION}\n\
         Kuipers 2020 leaves it open (appendices H and I; discussion, \"Validity Validation Metric VAF\").\n\n\
         The sets are the rows of Tables J.1, F.3 and G.3 ([riders.md](../riders.md)) with a printed variance accounted for\n\
         (VAF) of {GOOD} % or more: of each run first all gains, then fewer and fewer. Each set is a rider of its own, with the same\n\
         gains at all speeds, on `{BICYCLE}` without assist. The height is the largest steer rate from which the ride at the\n\
         run's speed does not fall, within {} rad/s.\n\n## Answer\n\n",
        extent.search.tolerance
    );
    text += &answer(sets, band, extent);
    text += &format!("\n![Heights and VAF]({NAME}.svg)\n\n## The sets of one run\n\n");
    text += &run_table(sets);
    text += "\nPrinted: the heights of Tables I.1 and I.2, which are the first multiple of 0.1 rad/s that falls; J.1 has none. \
             Row by\nrow, with the reasons of differences: `table-I.1` and `table-I.2` of [thesis.md](../thesis.md).\n\n";
    let _ = writeln!(
        text,
        "## Sets of one run with equal VAF\n\nAll pairs of sets of a run whose VAF differ by {EQUAL} or less.\n"
    );
    text += &pair_table(sets);
    text += "\nTau is Kendall's rank correlation of height and VAF within runs, over all pairs of sets of a run: 1 if the better set\n\
             always has the larger basin, 0 without a relation.\n\n";
    let _ = writeln!(text, "## The band of a rider with three runs per speed\n");
    text += &band_text(band, extent);
    text += "\n## Every set\n\nGrowth is the real part of the rightmost root of the linear model at the run's speed, negative if the straight ride is\nstable. It is zero with gains of both integrals, of roll and of steer: only their weighted sum is fed back, so that another\ncombination drifts without effect.\n\n";
    text += &set_table(sets);
    text
}

fn answer(sets: &[Set], band: &Drawn, extent: &Extent) -> String {
    let pairs = pairs(sets);
    let ratio = |pair: &Pair| pair.1.height / pair.0.height;
    let Some((low, high)) = pairs.iter().max_by(|a, b| ratio(a).total_cmp(&ratio(b))) else {
        return "No two sets of a run have equal VAF.\n".into();
    };
    let wide = pairs.iter().filter(|pair| ratio(pair) > 1.2).count();
    let of_run = |run: &[Set]| {
        let (low, high) = range(run.iter().map(|set| set.height));
        high / low
    };
    let (_, of_run) = range(runs(sets).map(of_run));
    let (least, most) = range(delays(sets).map(agreement));
    let unstable = sets.iter().filter(|set| set.growth > NEUTRAL_1_S).count();
    let relative = |[low, middle, high]: [f64; 3]| 100.0 * (high - low) / middle;
    format!(
        "Mostly little, and in some runs much. Of {} pairs of sets of the same run whose VAF differ by {EQUAL} or less half have heights\n\
         within {:.0} % of each other, and {wide} differ by more than 20 %. The widest: run {} at {} m/s with {} ms, {:.2} rad/s with\n\
         {} gains and a VAF of {:.2} %, {:.2} rad/s with {} gains and {:.2} %. Over all sets of a run with {GOOD} % or more the\n\
         highest basin is up to {of_run:.1} times the lowest. VAF does not tell which set has the larger one: the rank correlation\n\
         with the height within runs is {least:.2} to {most:.2}, by delay. {unstable} of the {} sets make the straight ride linearly\n\
         unstable.\n\n\
         Means of several runs are more certain. Between the 5 % and 95 % quantiles of {} riders drawn from the runs of `{BAND}` the\n\
         heights differ by {} % of the median, over {} m/s.\n",
        pairs.len(),
        100.0 * (median(&pairs.iter().map(ratio).collect::<Vec<_>>()) - 1.0),
        low.run,
        low.speed_m_s,
        low.delay_ms,
        low.height,
        low.gains,
        low.vaf,
        high.height,
        high.gains,
        high.vaf,
        sets.len(),
        band.basins.len(),
        span(band.heights().into_iter().map(relative), 0),
        span(extent.search.speeds.iter().copied(), 1),
    )
}

/// The middle value, the upper one of two; NaN without any.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

fn run_table(sets: &[Set]) -> String {
    let heading = [
        "delay, ms",
        "run",
        "v, m/s",
        "sets",
        "VAF, %",
        "height, rad/s",
        "highest / lowest",
        "printed, rad/s",
    ];
    let rows = runs(sets).map(|run| {
        let (low, high) = range(run.iter().map(|set| set.height));
        vec![
            run[0].delay_ms.to_string(),
            run[0].run.to_string(),
            run[0].speed_m_s.to_string(),
            run.len().to_string(),
            span(run.iter().map(|set| set.vaf), 2),
            span(run.iter().map(|set| set.height), 2),
            format!("{:.2}", high / low),
            span(run.iter().filter_map(|set| set.printed), 1),
        ]
    });
    table(&heading, rows)
}

/// The sets with each delay.
fn delays(sets: &[Set]) -> impl Iterator<Item = &[Set]> {
    sets.chunk_by(|a, b| a.delay_ms == b.delay_ms)
}

fn pair_table(sets: &[Set]) -> String {
    let heading =
        ["delay, ms", "pairs", "median higher / lower", "largest", "its run, VAF", "tau of height and VAF"];
    let rows = delays(sets).map(|of_delay| {
        let pairs = pairs(of_delay);
        let ratios: Vec<f64> = pairs.iter().map(|(low, high)| high.height / low.height).collect();
        let widest =
            pairs.iter().max_by(|a, b| (a.1.height / a.0.height).total_cmp(&(b.1.height / b.0.height)));
        vec![
            of_delay[0].delay_ms.to_string(),
            pairs.len().to_string(),
            format!("{:.2}", median(&ratios)),
            format!("{:.2}", ratios.iter().fold(f64::NAN, |a, b| a.max(*b))),
            widest.map_or("-".into(), |(low, high)| {
                format!("{}: {:.2} % lower, {:.2} % higher", low.run, low.vaf, high.vaf)
            }),
            format!("{:.2}", agreement(of_delay)),
        ]
    });
    table(&heading, rows)
}

fn band_text(band: &Drawn, extent: &Extent) -> String {
    let heading = ["v, m/s", "5 %, rad/s", "median", "95 %"];
    let rows = extent.search.speeds.iter().zip(band.heights()).map(|(v, quantiles)| {
        [v.to_string()].into_iter().chain(quantiles.map(|height| format!("{height:.2}"))).collect()
    });
    format!(
        "{} riders drawn from `{BAND}` (30 ms): of each group of three runs three with replacement, then the means of the groups\n\
         (`sim-host basin --rider {BAND} --rider-draws {}`). The thesis found likewise that means over runs agree where single sets\n\
         do not: with six and seven gains of the old cyclist an RMSE of 0.42 rad/s between the basins of the means, of 0.95 rad/s between\n\
         those of the sets with the highest VAF (appendix H; recomputed as `table-H.2` of [thesis.md](../thesis.md)).\n\n{}",
        band.basins.len(),
        extent.draws,
        table(&heading, rows)
    )
}

fn set_table(sets: &[Set]) -> String {
    let heading =
        ["delay, ms", "run", "v, m/s", "gains", "VAF, %", "growth, 1/s", "height, rad/s", "printed, rad/s"];
    let rows = sets.iter().map(|set| {
        vec![
            set.delay_ms.to_string(),
            set.run.to_string(),
            set.speed_m_s.to_string(),
            set.gains.to_string(),
            format!("{:.2}", set.vaf),
            signed(set.growth),
            format!("{}{:.2}", if set.capped { ">= " } else { "" }, set.height),
            set.printed.map_or("-".into(), |height| format!("{height:.1}")),
        ]
    });
    table(&heading, rows)
}

pub(super) fn figure(sets: &[Set], band: &Drawn, extent: &Extent) -> Chart {
    let marks = [Marker::Cross, Marker::Dot, Marker::Square];
    let of_delay = delays(sets).zip(marks).enumerate().map(|(i, (sets, marker))| {
        let points = sets.iter().map(|set| (set.vaf, set.height)).collect();
        Series::new(format!("{} ms", sets[0].delay_ms), Look::marks(i, marker), points)
    });
    let heights = Plot {
        title: "Every set at its run's speed".into(),
        x: Axis::new("VAF [%]").over(GOOD, 100.0),
        y: Axis::new("Height of the basin [rad/s]"),
        series: of_delay.collect(),
        ..Plot::default()
    };
    let quantiles = band.heights();
    let lines = [(Line::Dashed, "5 % and 95 %"), (Line::Solid, "median"), (Line::Dashed, "5 % and 95 %")];
    let series = lines.into_iter().enumerate().map(|(q, (line, name))| {
        let points = extent.search.speeds.iter().zip(&quantiles).map(|(v, at)| (*v, at[q])).collect();
        Series::new(name, Look::line(1, line), points)
    });
    let over_speed = Plot {
        title: format!("{} riders drawn from {BAND}", band.basins.len()),
        x: Axis::new("Forward speed v [m/s]"),
        y: Axis::new("Height of the basin [rad/s]"),
        series: series.collect(),
        ..Plot::default()
    };
    Chart { title: TITLE.into(), columns: 2, plots: vec![heights, over_speed], shaded: String::new() }
}
