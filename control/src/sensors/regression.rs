//! How much of what is expected to happen does happen: 1 all of it, 0 nothing, -1 the opposite.
//!
//! The least-squares slope of what is seen over what is expected, both freed of what is slow, over the recent
//! past. A wrong sign shows in it within a fraction of a second, and noise that has nothing to do with
//! what is expected averages out.

use crate::maths::{bounded, rsqrt};

/// Length of the shortest stretches, those of the motor's response \[s\]; the others are whole numbers of them, so that
/// their ends never meet.
pub(crate) const STRETCH_S: f32 = 0.008;

/// How fast must something be to count, how long does it count, and how much must there be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeConfig {
    /// Time constant above which things are too slow \[s\].
    pub highpass_s: f32,
    /// Time constant of forgetting \[s\].
    pub forget_s: f32,
    /// Largest value that is believed of what is seen, in its unit.
    pub max_measured: f32,
    /// What the square of what is expected, summed over time, must reach before a slope is told, in its unit
    /// squared, times s.
    pub min_excitation: f32,
    /// For how long it must have been enough \[s\]: the first moments of an excitation are told by few steps.
    pub settle_s: f32,
}

/// What follows from it for steps of one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopePlan {
    config: SlopeConfig,
    /// Length of a step \[s\].
    pub dt_s: f32,
    /// What a step leaves of what is slow, and of the past.
    keep: f32,
    forget: f32,
}

impl SlopePlan {
    /// For steps of `dt_s`.
    pub fn new(config: SlopeConfig, dt_s: f32) -> Self {
        let (keep, forget) = (1.0 / (1.0 + dt_s / config.highpass_s), 1.0 / (1.0 + dt_s / config.forget_s));
        Self { config, dt_s, keep, forget }
    }
}

/// What is remembered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slope {
    expected: f32,
    measured: f32,
    square: f32,
    product: f32,
    measured_square: f32,
    /// For how long enough has happened \[s\].
    excited_s: f32,
}

impl Slope {
    /// Takes in by how much both have changed in a step; the slope, if enough has happened.
    pub fn step(&mut self, plan: &SlopePlan, expected: f32, measured: f32) -> Option<f32> {
        let SlopePlan { config, dt_s, keep, forget } = *plan;
        self.expected = keep * (self.expected + expected);
        self.measured = keep * (self.measured + measured);
        let y = bounded(self.measured, config.max_measured);
        self.square = forget * (self.square + dt_s * self.expected * self.expected);
        self.product = forget * (self.product + dt_s * self.expected * y);
        self.measured_square = forget * (self.measured_square + dt_s * y * y);
        self.excited_s = if self.square > config.min_excitation { self.excited_s + dt_s } else { 0.0 };
        self.value(&config)
    }

    /// The slope, if enough has happened.
    pub fn value(&self, config: &SlopeConfig) -> Option<f32> {
        (self.excited_s > config.settle_s).then(|| self.product / self.square)
    }

    /// The correlation of what is seen with what is expected, -1 to 1, if enough has happened. Other than the slope it does
    /// not depend on the size of what is expected, and what has another reason makes it small.
    pub fn correlation(&self, config: &SlopeConfig) -> Option<f32> {
        (self.excited_s > config.settle_s)
            .then(|| self.product * rsqrt(self.square) * rsqrt(self.measured_square))
    }
}

/// Means over short stretches of control periods, and the stretch before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch<const N: usize> {
    sums: [f32; N],
    periods: u16,
    before: Option<[f32; N]>,
}

impl<const N: usize> Default for Stretch<N> {
    fn default() -> Self {
        Self { sums: [0.0; N], periods: 0, before: None }
    }
}

impl<const N: usize> Stretch<N> {
    /// Takes in a control period's values.
    #[inline]
    pub fn add(&mut self, values: [f32; N]) {
        for (sum, value) in self.sums.iter_mut().zip(values) {
            *sum += value;
        }
        self.periods = self.periods.saturating_add(1);
    }

    /// Ends the stretch: its means, and those of the one before. One without any values has none, and none is before
    /// the next.
    pub fn end(&mut self) -> Option<([f32; N], [f32; N])> {
        if self.periods == 0 {
            *self = Self::default();
            return None;
        }
        let share = 1.0 / f32::from(self.periods);
        let means = self.sums.map(|sum| share * sum);
        let before = self.before.replace(means);
        (self.sums, self.periods) = ([0.0; N], 0);
        before.map(|before| (means, before))
    }
}
