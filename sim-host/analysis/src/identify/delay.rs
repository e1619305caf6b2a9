//! What a record tells about the neural delay: the likelihood of each delay with its own best gains.

use super::descent::descend;
use super::error::FitError;
use super::fit::{Fit, Problem};
use super::gray_box::PerGain;
use super::uncertainty::uncertainty;
use nalgebra::DMatrix;

/// Half of the 95 % quantile of chi-squared with one degree of freedom: the drop of the log-likelihood at the ends of a
/// 95 % interval (Wilks 1938).
pub const DROP_95: f64 = 3.841_458_820_694_124 / 2.0;
/// Half the step of the derivative with respect to the delay \[s\].
const DIFFERENCE_S: f64 = 5e-4;
/// Refinements of the best delay.
const REFINEMENTS: usize = 4;

/// One delay of the profile.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayPoint {
    /// The delay \[s\].
    pub delay_s: f64,
    /// The best gains with this delay.
    pub gains: PerGain,
    /// Drop of the log-likelihood below the best delay's, for residuals as correlated as those of the best delay.
    pub drop: f64,
    /// Mean of the signals' variance accounted for.
    pub vaf: f64,
}

/// Profile likelihood of the delay.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayProfile {
    /// The delays, rising, with the best one among them.
    pub points: Vec<DelayPoint>,
    /// The best delay \[s\].
    pub estimate_s: f64,
    /// Ends of the 95 % interval \[s\]; `None` where it reaches beyond the profile.
    pub interval_s: [Option<f64>; 2],
}

/// The best gains with one delay, and the logarithm of the likelihood of white residuals.
struct At {
    delay_s: f64,
    gains: PerGain,
    likelihood: f64,
    vaf: f64,
}

fn at(problem: &Problem, fit: &Fit, delay_s: f64, start: &PerGain) -> Option<At> {
    let mut model = problem.model;
    model.delay_s = delay_s;
    let objective = problem.objective_of(&model, fit, &|_| true);
    let gains = descend(&objective, &fit.active, start)?.gains;
    let means = objective.mean_squares(&objective.evaluate(&gains, &[])?);
    let half = |(mean, length): (f64, usize)| length as f64 / 2.0 * libm::log(mean.max(f64::MIN_POSITIVE));
    let likelihood = -means.into_iter().zip(objective.lengths()).map(half).sum::<f64>();
    let vaf = objective.vaf(&gains, &|_| true)?;
    Some(At { delay_s, gains, likelihood, vaf: vaf.iter().sum::<f64>() / vaf.len() as f64 })
}

/// Variance of the delay with the residuals' own covariance over that with white residuals: the factor by which likelihoods of
/// white residuals tell too much (Kent 1982). `None` if the delay can't be separated from the gains.
fn overstatement(problem: &Problem, fit: &Fit, best: &At) -> Option<f64> {
    let of = |delay_s: f64, active: &[usize]| {
        let mut model = problem.model;
        model.delay_s = delay_s;
        let objective = problem.objective_of(&model, fit, &|_| true);
        let at = objective.evaluate(&best.gains, active)?;
        Some((objective, at))
    };
    let (low, high) = ((best.delay_s - DIFFERENCE_S).max(0.0), best.delay_s + DIFFERENCE_S);
    let ((_, before), (_, after)) = (of(low, &[])?, of(high, &[])?);
    let (objective, mut at) = of(best.delay_s, &fit.active)?;
    let last = at.jacobian.ncols();
    at.jacobian = at.jacobian.insert_column(last, 0.0);
    at.jacobian.set_column(last, &((before.residual - after.residual) / (high - low)));
    let own = uncertainty(&objective, &at, problem.record.disturbances.sample_s)?.covariance[(last, last)];
    let normal = at.jacobian.tr_mul(&at.jacobian);
    let scale = normal.diagonal().map(|x| x.sqrt().recip());
    let scaled = DMatrix::from_fn(last + 1, last + 1, |i, j| normal[(i, j)] * scale[i] * scale[j]);
    let white = scaled.cholesky()?.inverse()[(last, last)] * scale[last].powi(2);
    let mean_square = at.residual.norm_squared() / at.residual.len() as f64;
    Some(own / (white * mean_square)).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
}

/// Vertex of the parabola through three points.
fn vertex(points: [(f64, f64); 3]) -> Option<f64> {
    let [(a, fa), (b, fb), (c, fc)] = points;
    let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
    let curvature = (right - left) / (c - a);
    (curvature < 0.0).then(|| ((a + b) / 2.0 - left / (2.0 * curvature)).clamp(a, c))
}

/// The profile over `delays_s`, rising, for the gains of `fit`. Each delay starts from the gains of its neighbour towards
/// the delay of `problem`. Delays whose response is unbounded from there are left out. `finished` is called after each
/// delay.
///
/// # Errors
/// No delay can be fitted, or interrupted.
pub fn delay_profile(
    problem: &Problem,
    fit: &Fit,
    delays_s: &[f64],
    finished: &(impl Fn() + Sync),
    stop: &(impl Fn() -> bool + Sync),
) -> Result<DelayProfile, FitError> {
    let walk = |delays: &mut dyn Iterator<Item = f64>| {
        let (mut points, mut gains) = (Vec::new(), fit.gains);
        for delay_s in delays {
            if stop() {
                break;
            }
            if let Some(point) = at(problem, fit, delay_s, &gains) {
                gains = point.gains;
                points.push(point);
            }
            finished();
        }
        points
    };
    let from = problem.model.delay_s;
    let (below, above): (Vec<f64>, Vec<f64>) = delays_s.iter().partition(|delay| **delay < from);
    let (mut points, above) =
        rayon::join(|| walk(&mut below.into_iter().rev()), || walk(&mut above.into_iter()));
    points.reverse();
    points.extend(above);
    if stop() {
        return Err(FitError::Interrupted);
    }
    let best = |points: &[At]| {
        (0..points.len()).max_by(|a, b| points[*a].likelihood.total_cmp(&points[*b].likelihood))
    };
    for _ in 0..REFINEMENTS {
        let Some(top) = best(&points) else { break };
        if top == 0 || top + 1 >= points.len() {
            break;
        }
        let three = [top - 1, top, top + 1].map(|i| (points[i].delay_s, points[i].likelihood));
        let Some(delay_s) = vertex(three) else { break };
        let near = points.iter().any(|point| (point.delay_s - delay_s).abs() < 1e-6);
        let Some(refined) = (!near).then(|| at(problem, fit, delay_s, &points[top].gains)).flatten() else {
            break;
        };
        points.push(refined);
        points.sort_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
    }
    let top = best(&points).ok_or(FitError::Unbounded)?;
    let highest = points[top].likelihood;
    let overstated = overstatement(problem, fit, &points[top]).unwrap_or(1.0);
    let drop = |point: &At| (highest - point.likelihood) / overstated;
    // Linear in the root of the drop, which is linear in the delay for a parabola.
    let crossing = |inside: &At, outside: &At| {
        let [a, b] = [inside, outside].map(|point| drop(point).max(0.0).sqrt());
        let share = (DROP_95.sqrt() - a) / (b - a);
        inside.delay_s + share * (outside.delay_s - inside.delay_s)
    };
    let end = |indices: &mut dyn Iterator<Item = usize>| {
        let mut inside = top;
        for i in indices {
            if drop(&points[i]) > DROP_95 {
                return Some(crossing(&points[inside], &points[i]));
            }
            inside = i;
        }
        None
    };
    let interval_s = [end(&mut (0..top).rev()), end(&mut (top + 1..points.len()))];
    let point = |at: &At| DelayPoint { delay_s: at.delay_s, gains: at.gains, drop: drop(at), vaf: at.vaf };
    Ok(DelayProfile {
        estimate_s: points[top].delay_s,
        points: points.iter().map(point).collect(),
        interval_s,
    })
}
