//! Response of the gray box to recorded disturbances, with its exact derivatives with respect to the gains.

use super::gray_box::{GAINS, GrayBox, INPUTS, OpenLoop, PerGain, STATES};
use super::interval::{Interval, NODES, SOURCES};
use crate::exponential::exponential_of;
use nalgebra::{RowSVector, SMatrix, SVector};

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

/// The states of the loop.
pub(super) type State = [f64; STATES];

/// Angles whose gains are the drivers of [`Response::tangents`]: roll and steer.
const ANGLES: usize = 2;

/// States at the samples, from rest.
#[derive(Clone, Debug, Default)]
pub(super) struct Response {
    /// Roll, steer and roll rate at each sample.
    pub(super) states: Vec<[f64; 3]>,
    /// The derivatives of the state with respect to the gains on the roll angle and on the steer angle, of which [`by_gain`]
    /// makes those with respect to all gains; empty if not requested.
    pub(super) tangents: Vec<[State; ANGLES]>,
}

/// Derivatives of `signal` with respect to the gains p, i, d and dd on an angle, each as a linear function of the state's
/// derivative with respect to p: the loop is linear, begins at rest and does not change over time, so that driven by the
/// angle's integral, rate or acceleration it moves by the integral, rate or acceleration of its motion when driven by the angle.
pub(super) fn by_gain(model: &GrayBox, signal: Signal) -> [State; 4] {
    let system = model.open_loop();
    let (angle, order) = match signal {
        Signal::Roll => (0, 1),
        Signal::Steer => (1, 1),
        Signal::RollRate => (0, 2),
    };
    let unit = |state: usize| RowSVector::<f64, STATES>::from_fn(|_, j| f64::from(u8::from(j == state)));
    let acceleration: RowSVector<f64, STATES> = system.a.row(2 + angle).into();
    // The neural signal is part of the torque's second derivative only, and none of the jerk.
    let courses = [unit(4 + angle), unit(angle), unit(2 + angle), acceleration, acceleration * system.a];
    [order, order - 1, order + 1, order + 2].map(|order| courses[order].transpose().into())
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
    fn store(&mut self, x: &State, tangents: Option<&[State; ANGLES]>) -> bool {
        self.states.push([x[0], x[1], x[2]]);
        self.tangents.extend(tangents);
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

/// Sources of an interval without the disturbances.
const MOTION: usize = STATES + 2 * NODES;
/// State and neural signal at the nodes at the end of an interval, and zeros that make whole vectors.
const MOVED: usize = STATES + NODES + 1;
/// Nodes between the ends of an interval.
const BETWEEN: usize = NODES - 2;

/// A matrix by those of its columns that are not zero, each with its number.
struct Columns<const R: usize>(Vec<(usize, [f64; R])>);

impl<const R: usize> Columns<R> {
    /// The first `count` columns of a matrix with these elements by row and column; zero in the rows that are beyond it.
    fn new(count: usize, element: impl Fn(usize, usize) -> f64) -> Self {
        let all = (0..count).map(|j| (j, std::array::from_fn(|i| element(i, j))));
        Self(all.filter(|(_, column): &(usize, [f64; R])| column.iter().any(|x| *x != 0.0)).collect())
    }

    /// Product with a vector, of which many entries are zero: there are disturbances now and then.
    #[inline]
    fn times(&self, vector: &[f64]) -> [f64; R] {
        let mut sum = [0.0; R];
        for (j, column) in &self.0 {
            let factor = vector[*j];
            if factor == 0.0 {
                continue;
            }
            sum.iter_mut().zip(column).for_each(|(sum, x)| *sum += x * factor);
        }
        sum
    }
}

/// A motion in the delayed loop, of the state or of its derivative.
struct Course {
    x: State,
    /// The neural signal at the nodes of each past interval.
    past: Vec<[f64; NODES]>,
}

impl Course {
    fn at_rest(interval: &Interval) -> Self {
        Self { x: [0.0; STATES], past: vec![[0.0; NODES]; interval.lag + 1] }
    }

    /// What the interval depends on beside the disturbances: the state and the signal of two past intervals.
    #[inline]
    fn fill(&self, sources: &mut [f64; SOURCES], older: usize, newer: usize) {
        sources[..STATES].copy_from_slice(&self.x);
        sources[STATES..STATES + NODES].copy_from_slice(&self.past[older]);
        sources[STATES + NODES..MOTION].copy_from_slice(&self.past[newer]);
    }

    /// Takes the end of an interval, and its neural signal less `driven` in place of the oldest.
    #[inline]
    fn moved(&mut self, end: &[f64; MOVED], older: usize, driven: [f64; NODES]) {
        self.x.copy_from_slice(&end[..STATES]);
        self.past[older] = std::array::from_fn(|i| end[STATES + i] + driven[i]);
    }
}

fn delayed(
    interval: &Interval,
    parts: usize,
    disturbances: &Disturbances,
    gains: &PerGain,
    tangents: bool,
) -> Option<Response> {
    let gains = SVector::<f64, GAINS>::from_column_slice(gains).transpose();
    let neural = interval.signals.map(|signals| gains * signals);
    let end = |i: usize, j: usize| match i.checked_sub(STATES) {
        None => interval.end[(i, j)],
        Some(node) => neural.get(node).map_or(0.0, |of_sources| of_sources[j]),
    };
    let (disturbed, free) = (Columns::<MOVED>::new(SOURCES, end), Columns::<MOVED>::new(MOTION, end));
    // Roll and steer at the nodes between the ends: the signals of the gains that drive the tangents.
    let angles = Columns::<{ ANGLES * BETWEEN }>::new(SOURCES, |i, j| {
        interval.signals[1 + i % BETWEEN][(GAINS / ANGLES * (i / BETWEEN), j)]
    });
    let samples = disturbances.samples.len();
    let mut response = Response::with_room(samples, tangents);
    let mut motion = Course::at_rest(interval);
    let mut derived: [Course; ANGLES] = std::array::from_fn(|_| Course::at_rest(interval));
    let (mut newest, mut sources) = (0, [0.0; SOURCES]);
    for k in 0..samples {
        let stored = tangents.then(|| derived.each_ref().map(|course| course.x));
        if !response.store(&motion.x, stored.as_ref()) {
            return None;
        }
        for part in 0..parts {
            // Of `lag + 1` entries the oldest is the one after the newest.
            let older = (newest + 1) % motion.past.len();
            let newer = (newest + 2) % motion.past.len();
            motion.fill(&mut sources, older, newer);
            for (i, [start, end]) in disturbances.over(k, part, parts).into_iter().enumerate() {
                (sources[MOTION + 2 * i], sources[MOTION + 2 * i + 1]) = (start, end);
            }
            let before = motion.x;
            motion.moved(&disturbed.times(&sources), older, [0.0; NODES]);
            if tangents {
                let between = angles.times(&sources);
                for (angle, derived) in derived.iter_mut().enumerate() {
                    let driven = std::array::from_fn(|node| match node {
                        0 => before[angle],
                        node if node <= BETWEEN => between[angle * BETWEEN + node - 1],
                        _ => motion.x[angle],
                    });
                    derived.fill(&mut sources, older, newer);
                    derived.moved(&free.times(&sources), older, driven);
                }
            }
            newest = older;
        }
    }
    Some(response)
}

/// Value and slope of each disturbance.
const FORCES: usize = 2 * INPUTS;
/// State and disturbances.
const FORCED: usize = STATES + FORCES;
/// The derivatives of the state, the state and the disturbances.
const ALL: usize = ANGLES * STATES + FORCED;

/// The loop closed by `gains` without delay: the rates of [`FORCED`].
fn closed(system: &OpenLoop, gains: &PerGain) -> SMatrix<f64, FORCED, FORCED> {
    let row = SVector::<f64, GAINS>::from_column_slice(gains).transpose();
    let input = system.input + system.alpha * (row * system.d);
    let mut rates = SMatrix::<f64, FORCED, FORCED>::zeros();
    rates.fixed_view_mut::<STATES, STATES>(0, 0).copy_from(&(system.a + system.alpha * (row * system.c)));
    for i in 0..INPUTS {
        let place = STATES + 2 * i;
        rates.fixed_view_mut::<STATES, 1>(0, place).copy_from(&input.column(i));
        rates[(place, place + 1)] = 1.0;
    }
    rates
}

/// With the derivatives of the state before it: each is driven by the angle of its gain.
fn with_tangents(system: &OpenLoop, closed: &SMatrix<f64, FORCED, FORCED>) -> SMatrix<f64, ALL, ALL> {
    let mut rates = SMatrix::<f64, ALL, ALL>::zeros();
    let state = ANGLES * STATES;
    rates.fixed_view_mut::<FORCED, FORCED>(state, state).copy_from(closed);
    for angle in 0..ANGLES {
        let place = angle * STATES;
        let own = closed.fixed_view::<STATES, STATES>(0, 0);
        rates.fixed_view_mut::<STATES, STATES>(place, place).copy_from(&own);
        rates.fixed_view_mut::<STATES, 1>(place, state + angle).copy_from(&system.alpha);
    }
    rates
}

fn undelayed(
    model: &GrayBox,
    sample_s: f64,
    disturbances: &Disturbances,
    gains: &PerGain,
    tangents: bool,
) -> Option<Response> {
    let system = model.open_loop();
    let closed = closed(&system, gains);
    let end = exponential_of(&(closed * sample_s));
    let end = Columns::<STATES>::new(FORCED, |i, j| end[(i, j)]);
    // Every angle's columns of its own derivative of the state, then those of the state and the disturbances.
    let driven = tangents.then(|| {
        let all = exponential_of(&(with_tangents(&system, &closed) * sample_s));
        std::array::from_fn::<_, ANGLES, _>(|angle| {
            Columns::<STATES>::new(STATES + FORCED, |i, j| {
                let first = if j < STATES { angle } else { ANGLES - 1 };
                all[(angle * STATES + i, first * STATES + j)]
            })
        })
    });
    let samples = disturbances.samples.len();
    let mut response = Response::with_room(samples, tangents);
    let (mut x, mut dx) = ([0.0; STATES], [[0.0; STATES]; ANGLES]);
    for k in 0..samples {
        if !response.store(&x, tangents.then_some(&dx)) {
            return None;
        }
        let mut sources = [0.0; STATES + FORCED];
        sources[STATES..2 * STATES].copy_from_slice(&x);
        for (i, [start, end]) in disturbances.over(k, 0, 1).into_iter().enumerate() {
            sources[2 * STATES + 2 * i] = start;
            sources[2 * STATES + 2 * i + 1] = (end - start) / sample_s;
        }
        for (dx, driven) in dx.iter_mut().zip(driven.iter().flatten()) {
            sources[..STATES].copy_from_slice(dx);
            *dx = driven.times(&sources);
        }
        x = end.times(&sources[STATES..]);
    }
    Some(response)
}
