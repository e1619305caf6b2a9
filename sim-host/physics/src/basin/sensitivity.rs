//! Sensitivity of the basin's height to each parameter of bicycle and rider, by central differences.

use super::Column;
use super::scan::Edge;
use super::search::{Axis, Method, Search, SearchError, border};
use crate::bicycle::{self, Geometry, Parameters};
use crate::ride::{Conditions, Foreseen, Quick, QuickRide, Ride, Start, rides};
use crate::rider::{KEYS, Rider, Schedule};
use rayon::prelude::*;

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
        efforts: false,
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

/// The border nearest to `guess` \[rad/s\]: by quick rides, confirmed by exact ones on both sides; by exact ones alone where there are no
/// quick ones, or these do not decide or are contradicted. The disturbances are the same, and so are the bits.
fn near(conditions: &Conditions, speed: f64, guess: f64, tolerance: f64) -> f64 {
    let starts = |rates: &[f64]| -> Vec<Start> {
        rates.iter().map(|&rate| Axis::SteerRate.start(speed, rate)).collect()
    };
    let exact = |rates: &[f64]| times(&rides(conditions, &starts(rates)));
    let falls_s = |ride: &QuickRide| match ride.outcome {
        None if ride.upright => Some(None),
        outcome => outcome.map(|outcome| outcome.time_to_fall_s()),
    };
    let quick = Quick::new(conditions).map(|quick| quick.fine());
    let confirmed = quick.and_then(|quick| {
        let quickly = |rates: &[f64]| quick.rides(&starts(rates)).iter().map(falls_s).collect();
        let decided = |rides: &[Point], beyond_s: f64| {
            let foreseen = |&(rate, fall_s): &Point| Foreseen {
                start: Axis::SteerRate.start(speed, rate),
                lasts_s: fall_s.unwrap_or(conditions.time_limit_s),
                exact_s: fall_s.map_or(beyond_s, |_| f64::INFINITY),
            };
            times(&quick.decided(&rides.iter().map(foreseen).collect::<Vec<_>>()))
        };
        nearest(quickly, guess, tolerance)?.confirmed(decided)
    });
    let plainly = || nearest(|rates| Some(exact(rates)), guess, tolerance).map(|found| found.border());
    confirmed.or_else(plainly).unwrap_or(f64::NAN)
}

/// The times of their falls \[s\]; `None` of rides that do not fall.
fn times(rides: &[Ride]) -> Vec<Option<f64>> {
    rides.iter().map(|ride| ride.outcome.time_to_fall_s()).collect()
}

/// Rides of a confirmation: as many as take little longer than one.
const AT_ONCE: usize = 4;

/// A disturbance \[rad/s\] and the time of its fall \[s\], `None` if it does not fall.
type Point = (f64, Option<f64>);

/// The last disturbances tried around a border, with the place of the last that does not fall before the first that does.
struct Nearest {
    points: Vec<Point>,
    safe: usize,
}

/// The border nearest to `guess` \[rad/s\], narrow to `tolerance`; `None` if `falls_s` does not decide which of some disturbances
/// make the bicycle fall, and when.
///
/// Eight rides around it, over an increasing width until the first does not fall and another does. The edge is then narrowed
/// as usual. If all of the greatest width fall, the border is zero.
fn nearest(
    mut falls_s: impl FnMut(&[f64]) -> Option<Vec<Option<f64>>>,
    guess: f64,
    tolerance: f64,
) -> Option<Nearest> {
    let mut tried =
        |rates: &[f64]| -> Option<Vec<Point>> { Some(rates.iter().copied().zip(falls_s(rates)?).collect()) };
    let first_fall = |points: &[Point]| points.iter().position(|(_, fall_s)| fall_s.is_some());
    let mut width = 8e-3;
    let mut found = loop {
        let away = [-1.0, -0.25, -0.0625, -0.015, 0.015, 0.0625, 0.25, 1.0];
        let points = tried(&away.map(|part| (guess + width * part).max(0.0)))?;
        match first_fall(&points) {
            Some(first) if first > 0 => break Nearest { points, safe: first - 1 },
            _ if width > guess.max(1.0) => {
                let safe = if first_fall(&points).is_none() { points[7].0 } else { 0.0 };
                return Some(Nearest { points: vec![(safe, None)], safe: 0 });
            }
            _ => width *= 8.0,
        }
    };
    loop {
        let ends = &found.points[found.safe..=found.safe + 1];
        let edge = Edge { safe: ends[0].0, fell: ends[1].0 };
        if edge.narrow(tolerance) {
            return Some(found);
        }
        let sections = tried(&edge.sections())?;
        let safe = first_fall(&sections).unwrap_or(sections.len());
        found = Nearest { points: [&ends[..1], &sections, &ends[1..]].concat(), safe };
    }
}

impl Nearest {
    /// The largest disturbance that does not fall.
    fn border(&self) -> f64 {
        self.points[self.safe].0
    }

    /// The same by rides at both sides of the border and, while these contradict it, farther away; `None` if it is not between two
    /// of the points. `falls_s` gets points, and the time of the first fall beyond the border \[s\].
    fn confirmed(&self, falls_s: impl Fn(&[Point], f64) -> Vec<Option<f64>>) -> Option<f64> {
        let last = self.points.len().checked_sub(AT_ONCE)?;
        let beyond_s = self.points.get(self.safe + 1)?.1?;
        let mut from = self.safe.saturating_sub(1).min(last);
        loop {
            let some = self.points.get(from..from + AT_ONCE)?;
            // The next points contain one of these, so that the search does not return.
            from = match falls_s(some, beyond_s).iter().position(Option::is_some) {
                Some(0) if from == 0 => return None,
                None if from == last => return None,
                Some(0) => from.saturating_sub(AT_ONCE - 1),
                None => (from + AT_ONCE - 1).min(last),
                Some(first) => return some.get(first - 1).map(|point| point.0),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bicycle::catalogue;
    use crate::ride::Assist;
    use crate::rider::{Fit, Outside};

    /// Situation: the smart, old rider at 4.3 m/s, with and without a parameter changed. Action: the border near good and bad
    /// guesses. Must hold: the bits are those of exact rides alone.
    #[test]
    fn quick_rides_find_the_border_of_exact_ones() {
        let parameters = catalogue::load("rigid_jason").unwrap().parameters;
        let table = crate::rider::catalogue::load("smart").unwrap();
        let rider = table.rider(Fit::Mean, Outside::Extrapolate, None).unwrap();
        let bicycle = Geometry::new(&parameters);
        let usual = Conditions { rider: Some(rider), ..Conditions::thesis(bicycle, Assist::None) };
        for (quantity, guess) in [(Quantity::Gain(2), 4.44), (Quantity::Bicycle(0), 4.2)] {
            let conditions = quantity.scaled(&usual, &parameters, 1.01).unwrap();
            let exact = |rates: &[f64]| {
                let starts: Vec<Start> = rates.iter().map(|&rate| Axis::SteerRate.start(4.3, rate)).collect();
                Some(times(&rides(&conditions, &starts)))
            };
            let border = nearest(exact, guess, 3e-4).unwrap().border();
            assert!((3.5..5.5).contains(&border), "{border}");
            assert_eq!(near(&conditions, 4.3, guess, 3e-4), border, "{quantity:?}");
        }
    }

    /// Situation: a border located at each of ten points, the true one between any two of them or outside. Action: confirm it.
    /// Must hold: the last point before the true border, in at most a ride for each point and one more for each further batch;
    /// nothing if it is outside.
    #[test]
    fn a_border_located_wrongly_is_found_beside() {
        let falls = |rate: f64, after: u32| (rate > f64::from(after) - 0.5).then_some(1.0);
        for safe in 0..9 {
            let points = (0..10).map(|i| (f64::from(i), falls(f64::from(i), safe + 1))).collect();
            let located = Nearest { points, safe: safe as usize };
            for border in 0..11 {
                let found =
                    |some: &[Point], _: f64| some.iter().map(|point| falls(point.0, border)).collect();
                let expected = (1..10).contains(&border).then(|| f64::from(border) - 1.0);
                assert_eq!(located.confirmed(found), expected, "at {safe}, in truth before {border}");
            }
        }
    }
}
