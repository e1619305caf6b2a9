//! Fits motor models to the weave measured on the balance-assist prototype.

use super::published_weave::{Weave, weave};
use crate::bicycle::Parameters;
use crate::eigen::LinearActuator;
use crate::simplex::minimum;
use nalgebra::Complex;

/// A free parameter of the fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// Ratio of given to requested torque.
    Scale,
    /// Viscous friction.
    Friction,
    /// The motor's time constant.
    Lag,
    /// The delay of the request.
    Delay,
    /// The rotor's inertia about the steer axis.
    Inertia,
}

impl Free {
    fn start(self) -> f64 {
        match self {
            Self::Scale => 0.7,
            Self::Friction => 0.3,
            Self::Lag => 0.02,
            Self::Delay => 0.01,
            Self::Inertia => 0.05,
        }
    }

    fn of(self, actuator: &mut LinearActuator) -> &mut f64 {
        match self {
            Self::Scale => &mut actuator.scale,
            Self::Friction => &mut actuator.viscous_nm_s_rad,
            Self::Lag => &mut actuator.time_constant_s,
            Self::Delay => &mut actuator.delay_s,
            Self::Inertia => &mut actuator.inertia_kg_m2,
        }
    }
}

/// Result of a motor fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Explained {
    /// Its name.
    pub name: &'static str,
    /// The free parameters.
    pub free: &'static [Free],
    /// The fitted motor, driven by the slope set in the controller.
    pub actuator: LinearActuator,
    /// Root of the mean squared distance between model and measurement, over all eigenvalues \[1/s\].
    pub residual: f64,
    /// The residual of the real parts alone (decay).
    pub residual_re: f64,
    /// The residual of the imaginary parts alone (frequency).
    pub residual_im: f64,
}

/// The sets of free parameters, from none to all.
pub const FITS: [(&str, &[Free]); 9] = {
    use Free::{Delay, Friction, Inertia, Lag, Scale};
    [
        ("a perfect motor", &[]),
        ("less torque than asked for", &[Scale]),
        ("less torque, friction", &[Scale, Friction]),
        ("less torque, lag", &[Scale, Lag]),
        ("lag, friction", &[Lag, Friction]),
        ("less torque, lag, friction", &[Scale, Lag, Friction]),
        ("less torque, delay, friction", &[Scale, Delay, Friction]),
        ("friction, inertia", &[Friction, Inertia]),
        ("torque, lag, friction, inertia", &[Scale, Lag, Friction, Inertia]),
    ]
};

/// Every fit of [`FITS`], in their order.
pub fn fits(bicycle: &Parameters, measured: &[Weave]) -> Vec<Explained> {
    let mut done: Vec<Explained> = Vec::new();
    for named in FITS {
        done.push(fit(bicycle, measured, named, &done));
    }
    done
}

/// Fits the parameters in `free` to both measured series at once, by least squares of the distances in the complex
/// plane, with the slope set in the controller. There are local minima, so the search starts three times: once from the
/// default and twice from the best of the fits in `done` with fewer free parameters.
fn fit(
    bicycle: &Parameters,
    measured: &[Weave],
    (name, free): (&'static str, &'static [Free]),
    done: &[Explained],
) -> Explained {
    let less = done.iter().filter(|e| e.free.iter().all(|f| free.contains(f)));
    let less = less.min_by(|a, b| a.residual.total_cmp(&b.residual));
    let mut starts = vec![free.iter().map(|f| f.start()).collect::<Vec<f64>>()];
    if let Some(less) = less {
        let mut actuator = less.actuator;
        starts.push(free.iter().map(|f| *f.of(&mut actuator)).collect());
        let begun = |f: &Free| if less.free.contains(f) { *f.of(&mut actuator) } else { f.start() };
        starts.push(free.iter().map(begun).collect());
    }
    let ends = starts.iter().map(|start| {
        let best = match free.len() {
            0 => Vec::new(),
            1 => search::<1>(bicycle, measured, free, start),
            2 => search::<2>(bicycle, measured, free, start),
            3 => search::<3>(bicycle, measured, free, start),
            _ => search::<4>(bicycle, measured, free, start),
        };
        let actuator = chosen(free, &best);
        let [residual, residual_re, residual_im] = residuals(bicycle, measured, actuator, |w| w.kappa_set);
        Explained { name, free, actuator, residual, residual_re, residual_im }
    });
    ends.min_by(|a, b| a.residual.total_cmp(&b.residual)).expect("there are starts")
}

/// The residuals of an ideal motor with the slope of the published model: both parts, real, imaginary.
pub fn published_residual(bicycle: &Parameters, measured: &[Weave]) -> [f64; 3] {
    residuals(bicycle, measured, LinearActuator::default(), |w| w.kappa_model)
}

fn search<const N: usize>(
    bicycle: &Parameters,
    measured: &[Weave],
    free: &[Free],
    start: &[f64],
) -> Vec<f64> {
    let miss = |x: &[f64; N]| match x.iter().all(|value| *value >= 0.0) {
        true => residuals(bicycle, measured, chosen(free, x), |w| w.kappa_set)[0],
        false => f64::INFINITY,
    };
    let start: [f64; N] = std::array::from_fn(|i| start[i]);
    minimum(start, miss).to_vec()
}

fn chosen(free: &[Free], values: &[f64]) -> LinearActuator {
    let mut actuator = LinearActuator::default();
    free.iter().zip(values).for_each(|(free, value)| *free.of(&mut actuator) = *value);
    actuator
}

/// Root mean squares of distance, real and imaginary part; infinite where the model has no weave pair.
fn residuals(
    bicycle: &Parameters,
    measured: &[Weave],
    actuator: LinearActuator,
    slope: impl Fn(&Weave) -> f32,
) -> [f64; 3] {
    let mut off: Vec<Complex<f64>> = Vec::new();
    for series in measured {
        let model = weave(bicycle, slope(series), actuator, &series.speed_m_s);
        let pairs = model.into_iter().zip(series.roots());
        off.extend(pairs.map(|(model, root)| model.map_or(Complex::from(f64::INFINITY), |m| m - root)));
    }
    let root_mean =
        |part: &dyn Fn(&Complex<f64>) -> f64| (off.iter().map(part).sum::<f64>() / off.len() as f64).sqrt();
    [root_mean(&|c| c.norm_sqr()), root_mean(&|c| c.re * c.re), root_mean(&|c| c.im * c.im)]
}
