//! Study of the prototype's balance-assist law beside law h, both with the prototype's torque limit of 7 N m.

use super::page::{Page, table};
use super::trial::{Trial, TrialError, basins};
use crate::basin::{Axis as Disturbance, Basin, Bound, Column, Method, Search};
use crate::report::figure::{Axis, Chart, Line, Look, Plot, Series};
use control::{Law, Limits};

/// The name of the page.
pub const NAME: &str = "prototype";
/// Title of the page.
pub const TITLE: &str = "The prototype's law beside h";
/// The question that the study answers.
pub const QUESTION: &str =
    "Which law has the larger basin of attraction behind the prototype's 7 N m: its own, or h?";
/// The largest torque of the published prototype \[N m\].
pub const LIMIT_NM: f32 = 7.0;
/// The product's torque rate limit \[N m/s\].
const RATE_NM_S: f32 = 100.0;
/// Bicycles and riders.
const RIDES: [(&str, Option<&str>); 3] =
    [("rigid_jason", None), ("rigid_jason", Some("smart")), ("balanceassistv1_jason", None)];

/// The laws, with their names on the command line.
pub fn laws() -> [(String, Law); 4] {
    [Law::None, Law::H { cut: true }, Law::BalanceAssist { kappa: 3.9 }, Law::BalanceAssist { kappa: 5.2 }]
        .map(|law| (law.to_string(), law))
}

/// The search of the study: 2 to 7.5 m/s in steps of `step` \[m/s\].
pub fn search(step: f64) -> Search {
    let steps = (5.5 / step).round() as usize;
    Search {
        speeds: (0..=steps).map(|i| ((2.0 + i as f64 * step) * 1e9).round() / 1e9).collect(),
        axis: Disturbance::SteerRate,
        max_rate: 30.0,
        scan_step: 0.25,
        tolerance: 0.01,
        method: Method::Fast,
        efforts: false,
    }
}

/// One condition of the study: a bicycle and a rider, with or without the product's rate limit.
#[derive(Clone, Debug)]
pub struct Group {
    /// The bicycle's name.
    pub bicycle: &'static str,
    /// The rider's name.
    pub rider: Option<&'static str>,
    /// Whether the torque's rate is limited.
    pub rate_limited: bool,
    trial: Trial,
}

/// All conditions.
pub fn groups() -> Vec<Group> {
    let pairs = RIDES.iter().flat_map(|ride| [false, true].map(|limited| (*ride, limited)));
    pairs
        .map(|((bicycle, rider), rate_limited)| {
            let rate_nm_s = rate_limited.then_some(RATE_NM_S);
            let limits = Limits {
                max_torque_nm: Some(LIMIT_NM),
                rise_nm_s: rate_nm_s,
                fall_nm_s: rate_nm_s,
                ..Limits::default()
            };
            let trial = Trial::new(bicycle, rider, None, 0, limits);
            Group { bicycle, rider, rate_limited, trial }
        })
        .collect()
}

/// Number of columns that the study computes.
pub fn work(search: &Search) -> usize {
    RIDES.len() * (2 * laws().len() - 1) * search.speeds.len()
}

/// Computes the study; `None` if `stop` interrupted it.
///
/// # Errors
/// Invalid conditions.
pub fn study(
    search: &Search,
    advanced: &(dyn Fn() + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Page>, TrialError> {
    let (groups, laws) = (groups(), laws());
    // Without a law no limit has an effect, so that case is computed once.
    let matters = |g: &Group, law: &Law| *law != Law::None || !g.rate_limited;
    let pairs = groups.iter().flat_map(|g| laws.iter().map(move |(_, law)| (g, law)));
    let requested: Vec<(&Trial, &Law)> =
        pairs.filter(|(g, law)| matters(g, law)).map(|(g, law)| (&g.trial, law)).collect();
    let Some(found) = basins(&requested, search, advanced, stop)? else { return Ok(None) };
    let mut found = found.into_iter();
    let mut by_group: Vec<Vec<Basin>> = Vec::new();
    for g in &groups {
        let mut of_laws: Vec<Basin> = Vec::new();
        for (_, law) in &laws {
            let before = by_group.last().and_then(|group| group.first());
            let basin = if matters(g, law) { found.next() } else { before.cloned() };
            of_laws.extend(basin);
        }
        by_group.push(of_laws);
    }
    let text = text(&groups, &by_group, search);
    Ok(Some(Page { name: NAME, text, chart: figure(&groups, &by_group) }))
}

fn text(groups: &[Group], basins: &[Vec<Basin>], search: &Search) -> String {
    let laws = laws();
    let mut heading = vec!["bicycle", "rider", "largest change [N m/s]"];
    heading.extend(laws.iter().map(|(name, _)| name.as_str()));
    heading.push("5.2 over h-cut");
    let rows = groups.iter().zip(basins).map(|(g, basins)| {
        let ratio = Bound::of_ratio(basins[3].capped(), basins[1].capped());
        let rate = if g.rate_limited { RATE_NM_S.to_string() } else { "none".into() };
        let mut row = vec![g.bicycle.to_owned(), g.rider.unwrap_or("none").to_owned(), rate];
        row.extend(basins.iter().map(|b| format!("{}{:.2}", Bound::of(b.capped()).sign(), b.area())));
        row.push(format!("{}{:.2}", ratio.sign(), basins[3].area() / basins[1].area()));
        row
    });
    let areas = table(&heading, rows);
    let speeds = [2.0, 3.0, 4.0, 4.5, 5.0, 6.0, 7.0];
    let nearest = |basin: &Basin, v: f64| {
        let apart = |column: &&Column| ((column.speed - v).abs() * 1e6) as u64;
        let height = |c: &Column| format!("{}{:.2}", Bound::of(c.capped).sign(), c.upper);
        basin.columns.iter().min_by_key(apart).map_or("-".into(), height)
    };
    let heights = groups.iter().zip(basins).filter(|(g, _)| g.rate_limited).flat_map(|(g, basins)| {
        laws.iter().zip(basins).map(move |((name, _), basin)| {
            let who = format!("{}, {}", g.bicycle, g.rider.unwrap_or("no rider"));
            let at = speeds.map(|v| nearest(basin, v));
            [vec![who, (*name).to_owned()], at.to_vec()].concat()
        })
    });
    let columns: Vec<String> = speeds.iter().map(|v| format!("{v} m/s")).collect();
    let mut names = vec!["who", "law"];
    names.extend(columns.iter().map(String::as_str));
    let heights = table(&names, heights);
    let step = search.speeds.get(1).map_or(0.0, |v| v - search.speeds[0]);
    let verdict = verdict(groups, basins);
    format!(
        "# {TITLE}\n\n\
         Made by `sim-host study prototype`. Both laws are given the prototype's {LIMIT_NM} N m, the flashed code at\n\
         1 kHz and exact sensors without delay. Areas of the basin under a steer rate, {} to {} m/s in steps of {step:.2} m/s,\n\
         in rad m/s^2; borders within {} rad/s. A ride that does not fall within 6 s counts, so that slow growth at\n\
         low speed is no fall.\n\n{areas}\n\
         The steer rates that are survived, in rad/s, with the rate limit, at the nearest speed computed:\n\n{heights}\n\
         {verdict}\n\
         The balance assist ends at 4.7 m/s and starts from zero at rest; h reaches on to 7.5 m/s. Of the prototype's own\n\
         bicycle (`balanceassistv1_jason`) there is no rider's table; it is ridden hands off. The slopes are those of the\n\
         published model; in the prototype twice as much was set ([balance-assist.md](balance-assist.md)).\n\n\
         ![Basins](prototype.svg)\n",
        search.speeds[0],
        search.speeds[search.speeds.len() - 1],
        search.tolerance,
    )
}

/// Text: which law has the larger basin, and the effect of the rate limit.
fn verdict(groups: &[Group], basins: &[Vec<Basin>]) -> String {
    if basins.iter().flatten().any(Basin::capped) {
        return "Where nothing fell up to the largest rate tried, heights and areas are lower bounds (`>=`), ratios bounds\n\
                or, of two bounds, unknown (`~`): no law is said to have the larger basin.\n"
            .into();
    }
    let areas: Vec<Vec<f64>> =
        basins.iter().map(|of_laws| of_laws.iter().map(Basin::area).collect()).collect();
    let larger = areas.iter().filter(|a| a[1] > a[2].max(a[3])).count();
    let pairs = areas.chunks_exact(2).flat_map(|pair| pair[0].iter().zip(&pair[1]));
    let change = pairs.map(|(without, with)| (with / without - 1.0).abs()).fold(0.0, f64::max);
    format!(
        "At equal torque h has the larger basin in {larger} of {} cases. The rate limit changes no area by more than\n\
         {:.1} %.\n",
        groups.len(),
        100.0 * change,
    )
}

fn figure(groups: &[Group], basins: &[Vec<Basin>]) -> Chart {
    let limited = groups.iter().zip(basins).filter(|(g, _)| g.rate_limited);
    let plots = limited.map(|(g, basins)| Plot {
        title: format!("{}, {}", g.bicycle, g.rider.unwrap_or("no rider")),
        x: Axis::new("Forward speed v [m/s]"),
        y: Axis::new("Steer rate survived [rad/s]"),
        series: laws()
            .iter()
            .zip(basins)
            .enumerate()
            .map(|(i, ((name, _), basin))| {
                Series::new(name.as_str(), Look::line(i, Line::Solid), basin.outline())
            })
            .collect(),
        ..Plot::default()
    });
    let title = format!("Basins at {LIMIT_NM} N m and {RATE_NM_S} N m/s");
    Chart { title, columns: 2, plots: plots.collect(), shaded: String::new() }
}
