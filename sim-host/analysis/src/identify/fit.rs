//! Fit of the gains to a record.

use super::descent::{ENOUGH, ENOUGH_FOR_COST, descend_until};
use super::error::{FitError, SAMPLES_PER_GAIN, SHORTEST_S};
use super::gray_box::{GAINS, GrayBox, PerGain, symbols};
use super::objective::{Chosen, Drift, Objective};
use super::record::Record;
use super::response::Signal;
use super::search::{Global, Optimum, TYPICAL, optima};
use super::uncertainty::{Uncertainty, uncertainty};
use crate::eigen::{DelaySystem, rightmost};
use nalgebra::{DMatrix, DVector, RowDVector};

/// Time after the start of a perturbation in which a rider recovers or falls \[s\]: the part of the response that decides
/// (Kuipers 2020, chapter 5: the variance accounted for over a long record misjudges it).
pub const AFTER_ONSET_S: f64 = 1.0;

/// Growth from which a closed loop counts as unstable \[1/s\]: less is not noticed in a ride.
const UNSTABLE_1_S: f64 = 1e-3;

/// A record with the model that is fitted to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The record.
    pub record: Record,
    /// The model without its gains.
    pub model: GrayBox,
    /// Slow motion that is no response.
    pub drift: Drift,
    /// Time from the record's start that is not fitted, because the model starts from rest \[s\].
    pub skip_s: f64,
    /// Seed of the global search.
    pub seed: u64,
}

/// A local optimum of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalOptimum {
    /// The gains.
    pub gains: PerGain,
    /// Variance accounted for of each signal.
    pub vaf: Vec<(Signal, f64)>,
    /// Variance accounted for after the onsets of perturbations.
    pub vaf_after_onset: Option<Vec<(Signal, f64)>>,
    /// Real part of the closed loop's rightmost eigenvalue \[1/s\].
    pub rightmost_1_s: f64,
    /// Drop of the log-likelihood below the best optimum's, with as many independent residuals; a 95 % interval ends at
    /// [`DROP_95`](super::DROP_95).
    pub drop: f64,
    /// The number of starts that led here.
    pub starts: usize,
}

/// Fitted gains.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Indices of the fitted gains; the others are zero.
    pub active: Vec<usize>,
    /// The gains.
    pub gains: PerGain,
    /// Covariance of the fitted gains, in the order of `active`.
    pub covariance: DMatrix<f64>,
    /// Variance accounted for of each signal (eq. 2.12), from 1 for a perfect model to below 0.
    pub vaf: Vec<(Signal, f64)>,
    /// The same within [`AFTER_ONSET_S`] of the perturbations' onsets; `None` if the record has none.
    pub vaf_after_onset: Option<Vec<(Signal, f64)>>,
    /// Residuals of each signal.
    pub residuals: Vec<Residuals>,
    /// Condition number of the Jacobian with columns of unit length.
    pub condition: f64,
    /// Real part of the rightmost eigenvalue of the closed loop \[1/s\]; positive if unstable.
    pub rightmost_1_s: f64,
    /// The distinct optima, best first, with this one; a single one if the search started from known gains.
    pub optima: Vec<LocalOptimum>,
}

/// Residuals of one signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residuals {
    /// Mean square \[rad^2 or rad^2/s^2\].
    pub mean_square: f64,
    /// The number of independent ones: all, less what their correlation takes.
    pub independent: f64,
}

/// Where the search for gains starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum From<'a> {
    /// Everywhere: global search.
    Everywhere,
    /// From known gains only.
    Gains(&'a PerGain),
}

impl Fit {
    /// Whether the closed loop is stable, or grows too slowly to be noticed in a ride. The growth of an unstable one is
    /// exponential in the gains, which a covariance takes as linear.
    pub fn is_stable(&self) -> bool {
        self.rightmost_1_s <= UNSTABLE_1_S
    }

    /// Standard error of each gain; zero for gains that are not fitted.
    pub fn standard_errors(&self) -> PerGain {
        let mut errors = PerGain::default();
        self.active
            .iter()
            .enumerate()
            .for_each(|(i, gain)| errors[*gain] = self.covariance[(i, i)].max(0.0).sqrt());
        errors
    }

    /// Mean of the signals' variance accounted for.
    pub fn mean_vaf(&self) -> f64 {
        self.vaf.iter().map(|(_, vaf)| vaf).sum::<f64>() / self.vaf.len() as f64
    }

    /// The same within [`AFTER_ONSET_S`] of the perturbations' onsets.
    pub fn mean_vaf_after_onset(&self) -> Option<f64> {
        let of = self.vaf_after_onset.as_ref()?;
        Some(of.iter().map(|(_, vaf)| vaf).sum::<f64>() / of.len() as f64)
    }

    /// Variance of each gain relative to its square: the diagonal of eq. 2.15.
    pub fn relative_variances(&self) -> Vec<(usize, f64)> {
        let relative =
            |(i, gain): (usize, &usize)| (*gain, self.covariance[(i, i)] / self.gains[*gain].powi(2));
        self.active.iter().enumerate().map(relative).collect()
    }

    /// Twice the negative logarithm of the likelihood of normal residuals, but for a constant, if each signal has the
    /// `independent` number of independent ones: `sum n ln(mean square)`.
    pub fn deviance(&self, independent: &[f64]) -> f64 {
        deviance(self.residuals.iter().map(|residuals| residuals.mean_square), independent)
    }

    /// Correlation of two fitted gains, by their place in `active`.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i, j)] / (self.covariance[(i, i)] * self.covariance[(j, j)]).sqrt()
    }
}

/// `sum n ln(mean square)` over the signals.
fn deviance(mean_squares: impl IntoIterator<Item = f64>, independent: &[f64]) -> f64 {
    let of = |(mean_square, n): (f64, &f64)| n * libm::log(mean_square.max(f64::MIN_POSITIVE));
    mean_squares.into_iter().zip(independent).map(of).sum()
}

/// Integral gains below this fraction of [`TYPICAL`] count as zero: their eigenvalue would be zero but for rounding.
const NO_INTEGRAL: f64 = 1e-7;

/// Real part of the rightmost eigenvalue of the model closed by `gains` \[1/s\]. The integrals of roll and steer are one
/// state, their weighted sum, because nothing else of them is fed back: the eigenvalue of another combination is zero for
/// any gains. Without integral gains there is no such state.
pub fn rightmost_real(model: &GrayBox, gains: &PerGain) -> f64 {
    let system = model.open_loop();
    // The states but the integrals: roll, steer, their rates, the rider's torque and its rate; then the weighted sum.
    let others = [0, 1, 2, 3, 6, 7];
    let weights =
        [1, 5].map(|gain| if gains[gain].abs() > NO_INTEGRAL * TYPICAL[gain] { gains[gain] } else { 0.0 });
    let sum = others.len();
    let n = sum + usize::from(weights.iter().any(|weight| *weight != 0.0));
    let mut without = *gains;
    (without[1], without[5]) = (0.0, 0.0);
    let row = nalgebra::SVector::<f64, GAINS>::from_column_slice(&without).transpose() * system.c;
    rightmost(&DelaySystem {
        a: DMatrix::from_fn(n, n, |i, j| match (i == sum, j == sum) {
            (false, false) => system.a[(others[i], others[j])],
            (true, false) => weights.get(others[j]).copied().unwrap_or(0.0),
            (_, true) => 0.0,
        }),
        b: DVector::from_fn(n, |i, _| if i == sum { 0.0 } else { system.alpha[others[i]] }),
        k: RowDVector::from_fn(n, |_, j| if j == sum { 1.0 } else { row[others[j]] }),
        delay_s: model.delay_s,
    })
    .re
}

impl Problem {
    /// Whether a sample is fitted.
    pub(super) fn fitted(&self, k: usize) -> bool {
        k as f64 * self.record.disturbances.sample_s >= self.skip_s
    }

    /// The objective of a fit to the samples `chosen` beside those that are always left out, weighted by the noise of `fit`.
    pub(super) fn objective_of(&self, model: &GrayBox, fit: &Fit, chosen: Chosen) -> Objective<'_> {
        let objective = Objective::new(&self.record, model, self.drift, &|k| self.fitted(k) && chosen(k));
        match fit.residuals.len() {
            1 => objective,
            _ => objective.weighted(fit.residuals.iter().map(|residuals| residuals.mean_square)),
        }
    }

    /// Checks that the record can be fitted with these gains.
    ///
    /// # Errors
    /// States what is missing.
    pub fn check(&self, active: &[usize]) -> Result<(), FitError> {
        let Record { disturbances, measured } = &self.record;
        let duration_s = self.record.duration_s();
        if active.is_empty() {
            return Err(FitError::Nothing("no gain"));
        }
        if measured.is_empty() {
            return Err(FitError::Nothing("no measured signal"));
        }
        if duration_s < SHORTEST_S + self.skip_s {
            return Err(FitError::Short { duration_s, skip_s: self.skip_s });
        }
        for (input, signal) in ["the lateral force", "the steer torque disturbance"].into_iter().enumerate() {
            let sample = disturbances.samples.iter().position(|x| !x[input].is_finite());
            sample.map_or(Ok(()), |sample| Err(FitError::NotANumber { signal, sample }))?;
        }
        if disturbances.samples.iter().flatten().all(|x| *x == 0.0) {
            return Err(FitError::Undisturbed);
        }
        for one in measured {
            let name = one.signal.name();
            let valid = || (0..one.values.len()).filter(|k| one.valid[*k]);
            if let Some(sample) = valid().find(|k| !one.values[*k].is_finite()) {
                return Err(FitError::NotANumber { signal: name, sample });
            }
            let samples = valid().filter(|k| self.fitted(*k)).count();
            if samples < SAMPLES_PER_GAIN * active.len() {
                return Err(FitError::Few { signal: name, samples, gains: active.len() });
            }
            let mut values = valid().map(|k| one.values[k]);
            if values.next().is_none_or(|first| values.all(|x| x == first)) {
                return Err(FitError::Still(name));
            }
        }
        Ok(())
    }

    /// The optima of the gains `active`, best first, with their objective; the search from known gains ends at a relative decrease of
    /// the cost of `enough`.
    fn ends(
        &self,
        active: &[usize],
        from: From,
        enough: f64,
        stop: &(impl Fn() -> bool + Sync),
    ) -> Result<(Objective<'_>, Vec<Optimum>), FitError> {
        self.check(active)?;
        let chosen = |k: usize| self.fitted(k);
        let mut objective = Objective::new(&self.record, &self.model, self.drift, &chosen);
        let mut ends = match from {
            From::Gains(gains) => {
                let found = descend_until(enough, &objective, active, gains).ok_or(FitError::Unbounded)?;
                vec![Optimum { found, starts: 1 }]
            }
            From::Everywhere => {
                let Self { record, model, drift, seed, .. } = self;
                optima(&objective, &Global { record, model, drift: *drift, active, seed: *seed }, stop)
            }
        };
        if stop() {
            return Err(FitError::Interrupted);
        }
        let best = ends.first_mut().ok_or(FitError::Unbounded)?;
        if self.record.measured.len() > 1 {
            // With several signals, their noise is known only after a first fit.
            let at = objective.evaluate(&best.found.gains, &[]).ok_or(FitError::Unbounded)?;
            let means = objective.mean_squares(&at);
            objective = objective.weighted(means.into_iter());
            best.found =
                descend_until(enough, &objective, active, &best.found.gains).ok_or(FitError::Unbounded)?;
        }
        Ok((objective, ends))
    }

    /// [`Fit::mean_vaf`] of the gains `active` fitted from known ones, without the rest of a [`Fit`], which takes longer.
    ///
    /// # Errors
    /// As [`Self::fit`].
    pub fn mean_vaf_from(&self, active: &[usize], gains: &PerGain) -> Result<f64, FitError> {
        let (objective, ends) = self.ends(active, From::Gains(gains), ENOUGH_FOR_COST, &|| false)?;
        let best = ends.first().ok_or(FitError::Unbounded)?;
        let vafs = objective.vaf(&best.found.gains, &|_| true).ok_or(FitError::Unbounded)?;
        Ok(vafs.iter().sum::<f64>() / vafs.len() as f64)
    }

    /// Fits the gains `active` by indices in [`symbols`]; `stop` interrupts.
    ///
    /// # Errors
    /// The record can't be fitted, or no bounded response was found.
    pub fn fit(
        &self,
        active: &[usize],
        from: From,
        stop: &(impl Fn() -> bool + Sync),
    ) -> Result<Fit, FitError> {
        let (objective, ends) = self.ends(active, from, ENOUGH, stop)?;
        let best = ends.first().ok_or(FitError::Unbounded)?;
        let gains = best.found.gains;
        let at = objective.evaluate(&gains, active).ok_or(FitError::Unbounded)?;
        let Uncertainty { covariance, independent, condition } =
            uncertainty(&objective, &at, self.record.disturbances.sample_s)
                .ok_or_else(|| FitError::Inseparable(names(active)))?;
        let means = objective.mean_squares(&at);
        let best_deviance = deviance(means.iter().copied(), &independent);
        let drop = |end: &Optimum| {
            let at = objective.evaluate(&end.found.gains, &[]);
            at.map_or(f64::INFINITY, |at| {
                (deviance(objective.mean_squares(&at), &independent) - best_deviance) / 2.0
            })
        };
        let optima: Vec<LocalOptimum> =
            ends.iter().map(|end| self.local(&objective, end, drop(end))).collect();
        let residuals = means.into_iter().zip(independent);
        Ok(Fit {
            active: active.to_vec(),
            covariance,
            vaf: optima[0].vaf.clone(),
            vaf_after_onset: optima[0].vaf_after_onset.clone(),
            residuals: residuals
                .map(|(mean_square, independent)| Residuals { mean_square, independent })
                .collect(),
            condition,
            rightmost_1_s: optima[0].rightmost_1_s,
            gains,
            optima,
        })
    }

    fn local(&self, objective: &Objective, end: &Optimum, drop: f64) -> LocalOptimum {
        let gains = end.found.gains;
        let signals = self.record.measured.iter().map(|measured| measured.signal);
        let of = |within: &dyn Fn(usize) -> bool| -> Vec<(Signal, f64)> {
            signals.clone().zip(objective.vaf(&gains, within).unwrap_or_default()).collect()
        };
        let after = self.record.after_onsets(AFTER_ONSET_S);
        let disturbed = (0..after.len()).any(|k| after[k] && self.fitted(k));
        LocalOptimum {
            gains,
            vaf: of(&|_| true),
            vaf_after_onset: disturbed.then(|| of(&|k| after[k])),
            rightmost_1_s: rightmost_real(&self.model, &gains),
            drop,
            starts: end.starts,
        }
    }
}

/// The symbols of some gains, as a list.
pub(super) fn names(active: &[usize]) -> String {
    active.iter().map(|i| symbols()[*i]).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::{Disturbances, Hold, Measured};
    use physics::bicycle::ForcePoint;
    use physics::bicycle::linear::Linear;
    use physics::perturbation::Experiment;
    use physics::rider::Neuromuscular;

    /// 20 s of pushes with all signals, of the response to the published gains of the first run of a table with other delays; and these
    /// gains.
    fn problem(table: &str, delay_s: f64, hold: Hold) -> (Problem, PerGain) {
        let row = physics::rider::catalogue::load(table).unwrap().rows.remove(0);
        let (gains, speed_m_s) = (std::array::from_fn(|i| row.gains.0[i]), row.speed_m_s);
        let parameters = physics::bicycle::catalogue::load("rigid_jason").unwrap().parameters;
        let bicycle = Linear::new(&parameters);
        let force_input = bicycle.lateral_force_input(ForcePoint::SADDLE).into();
        let neuromuscular = Neuromuscular::SHOULDERS;
        let model = GrayBox { bicycle, force_input, neuromuscular, speed_m_s, delay_s };
        let experiment = Experiment { duration_s: 20.0, ..Experiment::at(speed_m_s) };
        let samples: Vec<[f64; 2]> =
            experiment.lateral_force().into_iter().map(|force| [force, 0.02 * force]).collect();
        let disturbances = Disturbances { sample_s: experiment.sample_s(), samples, hold };
        let response = model.response(&disturbances, &gains).unwrap();
        let measured = Signal::ALL.map(|signal| {
            let values = response.iter().map(|x| x[signal.state()]).collect();
            Measured { signal, values, valid: vec![true; response.len()] }
        });
        let record = Record { disturbances, measured: measured.to_vec() };
        (Problem { record, model, drift: Drift::None, skip_s: 0.0, seed: 0 }, gains)
    }

    /// Situation: riders without delay, with one of whole samples and one between, constant and straight disturbances. Action: the
    /// Jacobian of all signals. Must hold: it equals central differences with respect to every gain.
    #[test]
    fn derivatives_by_every_gain_are_those_of_differences() {
        let young = "young-reduction";
        let riders = [
            ("undelayed-reduction", 0.0, Hold::Zero),
            (young, 0.03, Hold::Zero),
            (young, 0.0317, Hold::Linear),
        ];
        for (table, delay_s, hold) in riders {
            let (problem, gains) = problem(table, delay_s, hold);
            let objective = Objective::new(&problem.record, &problem.model, Drift::None, &|_| true);
            let all: Vec<usize> = (0..GAINS).collect();
            let jacobian = objective.evaluate(&gains, &all).unwrap().jacobian;
            for gain in all {
                let step = 1e-6 * TYPICAL[gain];
                let at = |sign: f64| {
                    let mut changed = gains;
                    changed[gain] += sign * step;
                    objective.evaluate(&changed, &[]).unwrap().residual
                };
                let differences = (at(-1.0) - at(1.0)) / (2.0 * step);
                let error = (&differences - jacobian.column(gain)).norm() / differences.norm();
                assert!(error < 1e-5, "delay {delay_s} s, {}: {error:e}", symbols()[gain]);
            }
        }
    }

    /// Situation: the response to all gains, fitted by those of the run's next set, so that some remains. Action: the fit, and its
    /// variance accounted for alone. Must hold: both are the same to 1e-6.
    #[test]
    fn the_variance_accounted_for_is_that_of_the_fit() {
        let (problem, gains) = problem("young-reduction", 0.03, Hold::Zero);
        let row = physics::rider::catalogue::load("young-reduction").unwrap().rows.remove(1);
        let start: PerGain = std::array::from_fn(|i| row.gains.0[i]);
        let active: Vec<usize> = (0..GAINS).filter(|i| start[*i] != 0.0).collect();
        assert!(active.len() < gains.iter().filter(|gain| **gain != 0.0).count());
        let fit = problem.fit(&active, From::Gains(&start), &|| false).unwrap();
        let alone = problem.mean_vaf_from(&active, &start).unwrap();
        assert!((alone - fit.mean_vaf()).abs() < 1e-6, "{alone} {}", fit.mean_vaf());
        assert!(alone < 1.0 - 1e-6, "{alone}");
    }
}
