//! The gray box in the frequency domain: the objective of the global search. It is finite for unstable gains too, smooth
//! across the limit of stability, and needs a thousandth of the operations of a response in time. Leakage makes it
//! approximate; the search in time starts from the minima found here.

use super::gray_box::{GAINS, GrayBox, PerGain};
use super::record::{Measured, Record};
use super::response::{Hold, Signal};
use nalgebra::{Complex, DMatrix, DVector, Matrix2, Vector2};
use physics::rider::Neuromuscular;
use std::f64::consts::TAU;

/// Highest frequency in use \[Hz\]: a rider's bandwidth is below 3 Hz.
const HIGHEST_HZ: f64 = 8.0;
/// Largest number of frequencies.
const MOST_LINES: usize = 1000;

type C = Complex<f64>;

/// One frequency of a record.
struct Line {
    s: C,
    /// Transfer function from the neural signal to the rider's torque, delay included.
    rider: C,
    /// `M s^2 + v C1 s + K`.
    dynamics: Matrix2<C>,
    /// Generalised forces of the disturbances.
    forces: Vector2<C>,
    /// Measured signals.
    measured: Vec<(Signal, C)>,
}

/// A record's spectra with the model's transfer functions at the same frequencies.
pub(super) struct Spectrum {
    lines: Vec<Line>,
    /// Reciprocal of each signal's root mean square.
    weights: Vec<f64>,
}

/// `sum x_k exp(-i angle k)`.
fn transform(values: impl Iterator<Item = f64>, angle: f64) -> C {
    let turn = turned(-angle);
    let mut phase = C::new(1.0, 0.0);
    let mut sum = C::ZERO;
    for x in values {
        sum += phase * x;
        phase *= turn;
    }
    sum
}

/// Values with straight lines across those that are not numbers, without their mean. Values that are not valid count here,
/// because a bridge over seconds would change the spectrum more than they do.
fn bridged(measured: &Measured) -> Vec<f64> {
    let mut values = measured.values.clone();
    let valid: Vec<usize> = (0..values.len()).filter(|k| values[*k].is_finite()).collect();
    let mean = valid.iter().map(|k| values[*k]).sum::<f64>() / valid.len().max(1) as f64;
    let (mut last, count) = (None, values.len());
    for next in valid.into_iter().map(Some).chain([None]) {
        let from = last.map_or(0, |k: usize| k + 1);
        for k in from..next.unwrap_or(count) {
            let (a, b) =
                (last.or(next).map_or(mean, |k| values[k]), next.or(last).map_or(mean, |k| values[k]));
            let share = (k + 1 - from) as f64 / (next.unwrap_or(count) + 1 - from) as f64;
            values[k] = a + (b - a) * share;
        }
        last = next;
    }
    values.iter_mut().for_each(|x| *x -= mean);
    values
}

/// The unit number at an angle \[rad\].
fn turned(angle: f64) -> C {
    C::new(libm::cos(angle), libm::sin(angle))
}

/// On the imaginary axis: `exp(-s delay)` times the neuromuscular dynamics.
fn rider(neuromuscular: &Neuromuscular, delay_s: f64, s: C) -> C {
    let (w, zeta) = (neuromuscular.omega_rad_s, neuromuscular.zeta);
    turned(-s.im * delay_s) * (w * w) / (s * s + s * (2.0 * zeta * w) + w * w)
}

/// Powers of `s` by which roll or steer become the signals of the gains p, i, d, dd.
fn powers(s: C) -> [C; 4] {
    [C::new(1.0, 0.0), s.inv(), s, s * s]
}

impl Spectrum {
    pub(super) fn new(record: &Record, model: &GrayBox) -> Self {
        let sample_s = record.disturbances.sample_s;
        let duration_s = record.duration_s();
        let highest_hz = HIGHEST_HZ.min(0.4 / sample_s);
        let every = (highest_hz * duration_s / MOST_LINES as f64).ceil().max(1.0);
        let count = (highest_hz * duration_s / every) as usize;
        let measured: Vec<(Signal, Vec<f64>)> =
            record.measured.iter().map(|m| (m.signal, bridged(m))).collect();
        let stiffness = model.stiffness();
        let line = |i: usize| {
            let frequency = TAU * i as f64 * every / duration_s;
            let s = C::new(0.0, frequency);
            let held = (C::new(1.0, 0.0) - turned(-frequency * sample_s)) / (s * sample_s);
            let held = match record.disturbances.hold {
                Hold::Zero => held,
                Hold::Linear => held * held * turned(frequency * sample_s),
            };
            let angle = frequency * sample_s;
            let disturbance =
                |input: usize| transform(record.disturbances.samples.iter().map(|x| x[input]), angle) * held;
            let (force, torque) = (disturbance(0), disturbance(1));
            let real = |x: f64| C::new(x, 0.0);
            let bicycle = &model.bicycle;
            Line {
                s,
                rider: rider(&model.neuromuscular, model.delay_s, s),
                dynamics: bicycle.m.map(real) * (s * s)
                    + bicycle.c1.map(real) * (s * model.speed_m_s)
                    + stiffness.map(real),
                forces: model.force_input.map(real) * force + Vector2::new(C::ZERO, torque),
                measured: measured
                    .iter()
                    .map(|(signal, values)| (*signal, transform(values.iter().copied(), angle)))
                    .collect(),
            }
        };
        let lines: Vec<Line> = (1..=count).map(line).collect();
        let weights = (0..measured.len()).map(|j| {
            let power: f64 = lines.iter().map(|line| line.measured[j].1.norm_sqr()).sum();
            if power > 0.0 { power.sqrt().recip() } else { 0.0 }
        });
        Self { weights: weights.collect(), lines }
    }

    /// The unexplained share of the power of the measured signals, their mean: 0 for a perfect model.
    pub(super) fn unexplained(&self, gains: &PerGain) -> f64 {
        let mut sum = 0.0;
        for line in &self.lines {
            let [roll, steer] = line.response(gains);
            for ((signal, measured), weight) in line.measured.iter().zip(&self.weights) {
                let answered = match signal {
                    Signal::Steer => steer,
                    Signal::Roll => roll,
                    Signal::RollRate => roll * line.s,
                };
                sum += (measured - answered).norm_sqr() * weight * weight;
            }
        }
        sum / self.weights.len() as f64
    }

    /// The gains of an equation-error fit, which is linear in them, iterated so that it tends to the output-error fit
    /// (Sanathanan and Koerner 1963). Every iterate is returned.
    pub(super) fn linear_fits(&self, active: &[usize], iterations: usize) -> Vec<PerGain> {
        let mut gains = PerGain::default();
        let mut fits = Vec::new();
        for _ in 0..iterations {
            let mut normal = DMatrix::<f64>::zeros(active.len(), active.len());
            let mut right = DVector::<f64>::zeros(active.len());
            for line in &self.lines {
                let weight = line.determinant(&gains).norm_sqr().recip();
                for ((signal, measured), own) in line.measured.iter().zip(&self.weights) {
                    let (regressors, open) = line.equation(*signal, *measured);
                    let row: Vec<C> = active.iter().map(|i| regressors[*i]).collect();
                    for (i, a) in row.iter().enumerate() {
                        right[i] += (a.conj() * open).re * weight * own * own;
                        for (j, b) in row.iter().enumerate() {
                            normal[(i, j)] += (a.conj() * b).re * weight * own * own;
                        }
                    }
                }
            }
            // Scaled, because the gains' units differ by orders of magnitude.
            let scale = normal.diagonal().map(|x| if x > 0.0 { x.sqrt().recip() } else { 0.0 });
            let scaled = DMatrix::from_fn(active.len(), active.len(), |i, j| {
                normal[(i, j)] * scale[i] * scale[j] + if i == j { 1e-12 } else { 0.0 }
            });
            let Some(solved) = scaled.cholesky().map(|c| c.solve(&right.component_mul(&scale))) else {
                break;
            };
            for (place, (x, unit)) in active.iter().zip(solved.iter().zip(scale.iter())) {
                gains[*place] = x * unit;
            }
            fits.push(gains);
        }
        fits
    }
}

impl Line {
    /// Gains on roll and steer at this frequency, neuromuscular dynamics and delay included.
    fn feedback(&self, gains: &PerGain) -> [C; 2] {
        let of = |first: usize| -> C {
            powers(self.s).iter().zip(&gains[first..first + 4]).map(|(power, gain)| power * *gain).sum()
        };
        [of(0) * self.rider, of(4) * self.rider]
    }

    fn determinant(&self, gains: &PerGain) -> C {
        let [of_roll, of_steer] = self.feedback(gains);
        let d = &self.dynamics;
        d[(0, 0)] * (d[(1, 1)] - of_steer) - d[(0, 1)] * (d[(1, 0)] - of_roll)
    }

    /// Roll and steer.
    fn response(&self, gains: &PerGain) -> [C; 2] {
        let [of_roll, of_steer] = self.feedback(gains);
        let (d, f) = (&self.dynamics, &self.forces);
        let (c, e) = (d[(1, 0)] - of_roll, d[(1, 1)] - of_steer);
        let determinant = d[(0, 0)] * e - d[(0, 1)] * c;
        [(e * f[0] - d[(0, 1)] * f[1]) / determinant, (d[(0, 0)] * f[1] - c * f[0]) / determinant]
    }

    /// The loop's equation for a measured signal, linear in the gains: `sum gain * regressor = open`.
    fn equation(&self, signal: Signal, measured: C) -> ([C; GAINS], C) {
        let (d, f) = (&self.dynamics, &self.forces);
        let whole = d[(0, 0)] * d[(1, 1)] - d[(0, 1)] * d[(1, 0)];
        let (of_roll, of_steer, open) = match signal {
            Signal::Steer => (
                f[0] - d[(0, 1)] * measured,
                d[(0, 0)] * measured,
                measured * whole - d[(0, 0)] * f[1] + d[(1, 0)] * f[0],
            ),
            Signal::Roll | Signal::RollRate => {
                let roll = if signal == Signal::Roll { measured } else { measured / self.s };
                (
                    -d[(0, 1)] * roll,
                    d[(0, 0)] * roll - f[0],
                    roll * whole - d[(1, 1)] * f[0] + d[(0, 1)] * f[1],
                )
            }
        };
        let powers = powers(self.s);
        let regressors = std::array::from_fn(|i| {
            let angle = if i < 4 { of_roll } else { of_steer };
            powers[i % 4] * angle * self.rider
        });
        (regressors, open)
    }
}
