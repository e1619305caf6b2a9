//! Response of the gray box to recorded disturbances, with its exact derivatives with respect to the gains.

use super::gray_box::{GAINS, GrayBox, INPUTS, PerGain, STATES};
use super::interval::{Interval, NODES, OfSources, SOURCES};
use crate::exponential::exponential_of;
use nalgebra::{SMatrix, SVector};

/// Measured quantities that a model can be fitted to.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Signal {
    /// Steer angle.
    Steer,
    /// Roll angle.
    Roll,
    /// Roll rate.
    RollRate,
}

impl Signal {
    /// All signals.
    pub const ALL: [Self; 3] = [Self::Steer, Self::Roll, Self::RollRate];

    /// Index in the state.
    pub(super) fn state(self) -> usize {
        match self {
            Self::Roll => 0,
            Self::Steer => 1,
            Self::RollRate => 2,
        }
    }

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Steer => "steer",
            Self::Roll => "roll",
            Self::RollRate => "roll-rate",
        }
    }
}

/// Course of a disturbance between two samples.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Hold {
    /// Constant until the next sample.
    #[default]
    Zero,
    /// A straight line to the next sample.
    Linear,
}

/// Recorded disturbances at equal intervals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Disturbances {
    /// Time between two samples \[s\].
    pub sample_s: f64,
    /// Lateral force \[N\] and steer torque \[N m\] at each sample.
    pub samples: Vec<[f64; INPUTS]>,
    /// Their course in between.
    pub hold: Hold,
}

impl Disturbances {
    /// Values at start and end of part `part` of `parts` of sample `k`.
    fn over(&self, k: usize, part: usize, parts: usize) -> [[f64; 2]; INPUTS] {
        let here = self.samples[k];
        let next = match self.hold {
            Hold::Zero => here,
            Hold::Linear => self.samples.get(k + 1).copied().unwrap_or(here),
        };
        let at = |i: usize, j: usize| here[i] + (next[i] - here[i]) * j as f64 / parts as f64;
        std::array::from_fn(|i| [at(i, part), at(i, part + 1)])
    }
}

/// The derivatives of each state with respect to each gain.
type Tangents = [PerGain; STATES];

/// States at the samples, from rest.
#[derive(Clone, Debug, Default)]
pub(super) struct Response {
    /// Roll, steer and roll rate at each sample.
    pub(super) states: Vec<[f64; 3]>,
    /// Their derivatives with respect to each gain; empty if not requested.
    pub(super) tangents: Vec<[PerGain; 3]>,
}

/// Roll or steer angle at which a linear response counts as unbounded \[rad\]: no recorded ride comes near.
const UNBOUNDED_RAD: f64 = 1e3;

impl Response {
    fn with_room(samples: usize, tangents: bool) -> Self {
        Self {
            states: Vec::with_capacity(samples),
            tangents: Vec::with_capacity(if tangents { samples } else { 0 }),
        }
    }

    /// Stores the state at a sample; false if the motion is no longer bounded.
    fn store(&mut self, x: &SVector<f64, STATES>, tangents: Option<&Tangents>) -> bool {
        self.states.push([x[0], x[1], x[2]]);
        self.tangents.extend(tangents.map(|t| [t[0], t[1], t[2]]));
        x[0].abs() < UNBOUNDED_RAD && x[1].abs() < UNBOUNDED_RAD
    }
}

/// The gray box discretised for one sample time; gains are given later.
pub(super) enum Discrete {
    Delayed { interval: Box<Interval>, parts: usize },
    Undelayed { model: Box<GrayBox>, sample_s: f64 },
}

impl Discrete {
    pub(super) fn new(model: &GrayBox, sample_s: f64) -> Self {
        match Interval::new(model, sample_s) {
            Some(interval) => {
                let parts = (sample_s / interval.length_s).round() as usize;
                Self::Delayed { interval: Box::new(interval), parts }
            }
            None => Self::Undelayed { model: Box::new(*model), sample_s },
        }
    }

    /// The response; `None` if it grows without bound.
    pub(super) fn respond(
        &self,
        disturbances: &Disturbances,
        gains: &PerGain,
        tangents: bool,
    ) -> Option<Response> {
        match self {
            Self::Delayed { interval, parts } => delayed(interval, *parts, disturbances, gains, tangents),
            Self::Undelayed { model, sample_s } => undelayed(model, *sample_s, disturbances, gains, tangents),
        }
    }
}

impl GrayBox {
    /// Roll \[rad\], steer \[rad\] and roll rate \[rad/s\] at each sample, from rest, of the loop closed by `gains`;
    /// `None` if the response grows without bound.
    pub fn response(&self, disturbances: &Disturbances, gains: &PerGain) -> Option<Vec<[f64; 3]>> {
        let discrete = Discrete::new(self, disturbances.sample_s);
        Some(discrete.respond(disturbances, gains, false)?.states)
    }

    /// Response to a unit impulse of the lateral force (`input` 0) or the steer torque (1) over one sample: roll \[rad\], steer
    /// \[rad\] and roll rate \[rad/s\] per N s or N m s at `count` multiples of `sample_s`, from 0 on, as an
    /// [`Fir`](super::Fir) estimates it. `None` if it grows without bound.
    pub fn impulse_response(
        &self,
        gains: &PerGain,
        (input, hold): (usize, Hold),
        sample_s: f64,
        count: usize,
    ) -> Option<Vec<[f64; 3]>> {
        let mut samples = vec![[0.0; INPUTS]; count + 1];
        // The second sample: with straight lines between the samples, an impulse begins one sample earlier.
        samples.get_mut(1)?[input] = sample_s.recip();
        Some(self.response(&Disturbances { sample_s, samples, hold }, gains)?.split_off(1))
    }
}

fn delayed(
    interval: &Interval,
    parts: usize,
    disturbances: &Disturbances,
    gains: &PerGain,
    tangents: bool,
) -> Option<Response> {
    let gains = SVector::<f64, GAINS>::from_column_slice(gains);
    let neural = SMatrix::<f64, NODES, SOURCES>::from_rows(&std::array::from_fn::<_, NODES, _>(|i| {
        gains.transpose() * interval.signals[i]
    }));
    // The tangents are not disturbed.
    let of_motion = |m: &SMatrix<f64, STATES, SOURCES>| m.fixed_columns::<MOTION>(0).into_owned();
    let tangent_end = of_motion(&interval.end);
    let tangent_neural = neural.fixed_columns::<MOTION>(0).into_owned();
    let samples = disturbances.samples.len();
    let mut response = Response::with_room(samples, tangents);
    let mut x = SVector::<f64, STATES>::zeros();
    let mut dx: Tangents = [[0.0; GAINS]; STATES];
    // The neural signal at the nodes of each past interval, and its derivatives.
    let mut past = vec![SVector::<f64, NODES>::zeros(); interval.lag + 1];
    let mut past_tangents = vec![[[0.0; GAINS]; NODES]; interval.lag + 1];
    let mut newest = 0;
    for k in 0..samples {
        if !response.store(&x, tangents.then_some(&dx)) {
            return None;
        }
        for part in 0..parts {
            // Of `lag + 1` entries the oldest is the one after the newest.
            let older = (newest + 1) % past.len();
            let newer = (newest + 2) % past.len();
            let mut sources = OfSources::zeros();
            sources.fixed_rows_mut::<STATES>(0).copy_from(&x);
            sources.fixed_rows_mut::<NODES>(STATES).copy_from(&past[older]);
            sources.fixed_rows_mut::<NODES>(STATES + NODES).copy_from(&past[newer]);
            for (i, [start, end]) in disturbances.over(k, part, parts).into_iter().enumerate() {
                (sources[MOTION + 2 * i], sources[MOTION + 2 * i + 1]) = (start, end);
            }
            if tangents {
                let mut motion = [[0.0; GAINS]; MOTION];
                motion[..STATES].copy_from_slice(&dx);
                motion[STATES..STATES + NODES].copy_from_slice(&past_tangents[older]);
                motion[STATES + NODES..].copy_from_slice(&past_tangents[newer]);
                dx = times(&tangent_end, &motion);
                let mut signal = times(&tangent_neural, &motion);
                for (signal, of_sources) in signal.iter_mut().zip(&interval.signals) {
                    let fed_back = of_sources * sources;
                    signal.iter_mut().zip(fed_back.iter()).for_each(|(sum, x)| *sum += x);
                }
                past_tangents[older] = signal;
            }
            x = interval.end * sources;
            past[older] = neural * sources;
            newest = older;
        }
    }
    Some(response)
}

/// Product of a matrix and derivatives: all gains side by side, which the compiler makes vector instructions.
fn times<const R: usize, const K: usize>(
    matrix: &SMatrix<f64, R, K>,
    derivatives: &[PerGain; K],
) -> [PerGain; R] {
    std::array::from_fn(|row| {
        let mut sum = [0.0; GAINS];
        for (column, derivative) in derivatives.iter().enumerate() {
            let factor = matrix[(row, column)];
            sum.iter_mut().zip(derivative).for_each(|(sum, x)| *sum += factor * x);
        }
        sum
    })
}

/// Sources of an interval without the disturbances.
const MOTION: usize = STATES + 2 * NODES;
/// State, and value and slope of each disturbance.
const FORCED: usize = STATES + 2 * INPUTS;
/// The same with one gain's derivative of the state.
const BOTH: usize = 2 * STATES + 2 * INPUTS;

fn undelayed(
    model: &GrayBox,
    sample_s: f64,
    disturbances: &Disturbances,
    gains: &PerGain,
    tangents: bool,
) -> Option<Response> {
    let system = model.open_loop();
    let row = SVector::<f64, GAINS>::from_column_slice(gains).transpose();
    let closed = system.a + system.alpha * (row * system.c);
    let input = system.input + system.alpha * (row * system.d);
    // One gain's derivative is driven by the signal of that gain.
    let step = |gain: usize| {
        let mut generator = SMatrix::<f64, BOTH, BOTH>::zeros();
        generator.fixed_view_mut::<STATES, STATES>(0, 0).copy_from(&closed);
        generator.fixed_view_mut::<STATES, STATES>(STATES, STATES).copy_from(&closed);
        let driven = system.alpha * system.c.row(gain);
        generator.fixed_view_mut::<STATES, STATES>(STATES, 0).copy_from(&driven);
        for i in 0..INPUTS {
            let place = 2 * STATES + 2 * i;
            let direct = system.alpha * system.d[(gain, i)];
            generator.fixed_view_mut::<STATES, 1>(0, place).copy_from(&input.column(i));
            generator.fixed_view_mut::<STATES, 1>(STATES, place).copy_from(&direct);
            generator[(place, place + 1)] = 1.0;
        }
        exponential_of(&(generator * sample_s))
    };
    let steps: Vec<_> = (0..if tangents { GAINS } else { 1 }).map(step).collect();
    let forced = |of: &SMatrix<f64, BOTH, BOTH>, first: usize| {
        let mut map = SMatrix::<f64, STATES, FORCED>::zeros();
        map.fixed_columns_mut::<STATES>(0).copy_from(&of.fixed_view::<STATES, STATES>(first, 0));
        let inputs = of.fixed_view::<STATES, { 2 * INPUTS }>(first, 2 * STATES);
        map.fixed_columns_mut::<{ 2 * INPUTS }>(STATES).copy_from(&inputs);
        map
    };
    let end = forced(&steps[0], 0);
    let free = end.fixed_columns::<STATES>(0).into_owned();
    let driven: Vec<_> = steps.iter().map(|step| forced(step, STATES)).collect();
    let samples = disturbances.samples.len();
    let mut response = Response::with_room(samples, tangents);
    let mut x = SVector::<f64, STATES>::zeros();
    let mut dx: Tangents = [[0.0; GAINS]; STATES];
    for k in 0..samples {
        if !response.store(&x, tangents.then_some(&dx)) {
            return None;
        }
        let mut sources = SVector::<f64, FORCED>::zeros();
        sources.fixed_rows_mut::<STATES>(0).copy_from(&x);
        for (i, [start, end]) in disturbances.over(k, 0, 1).into_iter().enumerate() {
            sources[STATES + 2 * i] = start;
            sources[STATES + 2 * i + 1] = (end - start) / sample_s;
        }
        if tangents {
            dx = times(&free, &dx);
            for (gain, map) in driven.iter().enumerate() {
                let by_signal = map * sources;
                dx.iter_mut().zip(by_signal.iter()).for_each(|(of_state, x)| of_state[gain] += x);
            }
        }
        x = end * sources;
    }
    Some(response)
}
