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
/// Relative decrease of the cost that ends the search.
const ENOUGH: f64 = 1e-10;

/// Gauss-Newton matrix and gradient, in units in which the matrix has a diagonal of ones.
struct Scaled {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    scale: DVector<f64>,
}

fn scaled(at: &Evaluation) -> Scaled {
    let mut matrix = at.jacobian.tr_mul(&at.jacobian);
    let scale = matrix.diagonal().map(|x| if x > 0.0 { x.sqrt().recip() } else { 0.0 });
    for (i, j) in (0..scale.len()).flat_map(|i| (0..scale.len()).map(move |j| (i, j))) {
        matrix[(i, j)] *= scale[i] * scale[j];
    }
    let gradient = at.jacobian.tr_mul(&at.residual).component_mul(&scale);
    Scaled { matrix, gradient, scale }
}

/// The minimum over the gains `active` that is reached from `start`; `None` if the response there is unbounded. Steps to an
/// unbounded response are not taken.
pub(super) fn descend(objective: &Objective, active: &[usize], start: &PerGain) -> Option<Found> {
    let mut gains = *start;
    let mut here = objective.evaluate(&gains, active)?;
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let Scaled { matrix, gradient, scale } = scaled(&here);
        let mut damped = matrix;
        for i in 0..scale.len() {
            damped[(i, i)] += damping + 1e-14;
        }
        let Some(step) = damped.cholesky().map(|c| c.solve(&gradient).component_mul(&scale)) else { break };
        let mut next = gains;
        active.iter().zip(step.iter()).for_each(|(place, s)| next[*place] += s);
        // The cost first: most rejected steps need no Jacobian.
        let better = objective.evaluate(&next, &[]).filter(|there| there.cost() < here.cost());
        let Some(there) = better else {
            damping *= 5.0;
            if damping > 1e10 {
                break;
            }
            continue;
        };
        let gained = here.cost() - there.cost();
        let enough = gained < ENOUGH * here.cost();
        gains = next;
        damping = (damping / 10.0).max(1e-12);
        if enough {
            return Some(Found { gains, cost: there.cost() });
        }
        here = objective.evaluate(&gains, active)?;
    }
    Some(Found { gains, cost: here.cost() })
}
