//! Black box: the response to the perturbation as a finite impulse response, without a model of bicycle or rider. It separates
//! the response from the rider's own motion, which is noise for the fit (Schwab et al. 2013, De Lange's filtering step).

use super::objective::Drift;
use super::record::{Measured, Record};
use nalgebra::{DMatrix, DVector};

/// Largest number of coefficients for each disturbance.
const MOST_TAPS: usize = 160;

/// Impulse response and what it explains of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Fir {
    /// Time between two coefficients \[s\]; straight lines in between.
    pub step_s: f64,
    /// Impulse response to lateral force \[per N s\] and steer torque \[per N m s\] at the multiples of `step_s`, from the first;
    /// empty for a disturbance that is zero throughout.
    pub taps: [Vec<f64>; 2],
    /// The response at each sample.
    pub response: Vec<f64>,
    /// Power of the response over that of the rest.
    pub signal_to_noise: f64,
}

/// Estimates the impulse response of `measured` up to `length_s` by least squares; `None` if the record is too short or not
/// excited enough for it.
pub fn impulse_response(record: &Record, measured: &Measured, drift: Drift, length_s: f64) -> Option<Fir> {
    let sample_s = record.disturbances.sample_s;
    let every = (length_s / sample_s / MOST_TAPS as f64).ceil().max(1.0) as usize;
    let taps = (length_s / sample_s / every as f64).ceil() as usize;
    let inputs: Vec<Vec<f64>> =
        (0..2).map(|input| smoothed(record.disturbances.samples.iter().map(|x| x[input]), every)).collect();
    let moving: Vec<usize> = (0..2).filter(|i| inputs[*i].iter().any(|x| *x != 0.0)).collect();
    let drifts = drift.basis(record);
    let unknown = taps * moving.len() + drifts.ncols();
    let rows: Vec<usize> = (0..record.len()).filter(|k| measured.valid[*k]).collect();
    if moving.is_empty() || rows.len() < 2 * unknown {
        return None;
    }
    let regressor = |k: usize, column: usize| match (column / taps, column % taps) {
        (which, tap) if which < moving.len() => {
            k.checked_sub((tap + 1) * every).map_or(0.0, |before| inputs[moving[which]][before])
        }
        _ => drifts[(k, column - taps * moving.len())],
    };
    let matrix = DMatrix::from_fn(rows.len(), unknown, |row, column| regressor(rows[row], column));
    let values = DVector::from_iterator(rows.len(), rows.iter().map(|k| measured.values[*k]));
    let mut normal = matrix.tr_mul(&matrix);
    let ridge = 1e-9 * normal.diagonal().max();
    (0..unknown).for_each(|i| normal[(i, i)] += ridge);
    let solved = normal.cholesky()?.solve(&matrix.tr_mul(&values));
    let of_taps = taps * moving.len();
    let answered = |k: usize| (0..of_taps).map(|column| regressor(k, column) * solved[column]).sum::<f64>();
    let response: Vec<f64> = (0..record.len()).map(answered).collect();
    let rest = &values - &matrix * &solved;
    let power = rows.iter().map(|k| response[*k].powi(2)).sum::<f64>();
    // A coefficient is the response to 1 N or 1 N m during one sample.
    let scale = sample_s.recip();
    let of = |input: usize| {
        let place = moving.iter().position(|i| *i == input);
        place.map_or(Vec::new(), |which| (0..taps).map(|tap| solved[which * taps + tap] * scale).collect())
    };
    Some(Fir {
        step_s: every as f64 * sample_s,
        taps: [of(0), of(1)],
        response,
        signal_to_noise: power / rest.norm_squared(),
    })
}

/// Values summed with the weights of a hat that reaches `every` samples to both sides and has an area of `every`.
fn smoothed(values: impl Iterator<Item = f64>, every: usize) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let reach = every as isize;
    let at = |k: isize| usize::try_from(k).ok().and_then(|k| values.get(k)).copied().unwrap_or(0.0);
    let hat = |offset: isize| 1.0 - offset.abs() as f64 / every as f64;
    (0..values.len() as isize).map(|k| (1 - reach..reach).map(|o| hat(o) * at(k - o)).sum::<f64>()).collect()
}
