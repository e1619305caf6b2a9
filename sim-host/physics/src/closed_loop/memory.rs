//! A law with internal states, such as an observer or an integrator: an output-error model (Ljung 1999, chapter 4.2)
//!
//! ```text
//! torque[k] = sum a[i] torque[k-i] + sum over inputs, i of b[i] input[k-i] + constant
//! ```
//!
//! whose torque is simulated from the inputs alone, and fitted by Levenberg and Marquardt's method. From outside, gains and
//! observer of such a law have only their product: the response from each measured input to the torque. That is reported.
//! One-step prediction, which is linear in the coefficients, is no substitute: it fits the torque's last sample, and the
//! response below a few hertz is wrong by half.

use super::Part;
use super::checked::{Checked, FEWEST, SHORTEST_S};
use super::collinear::separable;
use super::record::{Record, Signal};
use super::regress::{explained, long_run};
use crate::weave::Estimate;
use crate::weave::student::quantile;
use nalgebra::{Complex, ComplexField, DMatrix, DVector};
use std::f64::consts::TAU;

/// Inputs of the law: what a steering controller measures.
const INPUTS: [Signal; 3] = [Signal::RollRate, Signal::Steer, Signal::RiderTorque];
/// Number of internal states at most.
const MOST_STATES: usize = 4;
/// A model of fewer states is preferred while it leaves at most this many times as much unexplained.
const PREFERRED: f64 = 2.0;
/// Largest over smallest speed of the stretch: the gains may depend on the speed.
const SAME_SPEED: f64 = 1.1;
/// Slowest speed of the stretch \[m/s\].
const SLOWEST_M_S: f64 = 0.5;
/// Most samples of the stretch, which bounds the computing time.
const MOST_SAMPLES: usize = 8000;
/// Frequencies of the reported response \[Hz\].
const FREQUENCIES_HZ: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Time over which residuals are correlated \[s\].
const MEMORY_S: f64 = 1.0;
/// Iterations of the search.
const ROUNDS: usize = 80;
/// Rounds of the start.
const START_ROUNDS: usize = 8;
/// Bound of the poles of a start.
const FASTEST_POLE: f64 = 0.998;
/// Without internal states a law may leave this much unexplained.
const WITHOUT: f64 = 0.01;
/// Least explained fraction of a law.
const LEAST_VAF: f64 = 0.5;

/// Response of the torque to a sine of one input.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Response {
    /// The input.
    pub input: Signal,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude ratio; unit as that of a gain. The interval is extended to the values of the models with other numbers of
    /// states that fit as well.
    pub magnitude: Estimate,
    /// Phase lead of the torque \[deg\].
    pub phase_deg: f64,
}

/// A law with internal states.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MemoryLaw {
    /// Number of internal states; with 0, the torque depends on the signals of one instant.
    pub states: usize,
    /// Explained fraction of the variance of the torque, simulated from the inputs alone.
    pub vaf: f64,
    /// The same without internal states.
    pub vaf_without: f64,
    /// Start of the stretch of uniform speed \[s\].
    pub from_s: f64,
    /// End of the stretch \[s\].
    pub to_s: f64,
    /// Mean speed there \[m/s\].
    pub speed_m_s: f64,
    /// The response to each input.
    pub responses: Vec<Response>,
}

/// Identifies a law with internal states in the longest stretch of uniform speed.
pub fn memory(record: &Record, checked: &Checked) -> Part<MemoryLaw> {
    let recorded = INPUTS.into_iter().filter_map(|signal| Some((signal, record.channel(signal)?)));
    let recorded: Vec<(Signal, &[f64])> = recorded.collect();
    let stretch = stretch(record, checked, &recorded);
    let seconds = stretch.len() as f64 * checked.period_s;
    if recorded.is_empty() || stretch.len() < FEWEST || seconds < SHORTEST_S {
        return Part::not(format!(
            "no stretch of uniform speed with a changing torque is longer than {seconds:.1} s"
        ));
    }
    let columns = DMatrix::from_fn(stretch.len(), recorded.len(), |i, j| recorded[j].1[stretch.start + i]);
    let (kept, _) = separable(&columns);
    let centred = |j: &usize| {
        let column = columns.column(*j);
        column.add_scalar(-column.mean()).as_slice().to_vec()
    };
    let data = Data {
        torque: DVector::from_column_slice(&record.torque_nm[stretch.clone()]),
        inputs: kept.iter().map(centred).collect(),
    };
    let models: Vec<Model> = (0..=MOST_STATES).filter_map(|states| data.fit(states)).collect();
    let least = models.iter().map(|model| model.cost).fold(f64::INFINITY, f64::min);
    let enough = |model: &&Model| {
        model.cost <= PREFERRED * least || (model.states == 0 && data.vaf(model) >= 1.0 - WITHOUT)
    };
    let Some(model) = models.iter().find(enough) else {
        return Part::not("roll rate and steer angle do not change");
    };
    let vaf = |model: &Model| data.vaf(model);
    if vaf(model) < LEAST_VAF {
        let percent = 100.0 * vaf(model);
        return Part::not(format!("roll rate and steer angle explain {percent:.0} % of the torque only"));
    }
    let Some(errors) = data.errors(model, checked.samples(MEMORY_S)) else {
        return Part::not("the coefficients of the law are not separable");
    };
    let nyquist_hz = 0.5 / checked.period_s;
    let frequencies = FREQUENCIES_HZ.into_iter().filter(|f| *f < 0.5 * nyquist_hz);
    let response = |(j, frequency_hz): (usize, f64)| {
        let turns = frequency_hz * checked.period_s;
        let response = model.response(j, turns);
        let mut magnitude = errors.estimate(response.magnitude(), &model.slope(j, turns))?;
        for other in models.iter().filter(|other| other.cost <= PREFERRED * model.cost) {
            let value = other.response(j, turns).magnitude();
            (magnitude.low, magnitude.high) = (magnitude.low.min(value), magnitude.high.max(value));
        }
        let phase_deg = response.0.argument().to_degrees();
        Some(Response { input: recorded[kept[j]].0, frequency_hz, magnitude, phase_deg })
    };
    let inputs = 0..data.inputs.len();
    let responses =
        inputs.flat_map(|j| frequencies.clone().map(move |f| (j, f))).filter_map(response).collect();
    let speeds = &record.speed_m_s[stretch.clone()];
    Part::Found(MemoryLaw {
        states: model.states,
        vaf: vaf(model),
        vaf_without: models.first().map_or(0.0, vaf),
        from_s: record.times_s[stretch.start],
        to_s: record.times_s[stretch.end - 1],
        speed_m_s: speeds.iter().sum::<f64>() / speeds.len() as f64,
        responses,
    })
}

/// The longest stretch of driven samples with known inputs and nearly one speed.
fn stretch(record: &Record, checked: &Checked, inputs: &[(Signal, &[f64])]) -> std::ops::Range<usize> {
    let speed = &record.speed_m_s;
    let known = |i: usize| {
        checked.driven[i] && speed[i] >= SLOWEST_M_S && inputs.iter().all(|(_, values)| values[i].is_finite())
    };
    let mut longest = 0..0;
    for run in checked.breaks.windows(2) {
        let mut from = run[0];
        for i in run[0]..run[1] {
            if !known(i) {
                from = i + 1;
                continue;
            }
            let apart = |k: &usize| speed[*k].max(speed[i]) > SAME_SPEED * speed[*k].min(speed[i]);
            from = (from..i).rev().find(apart).map_or(from, |k| k + 1);
            from = from.max((i + 1).saturating_sub(MOST_SAMPLES));
            if i + 1 - from > longest.len() {
                longest = from..i + 1;
            }
        }
    }
    longest
}

struct Data {
    torque: DVector<f64>,
    inputs: Vec<Vec<f64>>,
}

/// Coefficients: `states` of the torque's past, `states + 1` of each input, the constant, `states` of the initial state.
struct Model {
    states: usize,
    coefficients: DVector<f64>,
    /// Sum of squared residuals.
    cost: f64,
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

    fn fit(&self, states: usize) -> Option<Model> {
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

    fn vaf(&self, model: &Model) -> f64 {
        explained(self.torque.as_slice(), self.rest(model).as_slice(), &vec![true; self.len()])
    }

    /// Errors of the coefficients for correlated residuals.
    fn errors(&self, model: &Model, memory: usize) -> Option<Errors> {
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
struct Errors {
    triangle: DMatrix<f64>,
    scores: DMatrix<f64>,
    freedom: f64,
}

impl Errors {
    /// A function of the coefficients, with its gradient.
    fn estimate(&self, value: f64, gradient: &DVector<f64>) -> Option<Estimate> {
        let part = self.triangle.tr_solve_upper_triangular(gradient)?;
        let error = part.dot(&(&self.scores * &part)).max(0.0).sqrt();
        error.is_finite().then(|| Estimate::new(value, error, quantile(self.freedom)))
    }
}

/// The response to a sine.
#[derive(Clone, Copy)]
struct Sine(Complex<f64>);

impl Sine {
    fn magnitude(self) -> f64 {
        self.0.modulus()
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

    /// Response to input `j` at `turns` of a circle a sample.
    fn response(&self, j: usize, turns: f64) -> Sine {
        let place = self.place(j);
        let above = (0..=self.states).map(|i| delayed(turns, i) * self.coefficients[place + i]);
        Sine(above.sum::<Complex<f64>>() / self.denominator(turns))
    }

    /// Gradient of the response's magnitude: the part of the complex derivative along the response.
    fn slope(&self, j: usize, turns: f64) -> DVector<f64> {
        let (place, denominator) = (self.place(j), self.denominator(turns));
        let Sine(response) = self.response(j, turns);
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

/// The recursion with its poles moved inside the circle of [`FASTEST_POLE`].
fn stable(a: &[f64]) -> Vec<f64> {
    let n = a.len();
    let companion = DMatrix::from_fn(n, n, |i, j| match i {
        0 => a[j],
        _ => f64::from(u8::from(j + 1 == i)),
    });
    let mut polynomial = vec![Complex::new(1.0, 0.0)];
    if n > 0 {
        for pole in companion.complex_eigenvalues().iter() {
            let size = libm::hypot(pole.re, pole.im);
            let pole = if size > FASTEST_POLE { pole * (FASTEST_POLE / size) } else { *pole };
            polynomial.push(Complex::new(0.0, 0.0));
            for i in (1..polynomial.len()).rev() {
                let before = polynomial[i - 1];
                polynomial[i] -= pole * before;
            }
        }
    }
    polynomial[1..].iter().map(|coefficient| -coefficient.re).collect()
}
