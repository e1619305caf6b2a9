//! Refinement of the gains on the nonlinear bicycle. The perturbations of an experiment move a rider by several degrees of
//! roll and steer, where the linear response is off by a few per cent; a linear fit makes up for that with its gains.

use super::error::FitError;
use super::fit::{Fit, Problem, Residuals};
use super::objective::Objective;
use super::response::Hold;
use super::uncertainty::{Uncertainty, uncertainty};
use super::{AFTER_ONSET_S, GrayBox, PerGain, rightmost_real};
use physics::bicycle::{ForcePoint, Geometry};
use physics::perturbation::{SPEED_HOLD_S, nearest_steps};
use physics::ride::{Assist, Conditions, Perturbed, Push, ScheduleSpeed, perturbed};
use physics::rider::{Gains, Outside, Rider, Schedule};

/// Time constant with which the ride follows a recorded speed \[s\]: the noise of a wheel's sensor is averaged.
const FOLLOWED_S: f64 = 0.05;
/// Most steps of the refinement.
const MOST_STEPS: usize = 12;
/// Step that ends it, in standard errors of each gain.
const ENOUGH: f64 = 1e-3;
/// Relative step that ends it where the standard errors are smaller still: a record without noise.
const ENOUGH_RELATIVE: f64 = 1e-7;
/// Shortest fraction of a Gauss-Newton step.
const SHORTEST: f64 = 1.0 / 16.0;

/// Part of the time up to a fall that is refined first: what precedes the fall is far from the linear bicycle.
const PART: f64 = 0.5;

/// A nonlinear bicycle, pushed at a point.
#[derive(Clone, Debug)]
pub struct Pushed {
    /// The bicycle.
    pub bicycle: Geometry,
    /// Where the lateral force acts.
    pub point: ForcePoint,
    /// Forward speed at each sample, to which the ride is brought by pedalling \[m/s\]; empty for the model's speed.
    pub speeds_m_s: Vec<f64>,
}

/// Result of a refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The fit with the refined gains; its optima are those of the linear fit.
    pub fit: Fit,
    /// The nonlinear response: roll \[rad\], steer \[rad\] and roll rate \[rad/s\] at each sample.
    pub response: Vec<[f64; 3]>,
}

/// Response of the nonlinear bicycle to the record's disturbances, ridden with constant gains at a held speed; up to a fall.
fn response(problem: &Problem, pushed: &Pushed, gains: &PerGain) -> Option<Vec<[f64; 3]>> {
    let GrayBox { neuromuscular, speed_m_s, delay_s, .. } = problem.model;
    let disturbances = &problem.record.disturbances;
    let (steps_per_sample, step_s) = nearest_steps(delay_s, disturbances.sample_s);
    let schedule = Schedule::new(vec![(speed_m_s, Gains::of_states(gains))], Outside::Hold).ok()?;
    let delay_s = (delay_s / step_s).round() * step_s;
    let conditions = Conditions {
        rider: Some(Rider { schedule, delay_s, neuromuscular }),
        schedule_speed: ScheduleSpeed::Initial,
        step_s,
        ..Conditions::thesis(pushed.bicycle, Assist::None)
    };
    let samples = &disturbances.samples;
    let push = |k: usize| {
        let next = match disturbances.hold {
            Hold::Zero => samples[k],
            Hold::Linear => samples.get(k + 1).copied().unwrap_or(samples[k]),
        };
        let mean = |i: usize| (samples[k][i] + next[i]) / 2.0;
        let speed_m_s = pushed.speeds_m_s.get(k).copied().unwrap_or(speed_m_s);
        Push { lateral_force_n: mean(0), steer_torque_nm: mean(1), speed_m_s }
    };
    let pushes: Vec<Push> = (0..samples.len()).map(push).collect();
    let hold_s = if pushed.speeds_m_s.is_empty() { SPEED_HOLD_S } else { FOLLOWED_S };
    let how = Perturbed { point: pushed.point, steps_per_sample, speed_hold_s: Some(hold_s) };
    let start_m_s = pushes.first().map_or(speed_m_s, |push| push.speed_m_s);
    let ride = perturbed(&conditions, &how, start_m_s, &pushes);
    Some(ride.samples.iter().map(|x| [x.roll_rad, x.steer_rad, x.roll_rate_rad_s]).collect())
}

/// Gains with their nonlinear response and its residuals.
struct At {
    gains: PerGain,
    response: Vec<[f64; 3]>,
    residual: nalgebra::DVector<f64>,
}

/// Refines the gains of `fit` by Gauss-Newton steps with the residuals of the nonlinear bicycle and the derivatives of the
/// linear one. Standard errors are those of the linear model at the refined gains.
///
/// If the nonlinear bicycle falls with the fitted gains, they are first refined on a part of the record in which it is
/// upright, and so on with longer parts: gains of an unstable loop fit the linear bicycle, and fall on the other.
///
/// # Errors
/// The nonlinear bicycle falls whatever part is refined, or interrupted.
pub fn refine(
    problem: &Problem,
    pushed: &Pushed,
    fit: &Fit,
    stop: &impl Fn() -> bool,
) -> Result<Refined, FitError> {
    let (mut gains, mut before) = (fit.gains, 0);
    loop {
        let upright = response(problem, pushed, &gains).unwrap_or_default().len();
        if upright == problem.record.len() {
            break;
        }
        let time_s = upright as f64 * problem.record.disturbances.sample_s;
        let part =
            Problem { record: problem.record.first((upright as f64 * PART) as usize), ..problem.clone() };
        if upright <= before || part.check(&fit.active).is_err() {
            return Err(FitError::Falls { time_s });
        }
        before = upright;
        let objective = part.objective_of(&part.model, fit, &|_| true);
        gains = improved(&part, &objective, pushed, fit, &gains, stop)?.gains;
    }
    let objective = problem.objective_of(&problem.model, fit, &|_| true);
    let at = improved(problem, &objective, pushed, fit, &gains, stop)?;
    finished(problem, &objective, fit, at)
}

/// The gains reached from `start`, with which the bicycle must not fall.
fn improved(
    problem: &Problem,
    objective: &Objective,
    pushed: &Pushed,
    fit: &Fit,
    start: &PerGain,
    stop: &impl Fn() -> bool,
) -> Result<At, FitError> {
    let ridden = |gains: PerGain| -> Result<At, FitError> {
        let response = response(problem, pushed, &gains).unwrap_or_default();
        if response.len() < problem.record.len() {
            let time_s = response.len() as f64 * problem.record.disturbances.sample_s;
            return Err(FitError::Falls { time_s });
        }
        let residual = objective.residual(&response);
        Ok(At { gains, response, residual })
    };
    let mut here = ridden(*start)?;
    let errors = fit.standard_errors();
    for _ in 0..MOST_STEPS {
        if stop() {
            return Err(FitError::Interrupted);
        }
        let linear = objective.evaluate(&here.gains, &fit.active).ok_or(FitError::Unbounded)?;
        let Some(step) = gauss_newton(&linear.jacobian, &here.residual) else { break };
        let mut share = 1.0;
        let better = loop {
            let mut gains = here.gains;
            fit.active.iter().zip(step.iter()).for_each(|(gain, s)| gains[*gain] += share * s);
            let there = ridden(gains).ok();
            if let Some(there) = there.filter(|there| there.residual.norm() < here.residual.norm()) {
                break Some(there);
            }
            share /= 2.0;
            if share < SHORTEST {
                break None;
            }
        };
        let Some(there) = better else { break };
        here = there;
        let small = |(gain, s): (&usize, &f64)| {
            s.abs() < ENOUGH * errors[*gain] || s.abs() < ENOUGH_RELATIVE * here.gains[*gain].abs()
        };
        if fit.active.iter().zip(step.iter()).all(small) {
            break;
        }
    }
    Ok(here)
}

fn gauss_newton(
    jacobian: &nalgebra::DMatrix<f64>,
    residual: &nalgebra::DVector<f64>,
) -> Option<nalgebra::DVector<f64>> {
    let (q, r) = jacobian.clone().qr().unpack();
    r.solve_upper_triangular(&q.tr_mul(residual))
}

fn finished(problem: &Problem, objective: &Objective, fit: &Fit, at: At) -> Result<Refined, FitError> {
    let mut evaluation = objective.evaluate(&at.gains, &fit.active).ok_or(FitError::Unbounded)?;
    evaluation.residual = at.residual;
    let Uncertainty { covariance, independent, condition } =
        uncertainty(objective, &evaluation, problem.record.disturbances.sample_s)
            .ok_or_else(|| FitError::Inseparable(super::fit::names(&fit.active)))?;
    let means = objective.mean_squares(&evaluation);
    let after = problem.record.after_onsets(AFTER_ONSET_S);
    let of = |within: &dyn Fn(usize) -> bool| {
        let vafs = objective.vaf_of(&at.response, within);
        problem.record.measured.iter().map(|measured| measured.signal).zip(vafs).collect::<Vec<_>>()
    };
    let residuals = means.into_iter().zip(independent);
    Ok(Refined {
        fit: Fit {
            active: fit.active.clone(),
            gains: at.gains,
            covariance,
            vaf: of(&|_| true),
            vaf_after_onset: fit.vaf_after_onset.is_some().then(|| of(&|k| after[k])),
            residuals: residuals
                .map(|(mean_square, independent)| Residuals { mean_square, independent })
                .collect(),
            condition,
            rightmost_1_s: rightmost_real(&problem.model, &at.gains),
            optima: fit.optima.clone(),
        },
        response: at.response,
    })
}
