//! Reduction of the feedback: the gains that a record needs (Kuipers 2020, section 2.1.3, eqs 2.13 to 2.15).

use super::descent::descend;
use super::error::FitError;
use super::fit::{Fit, From, Problem};
use rayon::prelude::*;

/// Parts into which a record is divided for cross-validation.
const FOLDS: usize = 4;

/// One step of the reduction.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The fit with the gains that are left.
    pub fit: Fit,
    /// The gain with the highest relative variance, which the next step is without, and that variance.
    pub weakest: (usize, f64),
    /// Information criteria, with the number of independent residuals of the full fit; less is better.
    pub criteria: Criteria,
    /// Variance accounted for of data that was not fitted, the mean of the signals; `None` if a part of the record can't be
    /// fitted alone.
    pub cross_validated_vaf: Option<f64>,
}

/// Criteria for the number of gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria {
    /// Akaike's: [`Fit::deviance`] and two for each gain.
    pub aic: f64,
    /// Bayes's: [`Fit::deviance`] and the logarithm of the number of independent residuals for each gain.
    pub bic: f64,
}

impl Criteria {
    fn new(fit: &Fit, independent: &[f64]) -> Self {
        let (deviance, gains) = (fit.deviance(independent), fit.active.len() as f64);
        Self { aic: deviance + 2.0 * gains, bic: deviance + gains * libm::log(independent.iter().sum()) }
    }
}

/// Criterion that selects a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Select {
    /// The first step: all gains.
    Full,
    /// The last step with at least this variance accounted for, from 0 to 1.
    Vaf(f64),
    /// The same of the variance after the perturbations' onsets: what decides between recovery and fall.
    Onset(f64),
    /// Lowest information criterion of Akaike.
    Aic,
    /// Lowest information criterion of Bayes.
    Bic,
    /// Highest cross-validated variance accounted for.
    CrossValidated,
}

impl Select {
    /// Index of the selected step; the first if none fulfils the criterion.
    pub fn index(self, steps: &[Step]) -> usize {
        let least = |of: &dyn Fn(&Step) -> f64| {
            let order = |a: &usize, b: &usize| of(&steps[*a]).total_cmp(&of(&steps[*b]));
            (0..steps.len()).min_by(order).unwrap_or(0)
        };
        let last = |enough: &dyn Fn(&Step) -> bool| {
            steps.iter().take_while(|step| enough(step)).count().saturating_sub(1)
        };
        match self {
            Self::Full => 0,
            Self::Vaf(vaf) => last(&|step| step.fit.mean_vaf() >= vaf),
            Self::Onset(vaf) => last(&|step| step.fit.mean_vaf_after_onset().is_some_and(|of| of >= vaf)),
            Self::Aic => least(&|step| step.criteria.aic),
            Self::Bic => least(&|step| step.criteria.bic),
            Self::CrossValidated => least(&|step| -step.cross_validated_vaf.unwrap_or(f64::NEG_INFINITY)),
        }
    }
}

/// From the full fit to fits with fewer and fewer gains: each step is without the gain whose variance, relative to its
/// square, is highest. Ends where fewer gains give no bounded response, below the variance accounted for `until` (from 0 to 1), that step included, or at one gain.
///
/// # Errors
/// Interrupted.
pub fn reduce(
    problem: &Problem,
    full: Fit,
    until: f64,
    stop: &(impl Fn() -> bool + Sync),
) -> Result<Vec<Step>, FitError> {
    let mut steps = Vec::new();
    let independent: Vec<f64> = full.residuals.iter().map(|residuals| residuals.independent).collect();
    let mut fit = full;
    loop {
        let variances = fit.relative_variances();
        let Some(weakest) = variances.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Ok(steps);
        };
        let ends = fit.mean_vaf() < until || fit.active.len() == 1;
        let (mut start, mut active) = (fit.gains, fit.active.clone());
        start[weakest.0] = 0.0;
        active.retain(|gain| *gain != weakest.0);
        let cross_validated_vaf = cross_validated(problem, &fit);
        let criteria = Criteria::new(&fit, &independent);
        steps.push(Step { fit, weakest, criteria, cross_validated_vaf });
        if ends {
            return Ok(steps);
        }
        if stop() {
            return Err(FitError::Interrupted);
        }
        // Without the gain the response may be unbounded: then the search is global again.
        let next = problem
            .fit(&active, From::Gains(&start), stop)
            .or_else(|_| problem.fit(&active, From::Everywhere, stop));
        match next {
            Ok(next) => fit = next,
            Err(FitError::Interrupted) => return Err(FitError::Interrupted),
            Err(_) => return Ok(steps),
        }
    }
}

/// Mean over signals and parts of the variance accounted for of a part by gains that are fitted to the others.
fn cross_validated(problem: &Problem, fit: &Fit) -> Option<f64> {
    let count = problem.record.len();
    let part = |k: usize| k * FOLDS / count;
    let of = |fold: usize| {
        let objective = problem.objective_of(&problem.model, fit, &|k| part(k) != fold);
        let gains = descend(&objective, &fit.active, &fit.gains)?.gains;
        let held_out = problem.objective_of(&problem.model, fit, &|k| part(k) == fold);
        let vaf = held_out.vaf(&gains, &|_| true)?;
        Some(vaf.iter().sum::<f64>() / vaf.len() as f64)
    };
    let vafs: Vec<Option<f64>> = (0..FOLDS).into_par_iter().map(of).collect();
    let vafs: Option<Vec<f64>> = vafs.into_iter().collect();
    vafs.map(|vafs| vafs.iter().sum::<f64>() / FOLDS as f64)
}
