//! Sensitivity of the basin's height to each parameter of bicycle and rider, by central differences.

use super::Column;
use super::plain::narrow;
use super::scan::Edge;
use super::search::{Axis, Method, Search, SearchError, border};
use crate::bicycle::{self, Geometry, Parameters};
use crate::ride::{Conditions, Ride, rides};
use crate::rider::{KEYS, Rider, Schedule};
use rayon::prelude::*;
use std::convert::Infallible;

/// A parameter of the bicycle or the rider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A gain, by its index in [`KEYS`], at all speeds.
    Gain(usize),
    /// The neural delay.
    Delay,
    /// Undamped natural frequency of the neuromuscular dynamics.
    NeuromuscularFrequency,
    /// Damping ratio of the neuromuscular dynamics.
    NeuromuscularDamping,
    /// A parameter of the bicycle, by its index in [`bicycle::KEYS`].
    Bicycle(usize),
}

impl Quantity {
    /// All parameters of `rider` and a bicycle, without gains that are zero at all speeds.
    pub fn all(rider: &Rider) -> Vec<Self> {
        let used = |&i: &usize| rider.schedule.points().iter().any(|(_, gains)| gains.0[i] != 0.0);
        let gains = (0..KEYS.len()).filter(used).map(Self::Gain);
        let body = [Self::Delay, Self::NeuromuscularFrequency, Self::NeuromuscularDamping];
        gains.chain(body).chain((0..bicycle::KEYS.len()).map(Self::Bicycle)).collect()
    }

    /// Symbol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gain(i) => KEYS[i],
            Self::Delay => "tau_d",
            Self::NeuromuscularFrequency => "omega_nm",
            Self::NeuromuscularDamping => "zeta_nm",
            Self::Bicycle(i) => bicycle::KEYS[i],
        }
    }

    /// The conditions with the parameter multiplied by `factor`.
    ///
    /// # Errors
    /// The schedule or the conditions reject the value; a delay must be a whole number of steps.
    pub fn scaled(
        self,
        conditions: &Conditions,
        parameters: &Parameters,
        factor: f64,
    ) -> Result<Conditions, SearchError> {
        let mut changed = conditions.clone();
        if let Self::Bicycle(i) = self {
            let mut values = parameters.to_values();
            values[i] *= factor;
            changed.bicycle = Geometry::new(&Parameters::from_values(&values));
        }
        if let Some(rider) = &mut changed.rider {
            match self {
                Self::Gain(i) => {
                    let mut points = rider.schedule.points().to_vec();
                    points.iter_mut().for_each(|(_, gains)| gains.0[i] *= factor);
                    let outside = rider.schedule.outside();
                    rider.schedule = Schedule::new(points, outside)?;
                }
                Self::Delay => rider.delay_s *= factor,
                Self::NeuromuscularFrequency => rider.neuromuscular.omega_rad_s *= factor,
                Self::NeuromuscularDamping => rider.neuromuscular.zeta *= factor,
                Self::Bicycle(_) => {}
            }
        }
        changed.check()?;
        Ok(changed)
    }

    /// Relative step of the differences: `PERCENT`; for a delay two time steps.
    fn step(self, conditions: &Conditions) -> f64 {
        match (self, &conditions.rider) {
            (Self::Delay, Some(rider)) => 2.0 * conditions.step_s / rider.delay_s,
            _ => 0.01 * PERCENT,
        }
    }
}

/// The larger step of the differences \[%\].
const PERCENT: f64 = 1.0;

/// Sensitivity of the basin's height at one speed to a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// The parameter.
    pub quantity: Quantity,
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// The height \[rad/s\].
    pub height: f64,
    /// Change of the height for +1 % \[rad/s\].
    pub per_percent: f64,
    /// The same with half the step.
    pub halved: f64,
    /// Largest error of `halved` (the less certain of the two) from the tolerance of the borders \[rad/s\].
    pub resolution: f64,
}

impl Sensitivity {
    /// Elasticity: relative change of the height over relative change of the parameter.
    pub fn elasticity(&self) -> f64 {
        100.0 * self.per_percent / self.height
    }

    /// Whether both steps agree within a tenth plus twice the resolution of the borders.
    pub fn is_smooth(&self) -> bool {
        let apart = (self.halved - self.per_percent).abs();
        apart <= 2.0 * self.resolution + 0.1 * self.per_percent.abs().max(self.halved.abs())
    }
}

/// Computes the sensitivities at `speed` \[m/s\] to `quantities`, with borders within `tolerance` \[rad/s\],
/// on all cores of the current rayon pool. `parameters` are those of the conditions' bicycle.
///
/// # Errors
/// The conditions fail their checks, also with a parameter changed, or no ride falls up to 20 rad/s.
pub fn sensitivities(
    conditions: &Conditions,
    parameters: &Parameters,
    quantities: &[Quantity],
    speed: f64,
    tolerance: f64,
) -> Result<Vec<Sensitivity>, SearchError> {
    conditions.check()?;
    let search = Search {
        speeds: vec![speed],
        axis: Axis::SteerRate,
        max_rate: 20.0,
        scan_step: 0.25,
        tolerance,
        method: Method::Fast,
    };
    search.check()?;
    let Column { upper: height, capped, .. } = border(conditions, &search, speed);
    if capped {
        return Err(SearchError::NothingFalls { max_rate: search.max_rate, speed });
    }
    let one = |&quantity: &Quantity| -> Result<Sensitivity, SearchError> {
        let step = quantity.step(conditions);
        let at = |factor: f64, guess: f64| -> Result<f64, SearchError> {
            let changed = quantity.scaled(conditions, parameters, factor)?;
            Ok(near(&changed, speed, guess, tolerance))
        };
        let (low, high) = (at(1.0 - step, height)?, at(1.0 + step, height)?);
        let half = 0.5 * step;
        let (inner_low, inner_high) =
            (at(1.0 - half, 0.5 * (height + low))?, at(1.0 + half, 0.5 * (height + high))?);
        let per_percent = |low: f64, high: f64, step: f64| (high - low) / (200.0 * step);
        Ok(Sensitivity {
            quantity,
            speed,
            height,
            per_percent: per_percent(low, high, step),
            halved: per_percent(inner_low, inner_high, half),
            resolution: per_percent(0.0, tolerance, half),
        })
    };
    quantities.par_iter().map(one).collect()
}

/// The border nearest to `guess` \[rad/s\].
///
/// Eight rides around it, over an increasing width until the first does not fall and another does. The border
/// is then narrowed as usual.
fn near(conditions: &Conditions, speed: f64, guess: f64, tolerance: f64) -> f64 {
    let mut ride = |rates: &[f64]| -> Result<Vec<Ride>, Infallible> {
        let starts: Vec<_> = rates.iter().map(|&rate| Axis::SteerRate.start(speed, rate)).collect();
        Ok(rides(conditions, &starts))
    };
    let mut width = 8e-3;
    loop {
        let away = [-1.0, -0.25, -0.0625, -0.015, 0.015, 0.0625, 0.25, 1.0];
        let rates = away.map(|part| (guess + width * part).max(0.0));
        let Ok(done) = ride(&rates);
        let first = done.iter().position(Ride::fell);
        match first {
            Some(first) if first > 0 => {
                let edge = Edge { safe: rates[first - 1], fell: rates[first] };
                let Ok(border) = narrow(&mut ride, edge, None, tolerance, None);
                return border.safe;
            }
            _ if width > guess.max(1.0) => return if first.is_none() { rates[7] } else { 0.0 },
            _ => width *= 8.0,
        }
    }
}
