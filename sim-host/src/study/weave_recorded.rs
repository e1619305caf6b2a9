//! The weave of the balance-assist prototype from its recordings, beside the published values and the model. Measured
//! numbers: `data/weave_measured.toml` and `data/weave_measured_offset.toml`.

use super::page::table;
use super::published_weave::Weave;
use crate::bicycle::Parameters;
use crate::eigen::{ActuatorError, Feedback, LinearActuator, Model, roots};
use crate::weave::fit::MODE_1_S;
use crate::weave::measured::{Measured, MeasuredWeave};
use crate::weave::predict::weave;
use control::Law;
use nalgebra::Complex;

/// The weave fitted together with a decaying real mode.
///
/// # Panics
/// The built-in file is invalid.
pub fn recorded() -> Measured {
    let text = include_str!("../../../data/weave_measured.toml");
    toml::from_str(text).expect("data/weave_measured.toml is sound")
}

/// The weave of the same recordings, fitted together with an offset only.
///
/// # Panics
/// The built-in file is invalid.
pub fn recorded_offset() -> Measured {
    let text = include_str!("../../../data/weave_measured_offset.toml");
    toml::from_str(text).expect("data/weave_measured_offset.toml is sound")
}

/// A measured weave with the published and modelled values at the same gain and speed.
struct Row {
    measured: MeasuredWeave,
    offset: Option<MeasuredWeave>,
    published: Option<Complex<f64>>,
    perfect: Option<Complex<f64>>,
    fitted: Option<Complex<f64>>,
    /// The decaying real modes of the model with the fitted motor \[1/s\].
    modes: Vec<f64>,
}

/// Speeds of the same setting differ by at most this, since the published ones are rounded \[m/s\].
const SAME_M_S: f64 = 0.02;

fn rows(bicycle: &Parameters, published: &[Weave], motor: LinearActuator) -> Result<Vec<Row>, ActuatorError> {
    let offset = recorded_offset();
    let row = |measured: MeasuredWeave| {
        let (gain, speed) = (measured.gain.unwrap_or_default(), measured.speed_m_s);
        let law = Law::BalanceAssist { kappa: gain as f32 };
        let model = |motor| weave(bicycle, &law, motor, &[speed]).map(|roots| roots[0]);
        let series = published.iter().filter(|s| f64::from(s.kappa_set) == gain);
        let mut near = series.flat_map(|s| s.speed_m_s.iter().zip(s.roots()));
        Ok(Row {
            published: near.find(|(v, _)| (*v - speed).abs() < SAME_M_S).map(|(_, root)| root),
            offset: offset.weave.iter().find(|o| o.gain == measured.gain && o.speed_m_s == speed).cloned(),
            perfect: model(LinearActuator::default())?,
            fitted: model(motor)?,
            modes: modes(bicycle, law.clone(), motor, speed)?,
            measured,
        })
    };
    recorded().weave.into_iter().map(row).collect()
}

/// The model's real modes that a fit can confuse with the weave's \[1/s\].
fn modes(
    bicycle: &Parameters,
    law: Law,
    motor: LinearActuator,
    speed: f64,
) -> Result<Vec<f64>, ActuatorError> {
    let model = Model::new(bicycle, Feedback::Law(law), None).with_actuator(motor)?;
    let slow_or_fast = |re: &f64| (MODE_1_S.0..=MODE_1_S.1).contains(re);
    Ok(roots(&model.at(speed), 6)
        .into_iter()
        .filter(|r| r.im == 0.0)
        .map(|r| r.re)
        .filter(slow_or_fast)
        .collect())
}

/// Text of the page's section.
///
/// # Errors
/// The motor is out of range.
pub fn section(
    bicycle: &Parameters,
    published: &[Weave],
    motor: LinearActuator,
) -> Result<String, ActuatorError> {
    let rows = rows(bicycle, published, motor)?;
    let interval = |[value, low, high]: [f64; 3]| format!("{value:.2} [{low:.2}, {high:.2}]");
    let root =
        |root: Option<Complex<f64>>| root.map_or(String::new(), |r| format!("{:.2}, {:.2}", r.re, r.im));
    let lines = rows.iter().map(|row| {
        let m = &row.measured;
        let offset = row.offset.as_ref().map(|o| Complex::new(o.decay_1_s[0], o.frequency_rad_s[0]));
        vec![
            m.gain.map_or(String::new(), |gain| gain.to_string()),
            format!("{:.2}", m.speed_m_s),
            format!("{} of {}", m.repeats, m.repeats + m.refused),
            interval(m.decay_1_s),
            interval(m.frequency_rad_s),
            root(offset),
            root(row.published),
            root(row.perfect),
            root(row.fitted),
        ]
    });
    let heading = [
        "K set",
        "speed [m/s]",
        "recordings",
        "decay [1/s]",
        "frequency [rad/s]",
        "an offset alone",
        "published",
        "perfect motor",
        "fitted motor",
    ];
    Ok(format!(
        "## The weave in the recordings\n\n\
         The same knocks from the recordings of the gyro: decay and frequency with 95 % intervals, repeats together\n\
         ([data/weave_measured.toml](../../data/weave_measured.toml), made by `sim-host identify weave`, see\n\
         [cli.md](../cli.md#identify-weave)). The motor is the last one above. It was fitted to the values published of these\n\
         recordings, so where it agrees that tells how they are read, and is no second proof of the motor.\n\n{}\n{}",
        table(&heading, lines),
        verdict(&rows),
    ))
}

/// Number of intervals that contain the model's value: decays, frequencies.
fn inside(rows: &[Row], model: impl Fn(&Row) -> Option<Complex<f64>>) -> [usize; 2] {
    let holds = |[_, low, high]: [f64; 3], x: f64| usize::from((low..=high).contains(&x));
    rows.iter().filter_map(|row| Some((&row.measured, model(row)?))).fold([0, 0], |[re, im], (m, root)| {
        [re + holds(m.decay_1_s, root.re), im + holds(m.frequency_rad_s, root.im)]
    })
}

/// Root mean square distance between published and measured values \[1/s\].
fn distance(rows: &[Row], of: impl Fn(&Row) -> Option<Complex<f64>>) -> f64 {
    let off: Vec<f64> = rows.iter().filter_map(|row| Some((of(row)? - row.published?).norm_sqr())).collect();
    (off.iter().sum::<f64>() / off.len() as f64).sqrt()
}

/// Intervals of the decay wider than this are hardly informative \[1/s\].
const WIDE_1_S: f64 = 2.0;

fn verdict(rows: &[Row]) -> String {
    let all = rows.len();
    let ([re, im], [perfect_re, perfect_im]) = (inside(rows, |r| r.fitted), inside(rows, |r| r.perfect));
    let narrow: Vec<&Row> =
        rows.iter().filter(|r| r.measured.decay_1_s[2] - r.measured.decay_1_s[1] <= WIDE_1_S).collect();
    let offset = |row: &Row| row.offset.as_ref().map(|o| Complex::new(o.decay_1_s[0], o.frequency_rad_s[0]));
    let mode = |row: &Row| Some(Complex::new(row.measured.decay_1_s[0], row.measured.frequency_rad_s[0]));
    let between = |row: &&&Row| row.measured.frequency_between_rad_s.unwrap_or_default();
    let scatter = narrow.iter().max_by(|a, b| between(a).total_cmp(&between(b))).map_or(String::new(), |row| {
        format!(
            "- Repeats scatter more than their own errors allow, in frequency most at {:.2} m/s with K = {} ({:.2} rad/s). Why is\n  \
               not known; a linear bicycle has no such scatter.\n",
            row.measured.speed_m_s,
            row.measured.gain.unwrap_or_default(),
            between(&row),
        )
    });
    let modes = rows.iter().flat_map(|row| &row.modes);
    let (fast, slow) = modes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), re| (a.min(*re), b.max(*re)));
    format!(
        "- The model with the fitted motor lies in the intervals of {re} of {all} decays and {im} of {all} frequencies, with a\n  \
           perfect motor in {perfect_re} and {perfect_im}. In {} of {all} the decay is known within {WIDE_1_S:.0} 1/s; the others, at the ends of the\n  \
           speeds, hold about one period.\n\
         - Fitted with an offset alone the recordings give nearly the published values: {:.2} 1/s from them, root mean square,\n  \
           and {:.2} 1/s with the mode. The linear model has a decaying real mode (the caster, {slow:.1} to {fast:.1} 1/s) that a knock\n  \
           excites; left out, it goes into decay and frequency of the weave, most at low speed.\n{scatter}",
        narrow.len(),
        distance(rows, offset),
        distance(rows, mode),
    )
}
