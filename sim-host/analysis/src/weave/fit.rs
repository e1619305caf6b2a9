//! Fits a weave to gyro rates by separable least squares (variable projection, Golub and Pereyra 1973, with
//! the Jacobian of Kaufman 1975). The weights of the motions are linear and solved for directly. Decay,
//! frequency and real mode, common to all axes, are searched from several starts.

use super::noise::{Noise, period};
use super::shape::{Beside, Shape};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Bounds of the real part of the weave \[1/s\].
pub const DECAY_1_S: (f64, f64) = (-15.0, 5.0);
/// Bounds of the real mode \[1/s\]: a slower mode resembles an offset, a faster one decays at once.
pub const MODE_1_S: (f64, f64) = (-14.0, -1.2);
/// Upper bound of the frequency \[rad/s\].
pub const HIGHEST_RAD_S: f64 = 40.0;
/// Alternating estimates of noise and shape.
const ROUNDS: usize = 5;
/// Number of starts of the search.
const STARTS: usize = 6;

/// Samples to fit: times from the window's start \[s\] and rates of each axis \[rad/s\].
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Sample times, increasing from 0 \[s\].
    pub times_s: Vec<f64>,
    /// Rates, one vector per axis \[rad/s\].
    pub axes_rad_s: Vec<Vec<f64>>,
}

/// Result of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The shape.
    pub shape: Shape,
    /// Standard errors of decay \[1/s\] and frequency \[rad/s\].
    pub standard_errors: [f64; 2],
    /// Degrees of freedom of the intervals.
    pub freedom: f64,
    /// The noise of each axis.
    pub noise: Vec<Noise>,
    /// Amplitude of the weave in each axis at the window's start \[rad/s\].
    pub amplitude_rad_s: Vec<f64>,
    /// Increase of the explained variance by the weave, in units of the noise's variance: about two per axis
    /// by chance.
    pub explained: f64,
    /// Whether decay or frequency is at a bound.
    pub at_bound: [bool; 2],
}

/// An axis after solving for its weights, whitened and in units of its noise.
struct Solved {
    rest: DVector<f64>,
    jacobian: DMatrix<f64>,
    weights: DVector<f64>,
}

/// Sum of squares of the residuals of all axes, its gradient and Gauss-Newton Hessian.
struct Evaluation {
    cost: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

fn solve(times: &[f64], rates: &[f64], shape: &Shape, noise: &Noise) -> Option<Solved> {
    let mut columns = shape.columns(times);
    let mut rates = DMatrix::from_column_slice(rates.len(), 1, rates);
    noise.whiten(times, &mut columns);
    noise.whiten(times, &mut rates);
    let (q, r) = columns.qr().unpack();
    let along = q.tr_mul(&rates);
    let weights = r.solve_upper_triangular(&along)?.column(0).into_owned();
    let rest = (&rates - &q * along).column(0).into_owned();
    let mut tangents = shape.tangents(times, &weights);
    noise.whiten(times, &mut tangents);
    let jacobian = &q * q.tr_mul(&tangents) - tangents;
    (rest.iter().chain(jacobian.iter()).all(|x| x.is_finite())).then_some(Solved { rest, jacobian, weights })
}

fn evaluate(samples: &Samples, shape: &Shape, noise: &[Noise]) -> Option<Evaluation> {
    let free = shape.numbers().len();
    let mut evaluated =
        Evaluation { cost: 0.0, gradient: DVector::zeros(free), hessian: DMatrix::zeros(free, free) };
    for (rates, noise) in samples.axes_rad_s.iter().zip(noise) {
        let Solved { rest, jacobian, .. } = solve(&samples.times_s, rates, shape, noise)?;
        evaluated.cost += rest.norm_squared();
        evaluated.gradient += jacobian.tr_mul(&rest);
        evaluated.hessian += jacobian.tr_mul(&jacobian);
    }
    Some(evaluated)
}

/// Bounds of the searched numbers.
struct Bounds(Vec<(f64, f64)>);

impl Bounds {
    fn new(samples: &Samples, beside: Beside) -> Self {
        let t = &samples.times_s;
        let lowest = PI / (t[t.len() - 1] - t[0]);
        let highest = HIGHEST_RAD_S.min(PI / (3.0 * period(t))).max(2.0 * lowest);
        let mode = (beside == Beside::Mode).then_some(MODE_1_S);
        Self([DECAY_1_S, (lowest, highest)].into_iter().chain(mode).collect())
    }

    fn into(&self, numbers: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(numbers.len(), numbers.iter().zip(&self.0).map(|(x, (a, b))| x.clamp(*a, *b)))
    }

    fn reached(&self, i: usize, x: f64) -> bool {
        x <= self.0[i].0 || x >= self.0[i].1
    }

    /// Indices of the numbers that a step along the negative gradient does not move beyond their bound.
    fn free(&self, numbers: &DVector<f64>, gradient: &DVector<f64>) -> Vec<usize> {
        let held = |i: &usize| {
            let (x, g, (low, high)) = (numbers[*i], gradient[*i], self.0[*i]);
            (x <= low && g > 0.0) || (x >= high && g < 0.0)
        };
        (0..numbers.len()).filter(|i| !held(i)).collect()
    }
}

/// Levenberg-Marquardt search inside the bounds.
fn descend(samples: &Samples, noise: &[Noise], bounds: &Bounds, start: &Shape) -> Option<(Shape, f64)> {
    let shape = |x: &DVector<f64>| Shape::of(x.as_slice());
    let mut at = bounds.into(&DVector::from_vec(start.numbers()));
    let mut here = evaluate(samples, &shape(&at), noise)?;
    let mut damping = 1e-3;
    for _ in 0..60 {
        let free = bounds.free(&at, &here.gradient);
        let mut matrix = here.hessian.select_rows(&free).select_columns(&free);
        for i in 0..free.len() {
            matrix[(i, i)] += damping * matrix[(i, i)] + 1e-12;
        }
        let Some(step) = matrix.cholesky().map(|c| c.solve(&here.gradient.select_rows(&free))) else { break };
        let mut next = at.clone();
        free.iter().zip(step.iter()).for_each(|(i, s)| next[*i] -= s);
        let next = bounds.into(&next);
        match evaluate(samples, &shape(&next), noise).filter(|there| there.cost < here.cost) {
            Some(there) => {
                let gained = here.cost - there.cost;
                (at, here, damping) = (next, there, (damping / 5.0).max(1e-9));
                if gained < 1e-10 * here.cost {
                    break;
                }
            }
            None => damping *= 4.0,
        }
        if damping > 1e8 || free.is_empty() {
            break;
        }
    }
    Some((shape(&at), here.cost))
}

/// The best points of a grid that are sufficiently different.
fn starts(samples: &Samples, noise: &[Noise], bounds: &Bounds, beside: Beside) -> Vec<Shape> {
    let (lowest, highest) = bounds.0[1];
    let span = samples.times_s[samples.times_s.len() - 1] - samples.times_s[0];
    let steps = ((highest - lowest) / (PI / (2.0 * span)).min(0.5)).ceil().min(400.0) as usize;
    let modes: &[Option<f64>] = if beside == Beside::Mode { &[Some(-8.0), Some(-3.0)] } else { &[None] };
    let mut grid = Vec::new();
    for i in 0..=steps {
        let frequency_rad_s = lowest + (highest - lowest) * i as f64 / steps as f64;
        for decay_1_s in [-4.0, -2.0, -1.0, -0.4] {
            for mode_1_s in modes {
                let shape = Shape { decay_1_s, frequency_rad_s, mode_1_s: *mode_1_s };
                grid.extend(evaluate(samples, &shape, noise).map(|evaluated| (evaluated.cost, shape)));
            }
        }
    }
    grid.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<Shape> = Vec::new();
    for (_, shape) in grid {
        let apart = |other: &Shape| libm::log(other.frequency_rad_s / shape.frequency_rad_s).abs() > 0.1;
        if chosen.iter().all(apart) {
            chosen.push(shape);
        }
        if chosen.len() == STARTS {
            break;
        }
    }
    chosen
}

fn best(samples: &Samples, noise: &[Noise], bounds: &Bounds, starts: &[Shape]) -> Option<Shape> {
    let ends = starts.iter().filter_map(|start| descend(samples, noise, bounds, start));
    ends.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(shape, _)| shape)
}

/// Variance explained by the weave and not by the other motions, in units of the noise's variance.
fn explained(samples: &Samples, shape: &Shape, noise: &[Noise]) -> f64 {
    let gain = |(rates, noise): (&Vec<f64>, &Noise)| {
        let mut columns = shape.columns(&samples.times_s).remove_columns(0, 2);
        let mut white = DMatrix::from_column_slice(rates.len(), 1, rates);
        noise.whiten(&samples.times_s, &mut columns);
        noise.whiten(&samples.times_s, &mut white);
        let q = columns.qr().q();
        let without = (&white - &q * q.tr_mul(&white)).norm_squared();
        let with = solve(&samples.times_s, rates, shape, noise);
        with.map_or(0.0, |s| without - s.rest.norm_squared())
    };
    samples.axes_rad_s.iter().zip(noise).map(gain).sum()
}

/// Samples that can't be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// An axis without any motion.
    #[error("an axis is zero all along")]
    Zero,
    /// No fit.
    #[error("no damped oscillation could be fitted")]
    Nothing,
}

/// Fits the samples.
///
/// # Errors
/// Too few samples, or nothing to fit in them.
pub fn fit(samples: &Samples, beside: Beside) -> Result<Fit, FitError> {
    let times = &samples.times_s;
    let bounds = Bounds::new(samples, beside);
    let root_mean = |rates: &Vec<f64>| (rates.iter().map(|x| x * x).sum::<f64>() / rates.len() as f64).sqrt();
    let white = |rates| Noise::white(root_mean(rates));
    let mut noise: Vec<Noise> = samples.axes_rad_s.iter().map(white).collect();
    if noise.iter().any(|n| n.deviation_rad_s < 1e-9) {
        return Err(FitError::Zero);
    }
    let nothing = || FitError::Nothing;
    let grid = starts(samples, &noise, &bounds, beside);
    let mut shape = best(samples, &noise, &bounds, &grid).ok_or_else(nothing)?;
    for round in 0..ROUNDS {
        let rests = samples.axes_rad_s.iter().zip(&noise).map(|(rates, noise)| {
            let weights = solve(times, rates, &shape, noise)?.weights;
            let columns = [shape.columns(times), shape.tangents(times, &weights)];
            let columns = DMatrix::from_fn(times.len(), columns[0].ncols() + columns[1].ncols(), |i, j| {
                let [linear, tangents] = &columns;
                if j < linear.ncols() { linear[(i, j)] } else { tangents[(i, j - linear.ncols())] }
            });
            Some(Noise::of_rest(times, rates, &columns))
        });
        noise = rests.collect::<Option<_>>().ok_or_else(nothing)?;
        // The grid was evaluated for white noise; it is tried again once the noise is estimated.
        let again: &[Shape] = if round == 1 { &grid } else { &[] };
        let from: Vec<Shape> = [&[shape], again].concat();
        shape = best(samples, &noise, &bounds, &from).ok_or_else(nothing)?;
    }
    let evaluated = evaluate(samples, &shape, &noise).ok_or_else(nothing)?;
    let numbers = shape.numbers();
    let inside: Vec<usize> = (0..numbers.len()).filter(|i| !bounds.reached(*i, numbers[*i])).collect();
    let covariance =
        evaluated.hessian.select_rows(&inside).select_columns(&inside).cholesky().map(|c| c.inverse());
    let covariance = covariance.ok_or_else(nothing)?;
    let error = |i: usize| inside.iter().position(|k| *k == i).map_or(0.0, |at| covariance[(at, at)].sqrt());
    let linear = 3 + usize::from(beside == Beside::Mode);
    let independent: f64 = noise.iter().map(|n| n.independent(times)).sum();
    let taken = linear * noise.len() + numbers.len();
    let amplitudes = samples.axes_rad_s.iter().zip(&noise).map(|(rates, noise)| {
        solve(times, rates, &shape, noise).map(|s| libm::hypot(s.weights[0], s.weights[1]))
    });
    Ok(Fit {
        shape,
        standard_errors: [error(0), error(1)],
        freedom: (independent - taken as f64).max(3.0),
        amplitude_rad_s: amplitudes.collect::<Option<_>>().ok_or_else(nothing)?,
        explained: explained(samples, &shape, &noise),
        at_bound: [bounds.reached(0, numbers[0]), bounds.reached(1, numbers[1])],
        noise,
    })
}

impl Fit {
    /// Number of weave periods in a time \[s\].
    pub fn periods(&self, span_s: f64) -> f64 {
        self.shape.frequency_rad_s * span_s / TAU
    }
}
