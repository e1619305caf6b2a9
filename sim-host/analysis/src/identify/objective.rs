//! The difference between record and gray box, as a least-squares problem in the gains.

use super::gray_box::{GrayBox, PerGain};
use super::record::Record;
use super::response::{Discrete, Signal, State, by_gain};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Slow motion of a measured signal that is no response to the perturbation: offset of a sensor, drift of the rider on the
/// treadmill. It is estimated together with the gains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Drift {
    /// None: the signals are used as they are.
    None,
    /// A constant.
    #[default]
    Offset,
    /// All slower than this frequency \[Hz\]: cosines over the record.
    Below(f64),
}

impl Drift {
    /// The number of cosines, the constant included, over `duration_s`.
    fn columns(self, duration_s: f64) -> usize {
        match self {
            Self::None => 0,
            Self::Offset => 1,
            Self::Below(frequency_hz) => 1 + (2.0 * frequency_hz * duration_s) as usize,
        }
    }

    /// The cosines over the samples of `record`, one per column.
    pub(super) fn basis(self, record: &Record) -> DMatrix<f64> {
        let count = record.len();
        DMatrix::from_fn(count, self.columns(record.duration_s()).min(count), |row, order| {
            libm::cos(PI * order as f64 * (row as f64 + 0.5) / count as f64)
        })
    }
}

/// One measured signal of the problem.
struct Output {
    signal: Signal,
    /// Its derivatives with respect to the gains of an angle.
    by_gain: [State; 4],
    /// The samples in use.
    samples: Vec<usize>,
    /// Their values.
    values: DVector<f64>,
    /// Orthonormal basis of the drift over these samples.
    drift: DMatrix<f64>,
    /// Reciprocal of the standard deviation of the signal's noise.
    weight: f64,
}

/// The least-squares problem of one record, model and choice of samples.
pub(super) struct Objective<'a> {
    record: &'a Record,
    discrete: Discrete,
    outputs: Vec<Output>,
}

/// Residuals of all signals one after another, in units of their noise, without drift.
pub(super) struct Evaluation {
    pub(super) residual: DVector<f64>,
    /// Derivative of the model's response with respect to the fitted gains; no column if not requested.
    pub(super) jacobian: DMatrix<f64>,
}

impl Evaluation {
    pub(super) fn cost(&self) -> f64 {
        self.residual.norm_squared()
    }
}

/// A part of the record: which samples count.
pub(super) type Chosen<'a> = &'a dyn Fn(usize) -> bool;

impl<'a> Objective<'a> {
    /// The problem over the samples that are valid and `chosen`. All signals have the weight of their own root mean
    /// square until [`Objective::reweighted`].
    pub(super) fn new(record: &'a Record, model: &GrayBox, drift: Drift, chosen: Chosen) -> Self {
        let whole = drift.basis(record);
        let output = |measured: &super::record::Measured| {
            let samples: Vec<usize> =
                (0..record.len()).filter(|k| measured.valid[*k] && chosen(*k)).collect();
            let basis = whole.select_rows(&samples);
            let mut output = Output {
                signal: measured.signal,
                by_gain: by_gain(model, measured.signal),
                values: DVector::from_iterator(samples.len(), samples.iter().map(|k| measured.values[*k])),
                drift: basis.qr().q(),
                weight: 1.0,
                samples,
            };
            let rest = output.without_drift(output.values.clone());
            let mean_square = rest.norm_squared() / rest.len().max(1) as f64;
            output.weight = if mean_square > 0.0 { mean_square.sqrt().recip() } else { 1.0 };
            output
        };
        let outputs = record.measured.iter().map(output).collect();
        let discrete = Discrete::new(model, record.disturbances.sample_s);
        Self { record, discrete, outputs }
    }

    /// Weighs each signal by its noise: the mean squares of the residuals of a fit, SI.
    pub(super) fn weighted(mut self, mean_squares: impl Iterator<Item = f64>) -> Self {
        for (output, mean_square) in self.outputs.iter_mut().zip(mean_squares) {
            // A signal without noise would leave the others without effect.
            output.weight = mean_square.max(1e-16).sqrt().recip();
        }
        self
    }

    /// Mean square of the residuals of each signal, SI.
    pub(super) fn mean_squares(&self, at: &Evaluation) -> Vec<f64> {
        let mut first = 0;
        let of = |output: &Output| {
            let length = output.values.len();
            let sum = at.residual.rows(first, length).norm_squared();
            first += length;
            sum / (length as f64 * output.weight * output.weight)
        };
        self.outputs.iter().map(of).collect()
    }

    /// The number of samples of all signals.
    pub(super) fn size(&self) -> usize {
        self.outputs.iter().map(|output| output.values.len()).sum()
    }

    /// Length of each signal's part of the residuals.
    pub(super) fn lengths(&self) -> impl Iterator<Item = usize> + '_ {
        self.outputs.iter().map(|output| output.values.len())
    }

    /// Residuals of a response: roll, steer and roll rate at each sample.
    pub(super) fn residual(&self, response: &[[f64; 3]]) -> DVector<f64> {
        let mut residual = DVector::zeros(self.size());
        let mut first = 0;
        for output in &self.outputs {
            let rest = &output.values - output.of(response);
            residual
                .rows_mut(first, output.values.len())
                .copy_from(&(output.without_drift(rest) * output.weight));
            first += output.values.len();
        }
        residual
    }

    /// Each measured signal less a response and the drift \[rad or rad/s\]; NaN for samples that are not in use.
    pub(super) fn differences(&self, response: &[[f64; 3]]) -> Vec<Vec<f64>> {
        let of = |output: &Output| {
            let rest = output.without_drift(&output.values - output.of(response));
            let mut whole = vec![f64::NAN; self.record.len()];
            output.samples.iter().zip(rest.iter()).for_each(|(k, rest)| whole[*k] = *rest);
            whole
        };
        self.outputs.iter().map(of).collect()
    }

    /// Residuals at `gains`, and the Jacobian for those of the indices `active`; `None` if the response is unbounded.
    pub(super) fn evaluate(&self, gains: &PerGain, active: &[usize]) -> Option<Evaluation> {
        let response = self.discrete.respond(&self.record.disturbances, gains, !active.is_empty())?;
        let residual = self.residual(&response.states);
        let mut columns = DMatrix::zeros(self.size(), active.len());
        let mut first = 0;
        for output in &self.outputs {
            let count = output.values.len();
            for (column, gain) in active.iter().enumerate() {
                let (angle, of_state) = (gain / 4, &output.by_gain[gain % 4]);
                let of = output.samples.iter().map(|k| dot(of_state, &response.tangents[*k][angle]));
                let of = output.without_drift(DVector::from_iterator(count, of)) * output.weight;
                columns.view_mut((first, column), (count, 1)).copy_from(&of);
            }
            first += count;
        }
        Some(Evaluation { residual, jacobian: columns })
    }

    /// Variance accounted for of each signal, eq. 2.12: `1 - sum (y - yhat)^2 / sum y^2`, with `y` the measured signal less
    /// its drift as estimated with the response; over the samples `within`.
    pub(super) fn vaf(&self, gains: &PerGain, within: Chosen) -> Option<Vec<f64>> {
        let response = self.discrete.respond(&self.record.disturbances, gains, false)?;
        Some(self.vaf_of(&response.states, within))
    }

    /// The same of a response.
    pub(super) fn vaf_of(&self, response: &[[f64; 3]], within: Chosen) -> Vec<f64> {
        let of = |output: &Output| {
            let answered = output.of(response);
            let rest = output.without_drift(&output.values - &answered);
            let (mut unexplained, mut all) = (0.0, 0.0);
            for (row, _) in output.samples.iter().enumerate().filter(|(_, k)| within(**k)) {
                unexplained += rest[row].powi(2);
                // Without drift, the measured signal is the response plus the rest.
                all += (rest[row] + answered[row]).powi(2);
            }
            1.0 - unexplained / all
        };
        self.outputs.iter().map(of).collect()
    }
}

fn dot(a: &State, b: &State) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Output {
    /// The signal in a response, at the samples in use.
    fn of(&self, response: &[[f64; 3]]) -> DVector<f64> {
        let at = self.samples.iter().map(|k| response[*k][self.signal.state()]);
        DVector::from_iterator(self.samples.len(), at)
    }

    fn without_drift(&self, values: DVector<f64>) -> DVector<f64> {
        if self.drift.ncols() == 0 {
            return values;
        }
        let along = self.drift.tr_mul(&values);
        values - &self.drift * along
    }
}
