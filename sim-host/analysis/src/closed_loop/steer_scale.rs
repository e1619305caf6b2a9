//! Scale and offset of the steer angle from the kinematics of the bicycle, without any model of the loop.
//!
//! A bicycle whose wheels roll without slip yaws, for small angles, with (Meijaard et al. 2007, equation B6)
//!
//! ```text
//! yaw rate = cos(tilt) / wheelbase * (speed * steer angle + trail * steer rate)
//! ```
//!
//! The recorded angle is regressed on it as `scale * angle + offset`. Scale and speed have only their product here: a
//! speed that is wrong by the same factor looks the same.

use super::Part;
use super::checked::{Checked, FEWEST, SHORTEST_S};
use super::collinear::separable;
use super::record::{Record, Signal};
use super::regress::{Weights, regress};
use super::smooth::smooth;
use crate::weave::Estimate;
use nalgebra::{DMatrix, DVector};

/// The bicycle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Geometry {
    /// Wheelbase \[m\].
    pub wheelbase_m: f64,
    /// Tilt of the steer axis \[rad\].
    pub tilt_rad: f64,
}

/// Slowest speed \[m/s\].
const SLOWEST_M_S: f64 = 1.0;
/// Largest angle: beyond, the tangent is 4 % more than the angle \[rad\].
const LARGEST_RAD: f64 = 0.35;
/// Half of the window of the smoothing \[s\].
const HALF_S: f64 = 0.05;
/// Time over which residuals are correlated \[s\].
const MEMORY_S: f64 = 1.0;
/// Half of the window over which a counted distance becomes a speed \[s\].
const COUNTED_S: f64 = 0.25;
/// An offset of the angle and a bias of the yaw rate are separable from this ratio of two speeds.
const TWO_SPEEDS: f64 = 1.5;
/// Least standard deviation of the yaw rate that the steer angle makes \[rad/s\].
const EXCITED_RAD_S: f64 = 0.005;
/// Agreement beyond that of any measured yaw rate: fraction of the variance.
const COMPUTED: f64 = 0.999_95;

/// Scale and offset of the steer angle.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct SteerScale {
    /// True angle over recorded angle, as `scale` in a map.
    pub scale: Estimate,
    /// True angle where the recording says zero, as `offset` in a map \[rad\].
    pub offset_rad: Estimate,
    /// Trail \[m\]; null without enough motion of the steer.
    pub trail_m: Option<Estimate>,
    /// Bias of the yaw rate \[rad/s\]; null if only one speed was ridden: then it is part of the offset.
    pub yaw_bias_rad_s: Option<Estimate>,
    /// Explained fraction of the variance of the yaw rate.
    pub vaf: f64,
    /// Fraction of the samples that follow.
    pub followed: f64,
    /// Duration of the samples used \[s\].
    pub seconds: f64,
}

/// Estimates scale and offset.
pub fn steer_scale(record: &Record, checked: &Checked, geometry: &Geometry) -> Part<SteerScale> {
    let (Some(steer), Some(yaw)) = (record.channel(Signal::Steer), record.channel(Signal::YawRate)) else {
        return Part::not("steer angle and yaw rate are not both recorded");
    };
    let half = checked.samples(HALF_S);
    let smooth = |values, derivative| smooth(values, checked.period_s, half, derivative, &checked.breaks);
    let (yaw, angle, rate) = (smooth(yaw, 0), smooth(steer, 0), smooth(steer, 1));
    let counted = record.distance_m.as_ref().map(|distance| {
        let half = checked.samples(COUNTED_S);
        super::smooth::smooth(distance, checked.period_s, half, 1, &checked.breaks)
    });
    let speed = counted.as_ref().unwrap_or(&record.speed_m_s);
    let usable = |i: &usize| {
        let (i, known) = (*i, yaw[*i] + angle[*i] + speed[*i]);
        known.is_finite() && checked.plausible[i] && speed[i] >= SLOWEST_M_S && angle[i].abs() <= LARGEST_RAD
    };
    let rows: Vec<usize> = (0..steer.len()).filter(usable).collect();
    let seconds = rows.len() as f64 * checked.period_s;
    if rows.len() < FEWEST || seconds < SHORTEST_S {
        return Part::not(format!(
            "it rides for {seconds:.1} s with a known yaw rate at {SLOWEST_M_S} m/s or more"
        ));
    }
    let factor = libm::cos(geometry.tilt_rad) / geometry.wheelbase_m;
    let x = DMatrix::from_fn(rows.len(), 4, |i, j| match (rows[i], j) {
        (row, 0) => factor * speed[row] * angle[row],
        (row, 1) => factor * rate[row],
        (row, 2) => factor * speed[row],
        _ => 1.0,
    });
    let turning = x.column(0).variance().sqrt();
    if turning < EXCITED_RAD_S {
        return Part::not(format!(
            "it rides straight: speed times steer angle changes by {turning:.4} rad/s only"
        ));
    }
    let (kept, _) = separable(&x.columns(0, 2).into_owned());
    let trail = kept.contains(&1);
    let speeds = rows.iter().map(|row| speed[*row]);
    let (slowest, fastest) =
        speeds.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let bias = fastest >= TWO_SPEEDS * slowest;
    let mut columns = vec![0, 2];
    columns.extend(bias.then_some(3));
    columns.extend(trail.then_some(1));
    let y = DVector::from_iterator(rows.len(), rows.iter().map(|row| yaw[*row]));
    let memory = checked.samples(MEMORY_S);
    let Some(fit) = regress(&x.select_columns(&columns), &y, Weights::Robust, memory) else {
        return Part::not("speed, steer angle and its rate are linearly dependent");
    };
    if fit.vaf_followed > COMPUTED {
        return Part::not(format!(
            "the yaw rate follows the steer angle to {:.3} %, more exactly than a gyro measures: it was computed from it",
            100.0 * fit.vaf_followed
        ));
    }
    Part::Found(SteerScale {
        scale: fit.estimate(0),
        offset_rad: fit.estimate(1),
        trail_m: trail.then(|| fit.ratio(columns.len() - 1, 0)),
        yaw_bias_rad_s: bias.then(|| fit.estimate(2)),
        vaf: fit.vaf,
        followed: fit.followed,
        seconds,
    })
}
