//! An output-error model (Ljung 1999, chapter 4.2)
//!
//! ```text
//! torque[k] = sum a[i] torque[k-i] + sum over inputs, i of b[i] input[k-i] + constant
//! ```
//!
//! whose torque is simulated from the inputs alone, and fitted by Levenberg and Marquardt's method. One-step prediction, which
//! is linear in the coefficients, is no substitute: it fits the torque's last sample, and the response below a few hertz is
//! wrong by half.

use super::regress::{explained, long_run};
use crate::eigen::spectrum;
use crate::weave::Estimate;
use crate::weave::student::quantile;
use nalgebra::{Complex, ComplexField, DMatrix, DVector};
use std::f64::consts::TAU;

/// Iterations of the search.
const ROUNDS: usize = 80;
/// Rounds of the start.
const START_ROUNDS: usize = 8;
/// Bound of the poles of a start.
const FASTEST_POLE: f64 = 0.998;

/// Torque and inputs at equal intervals.
pub(super) struct Data {
    pub(super) torque: DVector<f64>,
    pub(super) inputs: Vec<Vec<f64>>,
}

/// Coefficients: `states` of the torque's past, `states + 1` of each input, the constant, `states` of the initial state.
pub(super) struct Model {
    pub(super) states: usize,
    coefficients: DVector<f64>,
    /// Sum of squared residuals.
    pub(super) cost: f64,
}

/// The recursion `y[k] = x[k] + sum a[i] y[k-i]`.
fn recursion(a: &[f64], x: &[f64]) -> Vec<f64> {
    let mut y = Vec::with_capacity(x.len());
    for (k, x) in x.iter().enumerate() {
        let past = a.iter().take(k).enumerate().map(|(i, a)| a * y[k - 1 - i]).sum::<f64>();
        y.push(x + past);
    }
    y
}

impl Data {
    fn len(&self) -> usize {
        self.torque.len()
    }

    fn place_of_constant(&self, states: usize) -> usize {
        states + self.inputs.len() * (states + 1)
    }

    fn simulated(&self, states: usize, coefficients: &DVector<f64>) -> DVector<f64> {
        let constant = self.place_of_constant(states);
        let mut x = vec![coefficients[constant]; self.len()];
        for (j, input) in self.inputs.iter().enumerate() {
            for i in 0..=states {
                let b = coefficients[states + j * (states + 1) + i];
                x.iter_mut().skip(i).zip(input).for_each(|(x, u)| *x += b * u);
            }
        }
        (0..states).for_each(|i| x[i] += coefficients[constant + 1 + i]);
        DVector::from_vec(recursion(&coefficients.as_slice()[..states], &x))
    }

    /// The regressors, passed through the recursion `a`, with the torque `past`: the gradient of the simulated torque if
    /// `past` is that torque itself.
    fn regressors(&self, states: usize, a: &[f64], past: &[f64]) -> DMatrix<f64> {
        let n = self.len();
        let mut pulse = vec![0.0; n];
        pulse[0] = 1.0;
        let filtered: Vec<Vec<f64>> = std::iter::once(past)
            .chain(self.inputs.iter().map(|input| &input[..]))
            .chain([&vec![1.0; n][..], &pulse[..]])
            .map(|x| recursion(a, x))
            .collect();
        let inputs = self.inputs.len();
        let mut places: Vec<(usize, usize)> = (1..=states).map(|delay| (0, delay)).collect();
        places.extend((0..inputs).flat_map(|j| (0..=states).map(move |delay| (1 + j, delay))));
        places.push((1 + inputs, 0));
        places.extend((0..states).map(|delay| (2 + inputs, delay)));
        DMatrix::from_fn(n, places.len(), |k, column| {
            let (which, delay) = places[column];
            if k < delay { 0.0 } else { filtered[which][k - delay] }
        })
    }

    fn cost(&self, states: usize, coefficients: &DVector<f64>) -> f64 {
        let cost = (&self.torque - self.simulated(states, coefficients)).norm_squared();
        if cost.is_finite() { cost } else { f64::INFINITY }
    }

    /// Steiglitz and McBride's iteration: one-step prediction, with all signals filtered by the last denominator.
    fn start(&self, states: usize) -> Option<(f64, DVector<f64>)> {
        let mut a = vec![0.0; states];
        let mut best: Option<(f64, DVector<f64>)> = None;
        for _ in 0..START_ROUNDS {
            let x = self.regressors(states, &a, self.torque.as_slice());
            let y = DVector::from_vec(recursion(&a, self.torque.as_slice()));
            let Some(coefficients) = scaled_solution(&x, &y, 1e-12) else { break };
            a = stable(&coefficients.as_slice()[..states]);
            let cost = self.cost(states, &coefficients);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, coefficients));
            }
        }
        best.filter(|(cost, _)| cost.is_finite())
    }

    pub(super) fn fit(&self, states: usize) -> Option<Model> {
        let (mut cost, mut at) = self.start(states)?;
        let mut damping = 1e-3;
        for _ in 0..ROUNDS {
            let simulated = self.simulated(states, &at);
            let gradient = self.regressors(states, &at.as_slice()[..states], simulated.as_slice());
            let rest = &self.torque - simulated;
            let mut better = None;
            while better.is_none() && damping < 1e9 {
                let next = scaled_solution(&gradient, &rest, damping).map(|step| &at + step);
                better = next.map(|next| (self.cost(states, &next), next)).filter(|(there, _)| *there < cost);
                damping *= if better.is_some() { 0.1 } else { 5.0 };
            }
            let Some((there, next)) = better else { break };
            let gained = cost - there;
            (cost, at, damping) = (there, next, damping.max(1e-12));
            if gained < 1e-8 * cost {
                break;
            }
        }
        Some(Model { states, coefficients: at, cost })
    }

    fn rest(&self, model: &Model) -> DVector<f64> {
        &self.torque - self.simulated(model.states, &model.coefficients)
    }

    pub(super) fn vaf(&self, model: &Model) -> f64 {
        explained(self.torque.as_slice(), self.rest(model).as_slice(), &vec![true; self.len()])
    }

    /// Errors of the coefficients for correlated residuals.
    pub(super) fn errors(&self, model: &Model, memory: usize) -> Option<Errors> {
        let simulated = self.simulated(model.states, &model.coefficients);
        let a = &model.coefficients.as_slice()[..model.states];
        let (q, triangle) = self.regressors(model.states, a, simulated.as_slice()).qr().unpack();
        let rest = self.rest(model);
        let scores = DMatrix::from_fn(q.nrows(), q.ncols(), |i, j| q[(i, j)] * rest[i]);
        let regular = (0..triangle.ncols()).all(|i| triangle[(i, i)] != 0.0);
        let freedom = (self.len() as f64 / memory as f64 - 2.0).max(3.0);
        regular.then(|| Errors { triangle, scores: long_run(&scores, memory), freedom })
    }
}

/// Errors of coefficients: covariance `triangle^-1 scores triangle^-T`, kept as factors, which differ by many orders of
/// magnitude.
pub(super) struct Errors {
    triangle: DMatrix<f64>,
    scores: DMatrix<f64>,
    freedom: f64,
}

impl Errors {
    /// A function of the coefficients, with its gradient.
    pub(super) fn estimate(&self, value: f64, gradient: &DVector<f64>) -> Option<Estimate> {
        let part = self.triangle.tr_solve_upper_triangular(gradient)?;
        let error = part.dot(&(&self.scores * &part)).max(0.0).sqrt();
        error.is_finite().then(|| Estimate::new(value, error, quantile(self.freedom)))
    }
}

/// A delay of `samples` at `turns` of a circle a sample.
fn delayed(turns: f64, samples: usize) -> Complex<f64> {
    let (sine, cosine) = libm::sincos(TAU * turns * samples as f64);
    Complex::new(cosine, -sine)
}

impl Model {
    /// First coefficient of input `j`.
    const fn place(&self, j: usize) -> usize {
        self.states + j * (self.states + 1)
    }

    fn denominator(&self, turns: f64) -> Complex<f64> {
        let past = (0..self.states).map(|i| delayed(turns, i + 1) * self.coefficients[i]);
        Complex::new(1.0, 0.0) - past.sum::<Complex<f64>>()
    }

    /// Response to a sine of input `j` at `turns` of a circle a sample.
    pub(super) fn response(&self, j: usize, turns: f64) -> Complex<f64> {
        let place = self.place(j);
        let above = (0..=self.states).map(|i| delayed(turns, i) * self.coefficients[place + i]);
        above.sum::<Complex<f64>>() / self.denominator(turns)
    }

    /// Gradient of the response's magnitude: the part of the complex derivative along the response.
    pub(super) fn slope(&self, j: usize, turns: f64) -> DVector<f64> {
        let (place, denominator) = (self.place(j), self.denominator(turns));
        let response = self.response(j, turns);
        let along = |derivative: Complex<f64>| (response.conj() * derivative).re / response.modulus();
        let mut gradient = DVector::zeros(self.coefficients.len());
        for i in 0..self.states {
            gradient[i] = along(response * delayed(turns, i + 1) / denominator);
        }
        for i in 0..=self.states {
            gradient[place + i] = along(delayed(turns, i) / denominator);
        }
        gradient
    }
}

/// Least squares with damped, scaled normal equations.
fn scaled_solution(x: &DMatrix<f64>, y: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let scales: Vec<f64> = x.column_iter().map(|column| column.norm()).collect();
    if scales.iter().any(|scale| !scale.is_normal()) {
        return None;
    }
    let mut z = x.clone();
    z.column_iter_mut().zip(&scales).for_each(|(mut column, scale)| column /= *scale);
    let mut gram = z.tr_mul(&z);
    (0..gram.nrows()).for_each(|i| gram[(i, i)] += damping);
    let mut solution = gram.cholesky()?.solve(&z.tr_mul(y));
    solution.iter_mut().zip(&scales).for_each(|(value, scale)| *value /= scale);
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}

/// The recursion with its poles moved inside the circle of [`FASTEST_POLE`]; itself if it is not finite.
fn stable(a: &[f64]) -> Vec<f64> {
    let n = a.len();
    let companion = DMatrix::from_fn(n, n, |i, j| match i {
        0 => a[j],
        _ => f64::from(u8::from(j + 1 == i)),
    });
    let mut polynomial = vec![Complex::new(1.0, 0.0)];
    if n > 0 {
        let Some(poles) = spectrum(&companion) else { return a.to_vec() };
        for pole in poles {
            let size = libm::hypot(pole.re, pole.im);
            let pole = if size > FASTEST_POLE { pole * (FASTEST_POLE / size) } else { pole };
            polynomial.push(Complex::new(0.0, 0.0));
            for i in (1..polynomial.len()).rev() {
                let before = polynomial[i - 1];
                polynomial[i] -= pole * before;
            }
        }
    }
    polynomial[1..].iter().map(|coefficient| -coefficient.re).collect()
}
