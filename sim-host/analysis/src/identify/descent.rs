//! Levenberg-Marquardt search in the time domain.

use super::gray_box::PerGain;
use super::objective::{Evaluation, Objective};
use nalgebra::{DMatrix, DVector};

/// Where a search ended.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) gains: PerGain,
    /// Sum of the squared residuals, in units of each signal's noise.
    pub(super) cost: f64,
}

const MOST_STEPS: usize = 60;
/// Relative decrease of the cost that ends the search for gains.
pub(super) const ENOUGH: f64 = 1e-10;
/// The same of a search for the cost alone: near its minimum it changes with the square of the gains.
pub(super) const ENOUGH_FOR_COST: f64 = 1e-7;
/// Relative decrease of the cost from which on the curvature of the residuals is used.
const NEAR: f64 = 1e-2;

/// The part of the Hessian that the Gauss-Newton matrix lacks, from the residuals' curvature, by the secant update of Dennis, Gay and
/// Welsch (1981). With large residuals the search converges linearly without it.
struct Curvature(DMatrix<f64>);

impl Curvature {
    fn none(gains: usize) -> Self {
        Self(DMatrix::zeros(gains, gains))
    }

    /// After a step from `here` to `there`.
    fn update(&mut self, step: &DVector<f64>, here: &Evaluation, there: &Evaluation) {
        let by_curvature = (&here.jacobian - &there.jacobian).tr_mul(&there.residual);
        let change = here.gradient() - there.gradient();
        let along = change.dot(step);
        if along <= 0.0 {
            return;
        }
        let known = step.dot(&(&self.0 * step)).abs();
        let size = if known > 0.0 { (step.dot(&by_curvature).abs() / known).min(1.0) } else { 1.0 };
        self.0 *= size;
        let missing = by_curvature - &self.0 * step;
        let both = &missing * change.transpose();
        let twice = step.dot(&missing) / along;
        self.0 += (&both + both.transpose() - &change * change.transpose() * twice) / along;
    }
}

impl Evaluation {
    /// Half the decrease of the cost per unit of each gain.
    fn gradient(&self) -> DVector<f64> {
        self.jacobian.tr_mul(&self.residual)
    }
}

/// The damped step of a model of the cost, in units in which `normal` has a diagonal of ones; `None` if it has no minimum.
fn step(
    normal: &DMatrix<f64>,
    curvature: &DMatrix<f64>,
    gradient: &DVector<f64>,
    damping: f64,
) -> Option<DVector<f64>> {
    let scale = normal.diagonal().map(|x| if x > 0.0 { x.sqrt().recip() } else { 0.0 });
    let mut damped = DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
        (normal[(i, j)] + curvature[(i, j)]) * (scale[i] * scale[j])
    });
    for i in 0..scale.len() {
        damped[(i, i)] += damping + 1e-14;
    }
    Some(damped.cholesky()?.solve(&gradient.component_mul(&scale)).component_mul(&scale))
}

/// The minimum over the gains `active` that is reached from `start`; `None` if the response there is unbounded. Steps to an
/// unbounded response are not taken.
pub(super) fn descend(objective: &Objective, active: &[usize], start: &PerGain) -> Option<Found> {
    descend_until(ENOUGH, objective, active, start)
}

/// The same until a step decreases the cost by less than `enough` of it.
pub(super) fn descend_until(
    enough: f64,
    objective: &Objective,
    active: &[usize],
    start: &PerGain,
) -> Option<Found> {
    let mut gains = *start;
    let mut here = objective.evaluate(&gains, active)?;
    let (mut damping, mut accepted, mut near) = (1e-3, true, false);
    let none = Curvature::none(active.len());
    let mut curvature = Curvature::none(active.len());
    for _ in 0..MOST_STEPS {
        let (normal, gradient) = (here.jacobian.tr_mul(&here.jacobian), here.gradient());
        let curved = if near { step(&normal, &curvature.0, &gradient, damping) } else { None };
        near = curved.is_some();
        let Some(step) = curved.or_else(|| step(&normal, &none.0, &gradient, damping)) else { break };
        let mut next = gains;
        active.iter().zip(step.iter()).for_each(|(place, s)| next[*place] += s);
        // After a rejected step the cost first: the next one is likely to be rejected, too, and needs no Jacobian then.
        let evaluated = objective.evaluate(&next, if accepted { active } else { &[] });
        let better = evaluated.filter(|there| there.cost() < here.cost());
        let derived = accepted;
        accepted = better.is_some();
        let Some(there) = better else {
            if !near {
                damping *= 5.0;
            }
            near = false;
            if damping > 1e10 {
                break;
            }
            continue;
        };
        let gained = here.cost() - there.cost();
        let ends = gained < enough * here.cost();
        gains = next;
        damping = (damping / 10.0).max(1e-12);
        if ends {
            return Some(Found { gains, cost: there.cost() });
        }
        let there = if derived { there } else { objective.evaluate(&gains, active)? };
        curvature.update(&step, &here, &there);
        near = gained < NEAR * here.cost();
        here = there;
    }
    Some(Found { gains, cost: here.cost() })
}
