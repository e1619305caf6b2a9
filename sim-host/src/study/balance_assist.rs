//! Study of the balance assist of the Gazelle and TU Delft prototype: stable speed ranges of the published bicycle with
//! it, and its measured weave beside the model's. Published numbers: `data/balance_assist.toml`.

use super::motor_fit::{Explained, Free, fits, published_residual};
use super::page::{Page, table};
use super::published_weave::{StableFrom, Weave, published, weave};
use super::weave_recorded;
use crate::bicycle::Parameters;
use crate::bicycle::catalogue::{self, BicycleError};
use crate::eigen::{ActuatorError, Feedback, LinearActuator, Model, SEARCH_TO_M_S, stability};
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use control::Law;
use nalgebra::Complex;
use std::fmt::Write;

/// The name of the page.
pub const NAME: &str = "balance-assist";
/// Title of the page.
pub const TITLE: &str = "The balance assist of the Gazelle and TU Delft prototype";
/// The question that the study answers.
pub const QUESTION: &str =
    "From which speed is the published bicycle stable under the prototype's balance assist, and is the weave
that was measured on it the model's?";
/// The bicycle with the steer motor, as pushed off to ride without a rider.
pub const RIDERLESS: &str = "balanceassistv1";
/// The same bicycle with a rigid rider.
pub const RIDDEN: &str = "balanceassistv1_jason";

/// The lowest speed at which the straight ride is stable \[m/s\], and the speed from which it is unstable again. `None` if
/// it is nowhere stable up to 20 m/s, or no root converges.
pub fn stable_range(bicycle: &Parameters, law: Law) -> (Option<f64>, f64) {
    let found = stability(&Model::new(bicycle, Feedback::Law(law), None));
    let (from, to) = found.and_then(|found| found.ranges.first().copied()).unzip();
    (from, to.unwrap_or(SEARCH_TO_M_S))
}

/// A study that cannot be computed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BalanceAssistError {
    /// A bicycle cannot be loaded.
    #[error(transparent)]
    Bicycle(#[from] BicycleError),
    /// The fitted motor is outside the model's range.
    #[error(transparent)]
    Motor(#[from] ActuatorError),
}

/// Computes the study.
///
/// # Errors
/// A bicycle of the catalogue cannot be loaded, or the fitted motor is outside the model's range.
pub fn study() -> Result<Page, BalanceAssistError> {
    let load = |name| catalogue::load(name).map(|b| b.parameters);
    let (riderless, ridden) = (load(RIDERLESS)?, load(RIDDEN)?);
    let published = published();
    let fits = fits(&riderless, &published.weave);
    let mut text = format!(
        "# {TITLE}\n\n\
         Made by `sim-host study balance-assist`; published numbers and their sources are in\n\
         [data/balance_assist.toml](../../data/balance_assist.toml), parameters in\n\
         [data/bicycles.toml](../../data/bicycles.toml).\n\n\
         The law is `balance-assist:K`: the gain on the roll rate is K (4.7 - v) from 1.5 to 4.7 m/s, 0 above, and\n\
         below 1.5 m/s the straight line from 0 at rest.\n\n\
         ## Where the straight ride is stable\n\n",
    );
    text += &ranges(&published.stable_from, &riderless, &ridden);
    text += "\nThe upper end is capsize, which feedback of the roll rate does not move. Computed from the parameters; no\n\
             number was fitted.\n\n## The measured weave\n\n";
    text += &measured(&riderless, &published.weave, &fits);
    text += "\n![Weave eigenvalues](balance-assist.svg)\n\n";
    text += &weave_recorded::section(&riderless, &published.weave, best(&fits).actuator)?;
    Ok(Page { name: NAME, text, chart: figure(&riderless, &published.weave, &fits) })
}

fn ranges(published: &StableFrom, riderless: &Parameters, ridden: &Parameters) -> String {
    let rows = [(RIDERLESS, riderless, published.riderless_kmh), (RIDDEN, ridden, published.ridden_kmh)];
    let rows = rows.into_iter().flat_map(|(name, bicycle, printed)| {
        published.kappa.into_iter().zip(printed).map(move |(kappa, printed)| {
            let (from, to) = stable_range(bicycle, Law::BalanceAssist { kappa });
            let from = from.map_or("none".into(), |v| format!("{:.3}", v * 3.6));
            vec![name.to_owned(), kappa.to_string(), printed.to_string(), from, format!("{:.2}", to * 3.6)]
        })
    });
    let alone = [(RIDERLESS, riderless), (RIDDEN, ridden)].map(|(name, bicycle)| {
        let (from, to) = stable_range(bicycle, Law::None);
        let from = from.map_or("none".into(), |v| format!("{:.3}", v * 3.6));
        vec![name.to_owned(), "no assist".into(), String::new(), from, format!("{:.2}", to * 3.6)]
    });
    table(&["bicycle", "K", "published from [km/h]", "stable from [km/h]", "to [km/h]"], rows.chain(alone))
}

fn measured(bicycle: &Parameters, series: &[Weave], fits: &[Explained]) -> String {
    let mut text = String::from(
        "Distances between model and measurement over both settings and all speeds, root mean square in 1/s. In the\n\
         first row the slope is the one the authors' model uses; in all others it is the one that was set in the\n\
         controller, twice as steep, and what is free is chosen by least squares for both settings at once.\n\n",
    );
    let number = |x: f64| format!("{x:.2}");
    let [all, re, im] = published_residual(bicycle, series);
    let nothing = || vec![String::new(); 5];
    let first =
        [vec!["the published slopes".to_owned()], nothing(), [all, re, im].map(number).to_vec()].concat();
    let rows = fits.iter().map(|e| {
        let a = e.actuator;
        let if_free = |free: Free, text: String| if e.free.contains(&free) { text } else { String::new() };
        vec![
            e.name.to_owned(),
            if_free(Free::Scale, format!("{:.3}", a.scale)),
            if_free(Free::Friction, format!("{:.2}", a.viscous_nm_s_rad)),
            if_free(Free::Lag, format!("{:.1}", a.time_constant_s * 1e3)),
            if_free(Free::Delay, format!("{:.1}", a.delay_s * 1e3)),
            if_free(Free::Inertia, format!("{:.3}", a.inertia_kg_m2)),
            number(e.residual),
            number(e.residual_re),
            number(e.residual_im),
        ]
    });
    let heading = [
        "motor",
        "torque given / asked for",
        "friction [N m s/rad]",
        "lag [ms]",
        "delay [ms]",
        "inertia [kg m^2]",
        "distance",
        "of decay",
        "of frequency",
    ];
    text += &table(&heading, [first].into_iter().chain(rows));
    let _ = write!(text, "\n{}", verdict(bicycle, series, fits));
    text += "\nSpeed by speed, decay and frequency in 1/s and rad/s:\n\n";
    let best = best(fits);
    let rows = series.iter().flat_map(|s| {
        let published = weave(bicycle, s.kappa_model, LinearActuator::default(), &s.speed_m_s);
        let fitted = weave(bicycle, s.kappa_set, best.actuator, &s.speed_m_s);
        let pair =
            |root: Option<Complex<f64>>| root.map_or("none".into(), |r| format!("{:.2}, {:.2}", r.re, r.im));
        let rows = s.speed_m_s.iter().zip(s.roots()).zip(published).zip(fitted);
        rows.map(move |(((v, root), published), fitted)| {
            vec![s.kappa_set.to_string(), v.to_string(), pair(Some(root)), pair(published), pair(fitted)]
        })
        .collect::<Vec<_>>()
    });
    let fitted = format!("{}, fitted", best.name);
    text + &table(&["K set", "speed [m/s]", "measured", "published slopes", &fitted], rows)
}

/// The fit with the smallest residual.
pub fn best(fits: &[Explained]) -> &Explained {
    fits.iter().min_by(|a, b| a.residual.total_cmp(&b.residual)).expect("there are fits")
}

/// Speeds from which the law is weak: at most a tenth of its slope per m/s remains \[m/s\].
const WEAK_FROM_M_S: f64 = 4.4;

/// Smallest and largest frequency at the speeds where the law is weak: measured, and of a model \[rad/s\].
fn where_weak(bicycle: &Parameters, series: &[Weave], actuator: LinearActuator) -> [(f64, f64); 2] {
    let mut frequencies = [Vec::new(), Vec::new()];
    for s in series {
        let model = weave(bicycle, s.kappa_set, actuator, &s.speed_m_s);
        for ((v, root), model) in s.speed_m_s.iter().zip(s.roots()).zip(model) {
            if *v >= WEAK_FROM_M_S {
                frequencies[0].push(root.im);
                frequencies[1].extend(model.map(|m| m.im));
            }
        }
    }
    let ends = |all: &Vec<f64>| {
        all.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(*x), high.max(*x)))
    };
    [ends(&frequencies[0]), ends(&frequencies[1])]
}

fn verdict(bicycle: &Parameters, series: &[Weave], fits: &[Explained]) -> String {
    let of = |free: &[Free]| fits.iter().find(|e| e.free == free).expect("it is among the fits");
    let half = of(&[Free::Scale]);
    let motor = of(&[Free::Scale, Free::Lag, Free::Friction]);
    let heavy = of(&[Free::Friction, Free::Inertia]);
    let part = |e: &Explained| 100.0 * (1.0 - (e.residual / half.residual).powi(2));
    let [measured, modelled] = where_weak(bicycle, series, motor.actuator);
    format!(
        "- A torque of {:.2} times what was set, and nothing else, does about as the authors' slopes do: {:.2} 1/s.\n\
         - Lag and friction as well take {:.0} % off the squared distance; {:.2} 1/s is left. From {WEAK_FROM_M_S} m/s, where\n  \
           the law is weak, the weave was measured at {:.1} to {:.1} rad/s; this model has {:.1} to {:.1}.\n\
         - Friction and an inertia of {:.3} kg m^2 about the steer axis, with all of the torque that was set, take {:.0} %\n  \
           off; {:.2} 1/s is left. A rotor behind a reduction gear has such an inertia; that the prototype's has is\n  \
           not published. A fit is no proof: tyres that scrub and relax are left out here too.\n",
        half.actuator.scale,
        half.residual,
        part(motor),
        motor.residual,
        measured.0,
        measured.1,
        modelled.0,
        modelled.1,
        heavy.actuator.inertia_kg_m2,
        part(heavy),
        heavy.residual,
    )
}

fn figure(bicycle: &Parameters, series: &[Weave], fits: &[Explained]) -> Chart {
    let speeds: Vec<f64> = (0..=80).map(|i| 1.4 + 0.05 * f64::from(i)).collect();
    let best = best(fits);
    type Part = fn(Complex<f64>) -> f64;
    let parts: [(&str, Part); 2] = [("Decay Re λ [1/s]", |c| c.re), ("Frequency Im λ [rad/s]", |c| c.im)];
    let plots = series.iter().flat_map(|s| {
        let curves = [
            ("model with the published slope", 0, Line::Dashed, s.kappa_model, LinearActuator::default()),
            ("model with the fitted motor", 1, Line::Solid, s.kappa_set, best.actuator),
        ];
        let curves = curves.map(|(name, colour, line, kappa, actuator)| {
            (name, Look::line(colour, line), weave(bicycle, kappa, actuator, &speeds))
        });
        parts.map(|(label, part)| {
            let lines = curves.iter().map(|(name, look, roots)| {
                let points = speeds.iter().zip(roots).map(|(v, r)| (*v, r.map_or(f64::NAN, part))).collect();
                Series::new(*name, *look, points)
            });
            let points = s.speed_m_s.iter().copied().zip(s.roots().map(part)).collect();
            let marks = Series::new("measured", Look::marks(2, Marker::Ring), points);
            Plot {
                title: format!("K = {} set, {} in the model", s.kappa_set, s.kappa_model),
                x: Axis::new("Forward speed v [m/s]"),
                y: Axis::new(label),
                series: lines.chain([marks]).collect(),
                ..Plot::default()
            }
        })
    });
    let title = "Weave of the riderless prototype: measured and modelled".to_owned();
    Chart { title, columns: 2, plots: plots.collect(), shaded: String::new() }
}
