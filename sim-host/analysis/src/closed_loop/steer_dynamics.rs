//! Inertia and friction of the steer axis: the second row of the linear equations of motion (Meijaard et al. 2007,
//! equation 5.3) with viscous and Coulomb friction,
//!
//! ```text
//! inertia * steer accel + viscous * steer rate + coulomb * sign(steer rate) + (rest) = torque
//! ```
//!
//! where the rest are roll acceleration, roll rate times speed, roll angle, steer angle, steer angle times speed squared and
//! a constant, each with a free coefficient. Where a controller made the torque from these same signals, the equation has a
//! second solution: the controller's law, with no inertia. Two regressions show which one the recording holds. That of the
//! torque on the motion is biased towards the law and a small inertia; that of the acceleration on the torque and the other
//! terms is not explained by the torque, and biased towards a large one. If both agree, the torque was rich enough to move the
//! steer against its inertia; if not, the inertia is not identified.

use super::Part;
use super::checked::{Checked, FEWEST, SHORTEST_S};
use super::collinear::{inflation, separable};
use super::record::{Record, Signal};
use super::regress::{Fit, Weights, regress};
use super::smooth::smooth;
use crate::weave::Estimate;
use nalgebra::{DMatrix, DVector};

/// Slowest speed \[m/s\]: below, the tyres' scrub is another friction.
const SLOWEST_M_S: f64 = 0.8;
/// Largest angle of the linear equations \[rad\], and fastest rate \[rad/s\].
const MOST: (f64, f64) = (0.6, 8.0);
/// Half of the window of the smoothing \[s\]: motion up to about 4 Hz.
const HALF_S: f64 = 0.08;
/// Time over which residuals are correlated \[s\].
const MEMORY_S: f64 = 1.0;
/// Steer rate at which the friction has nearly its full value \[rad/s\].
const SLIDING_RAD_S: f64 = 0.1;
/// Before the torque ends the bicycle is caught by hand or by its supports \[s\].
const CAUGHT_S: f64 = 1.0;
/// Largest variance inflation of the torque by the signals that a law uses: a tenth of it must be its own.
const MOST_INFLATION: f64 = 10.0;
/// The two regressions may differ by this factor.
const AGREEMENT: f64 = 3.0;

/// A number between two regressions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Bracket {
    /// By the regression of the torque on the motion.
    pub of_torque: Estimate,
    /// By the regression of the acceleration on the torque.
    pub of_motion: Estimate,
    /// Lower end of both 95 % intervals.
    pub low: f64,
    /// Upper end of both 95 % intervals.
    pub high: f64,
}

impl Bracket {
    fn new(of_torque: Estimate, of_motion: Estimate) -> Self {
        let (low, high) = (of_torque.low.min(of_motion.low), of_torque.high.max(of_motion.high));
        Self { of_torque, of_motion, low, high }
    }
}

/// Inertia and friction.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct SteerDynamics {
    /// Effective inertia about the steer axis \[kg m²\].
    pub inertia_kg_m2: Bracket,
    /// Viscous friction, with the tyres' part of it \[N m s/rad\].
    pub viscous_nm_s_rad: Bracket,
    /// Coulomb friction \[N m\].
    pub coulomb_nm: Bracket,
    /// Explained fraction of the variance of the torque.
    pub vaf: f64,
    /// Explained fraction of the variance of the steer acceleration.
    pub vaf_motion: f64,
    /// Duration of the samples used \[s\].
    pub seconds: f64,
}

/// Estimates inertia and friction.
pub fn steer_dynamics(record: &Record, checked: &Checked) -> Part<SteerDynamics> {
    let Some(steer) = record.channel(Signal::Steer) else {
        return Part::not("no steer angle is recorded");
    };
    let Terms { rows, columns, of_law, torque } = Terms::new(record, checked, steer);
    let seconds = rows.len() as f64 * checked.period_s;
    if rows.len() < FEWEST || seconds < SHORTEST_S {
        return Part::not(format!(
            "it rides for {seconds:.1} s at {SLOWEST_M_S} m/s or more with a known torque"
        ));
    }
    // Inertia and friction are always kept: they are the question.
    let (kept, _) = separable(&columns);
    if !(0..3).all(|j| kept.contains(&j)) {
        return Part::not(
            "the steer hardly moves, or only as one sine: inertia and friction are not separable",
        );
    }
    let own = inflation(&of_law, &torque);
    if own > MOST_INFLATION {
        return Part::not(format!(
            "the controller made {:.1} % of the torque from roll, steer angle and their rates: the relation of torque and \
             motion is its law's and not the bicycle's. A torque of its own beside the law would show the inertia",
            100.0 * (1.0 - 1.0 / own)
        ));
    }
    let kept_columns = columns.select_columns(&kept);
    let memory = checked.samples(MEMORY_S);
    let of_torque = fit(&kept_columns, &torque, memory);
    let mut swapped = kept_columns.clone();
    swapped.set_column(0, &torque);
    let of_motion = fit(&swapped, &kept_columns.column(0).into_owned(), memory);
    let (Some(of_torque), Some(of_motion)) = (of_torque, of_motion) else {
        return Part::not("the motion of the steer is linearly dependent on roll and speed");
    };
    let inverse = of_motion.estimate(0);
    if inverse.low <= 0.0 {
        return Part::not(format!(
            "the steer acceleration does not follow the torque ({} rad/s² per N m, interval {} to {})",
            digits(inverse.value),
            digits(inverse.low),
            digits(inverse.high)
        ));
    }
    let moved = Estimate {
        value: 1.0 / inverse.value,
        standard_error: inverse.standard_error / (inverse.value * inverse.value),
        low: 1.0 / inverse.high,
        high: 1.0 / inverse.low,
    };
    let inertia = Bracket::new(of_torque.estimate(0), moved);
    if inertia.low <= 0.0 || inertia.high > AGREEMENT * inertia.low {
        return Part::not(format!(
            "the two regressions do not agree: inertia {} (of the torque; {} to {}) and {} kg m² (of the motion; {} to {})",
            digits(inertia.of_torque.value),
            digits(inertia.of_torque.low),
            digits(inertia.of_torque.high),
            digits(inertia.of_motion.value),
            digits(inertia.of_motion.low),
            digits(inertia.of_motion.high)
        ));
    }
    let negative = |ratio: Estimate| Estimate {
        value: -ratio.value,
        low: -ratio.high,
        high: -ratio.low,
        standard_error: ratio.standard_error,
    };
    let bracket = |i| Bracket::new(of_torque.estimate(i), negative(of_motion.ratio(i, 0)));
    Part::Found(SteerDynamics {
        inertia_kg_m2: inertia,
        viscous_nm_s_rad: bracket(1),
        coulomb_nm: bracket(2),
        vaf: of_torque.vaf,
        vaf_motion: of_motion.vaf,
        seconds,
    })
}

fn fit(columns: &DMatrix<f64>, y: &DVector<f64>, memory: usize) -> Option<Fit> {
    // The fast motions at a start or a push hold the information: no robust weights.
    regress(&columns.clone().insert_column(columns.ncols(), 1.0), y, Weights::Equal, memory)
}

fn digits(x: f64) -> String {
    format!("{x:.3}")
}

/// The terms of the equation at the usable samples.
struct Terms {
    rows: Vec<usize>,
    columns: DMatrix<f64>,
    /// The signals of a law.
    of_law: DMatrix<f64>,
    torque: DVector<f64>,
}

impl Terms {
    fn new(record: &Record, checked: &Checked, steer: &[f64]) -> Self {
        let half = checked.samples(HALF_S);
        let smooth =
            |values: &[f64], derivative| smooth(values, checked.period_s, half, derivative, &checked.breaks);
        let speed = &record.speed_m_s;
        let of_speed = |values: &[f64], power: i32| -> Vec<f64> {
            values.iter().zip(speed).map(|(value, v)| value * v.powi(power)).collect()
        };
        let rate = smooth(steer, 1);
        let friction: Vec<f64> = rate.iter().map(|rate| libm::tanh(rate / SLIDING_RAD_S)).collect();
        let mut terms = vec![smooth(steer, 2), rate.clone(), smooth(&friction, 0), smooth(steer, 0)];
        terms.push(smooth(&of_speed(steer, 2), 0));
        if let Some(roll_rate) = record.channel(Signal::RollRate) {
            terms.extend([smooth(roll_rate, 1), smooth(&of_speed(roll_rate, 1), 0)]);
        }
        terms.extend(record.channel(Signal::Roll).map(|roll| smooth(roll, 0)));
        // All but acceleration, friction and roll acceleration.
        let mut of_law: Vec<Vec<f64>> = vec![rate.clone(), terms[3].clone(), terms[4].clone()];
        if let Some(roll_rate) = record.channel(Signal::RollRate) {
            of_law.extend([smooth(roll_rate, 0), terms[6].clone()]);
        }
        of_law.extend(record.channel(Signal::Roll).map(|roll| smooth(roll, 0)));
        let torque = smooth(&record.torque_nm, 0);
        let acted = acted(record, checked, half);
        let usable = |i: &usize| {
            let i = *i;
            acted[i]
                && checked.plausible[i]
                && speed[i] >= SLOWEST_M_S
                && steer[i].abs() <= MOST.0
                && rate[i].abs() <= MOST.1
                && torque[i].is_finite()
                && terms.iter().all(|term| term[i].is_finite())
        };
        let rows: Vec<usize> = (0..steer.len()).filter(usable).collect();
        Self {
            columns: DMatrix::from_fn(rows.len(), terms.len(), |i, j| terms[j][rows[i]]),
            of_law: DMatrix::from_fn(rows.len(), of_law.len(), |i, j| of_law[j][rows[i]]),
            torque: DVector::from_iterator(rows.len(), rows.iter().map(|row| torque[*row])),
            rows,
        }
    }
}

/// From the first torque that is not zero to [`CAUGHT_S`] before the last, without the torque's limit.
fn acted(record: &Record, checked: &Checked, margin: usize) -> Vec<bool> {
    let torque_nm = &record.torque_nm;
    let acts = |torque: &f64| torque.is_finite() && *torque != 0.0;
    let first = torque_nm.iter().position(acts).unwrap_or(0).saturating_sub(margin);
    let last = torque_nm.iter().rposition(acts).unwrap_or(0).saturating_sub(checked.samples(CAUGHT_S));
    let mut acted: Vec<bool> = (0..torque_nm.len()).map(|i| (first..=last).contains(&i)).collect();
    for i in (0..torque_nm.len()).filter(|i| checked.at_limit(torque_nm[*i])) {
        let to = (i + margin + 1).min(acted.len());
        acted[i.saturating_sub(margin)..to].fill(false);
    }
    acted
}
