//! The whole identification of one record: impulse response, fit, reduction, selection, delay.

use super::delay::{DelayProfile, delay_profile};
use super::error::FitError;
use super::fir::{Fir, impulse_response};
use super::fit::{Fit, From, Problem};
use super::nonlinear::{Pushed, Refined, refine};
use super::reduction::{Select, Step, reduce};

/// Length of the impulse response \[s\].
pub const IMPULSE_RESPONSE_S: f64 = 4.0;

/// What to identify.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Indices of the gains of the full fit.
    pub gains: Vec<usize>,
    /// Variance accounted for, from 0 to 1, at which the reduction ends; `None` for no reduction.
    pub reduce_until: Option<f64>,
    /// Criterion that selects the gains.
    pub select: Select,
    /// Delays of the profile \[s\], rising; empty for no profile.
    pub delays_s: Vec<f64>,
    /// Whether the record's delay is the profile's best one, rounded to whole milliseconds, in place of the given one.
    pub estimate_delay: bool,
    /// The bicycle on which the selected gains are refined; `None` for those of the linear one.
    pub nonlinear: Option<Pushed>,
    /// Whether the impulse response's output is fitted in place of the measured signals.
    pub filter: bool,
}

/// Stages of an identification, each with what it finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Global search of the full fit.
    Search,
    /// Profile of the delay.
    Delay,
    /// Reduction of the gains.
    Reduction,
    /// Refinement on the nonlinear bicycle.
    Refinement,
}

/// An identified rider.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified {
    /// The problem as fitted: with the estimated delay and the filtered signals, if requested.
    pub problem: Problem,
    /// The full fit and the steps of the reduction.
    pub steps: Vec<Step>,
    /// Index of the selected step.
    pub selected: usize,
    /// The selected fit refined on the nonlinear bicycle, or why it is not; `None` if that was not asked for.
    pub refined: Option<Result<Refined, FitError>>,
    /// Profile of the delay.
    pub delay: Option<DelayProfile>,
    /// Impulse response of each signal; `None` if the record is too short for one.
    pub impulse_responses: Vec<Option<Fir>>,
}

impl Identified {
    /// The selected fit, refined if possible.
    pub fn fit(&self) -> &Fit {
        match &self.refined {
            Some(Ok(refined)) => &refined.fit,
            _ => &self.steps[self.selected].fit,
        }
    }

    /// Why the standard errors of [`Self::fit`] are not known; `None` if they are. If the requested refinement failed, the
    /// linear bicycle's error may be several times larger; an unstable loop is no linear function of its gains, and often
    /// the wrong one of several optima.
    pub fn errors_unknown(&self) -> Option<&'static str> {
        match &self.refined {
            Some(Err(_)) => Some("not refined on the nonlinear bicycle"),
            _ if !self.fit().is_stable() => Some("the closed loop of these gains is unstable"),
            _ => None,
        }
    }

    /// Response of the selected fit: roll \[rad\], steer \[rad\] and roll rate \[rad/s\] at each sample.
    pub fn response(&self) -> Vec<[f64; 3]> {
        match &self.refined {
            Some(Ok(refined)) => refined.response.clone(),
            _ => {
                let Problem { model, record, .. } = &self.problem;
                model.response(&record.disturbances, &self.fit().gains).unwrap_or_default()
            }
        }
    }
}

/// Identifies the rider of a record. `begins` is called at the start of each stage, `stop` interrupts.
///
/// # Errors
/// The record can't be fitted, or interrupted.
pub fn identify(
    mut problem: Problem,
    plan: &Plan,
    begins: &(impl Fn(Stage) + Sync),
    stop: &(impl Fn() -> bool + Sync),
) -> Result<Identified, FitError> {
    problem.check(&plan.gains)?;
    let response = |measured| impulse_response(&problem.record, measured, problem.drift, IMPULSE_RESPONSE_S);
    let impulse_responses: Vec<Option<Fir>> = problem.record.measured.iter().map(response).collect();
    if plan.filter {
        for (measured, fir) in problem.record.measured.iter_mut().zip(&impulse_responses) {
            let Some(fir) = fir else { return Err(FitError::NoImpulseResponse(measured.signal.name())) };
            measured.values.clone_from(&fir.response);
            measured.valid.fill(true);
        }
    }
    begins(Stage::Search);
    let mut full = problem.fit(&plan.gains, From::Everywhere, stop)?;
    let mut delay = None;
    if !plan.delays_s.is_empty() {
        begins(Stage::Delay);
        let profile = delay_profile(&problem, &full, &plan.delays_s, &|| (), stop)?;
        if plan.estimate_delay {
            problem.model.delay_s = (profile.estimate_s * 1e3).round() * 1e-3;
            let nearest = profile.points.iter().min_by(|a, b| {
                let far = |at: f64| (at - problem.model.delay_s).abs();
                far(a.delay_s).total_cmp(&far(b.delay_s))
            });
            let start = nearest.map_or(full.gains, |point| point.gains);
            full = problem
                .fit(&plan.gains, From::Gains(&start), stop)
                .or_else(|_| problem.fit(&plan.gains, From::Everywhere, stop))?;
        }
        delay = Some(profile);
    }
    let until = match plan.reduce_until {
        Some(until) => {
            begins(Stage::Reduction);
            until
        }
        // No fit accounts for more: the full fit is the only step.
        None => f64::INFINITY,
    };
    let steps = reduce(&problem, full, until, stop)?;
    let selected = plan.select.index(&steps);
    let refined = match &plan.nonlinear {
        // The impulse response's output is that of a linear system.
        Some(pushed) if !plan.filter => {
            begins(Stage::Refinement);
            Some(refine(&problem, pushed, &steps[selected].fit, stop))
        }
        _ => None,
    };
    if let Some(Err(FitError::Interrupted)) = refined {
        return Err(FitError::Interrupted);
    }
    Ok(Identified { problem, steps, selected, refined, delay, impulse_responses })
}
