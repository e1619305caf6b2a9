//! Least-squares slope of measured over expected change: 1 as expected, 0 no response, -1 reversed.
//!
//! Both signals are high-pass filtered, and older samples are weighted down exponentially. A wrong sign shows within a
//! fraction of a second; noise that is independent of the expected change averages out.

use crate::maths::{bounded, rsqrt};

/// Length of the shortest blocks, those of the motor check of `sign_check` \[s\]. Other blocks are integer multiples,
/// so block ends never coincide.
pub(crate) const BLOCK_S: f32 = 0.008;

/// High-pass and forgetting time constants, and the minimum excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeConfig {
    /// Time constant of the high-pass \[s\].
    pub highpass_s: f32,
    /// Time constant of the exponential forgetting \[s\].
    pub forget_s: f32,
    /// Limit of the measured signal's magnitude, in its unit.
    pub max_measured: f32,
    /// Minimum excitation: integral over time of the squared expected signal before a slope is given, in its unit
    /// squared, times s.
    pub min_excitation: f32,
    /// Time for which the excitation must have been sufficient \[s\]: the first moments of an excitation contain few
    /// steps.
    pub settle_s: f32,
}

/// Constants derived from the configuration for steps of one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopePlan {
    config: SlopeConfig,
    /// Length of a step \[s\].
    pub dt_s: f32,
    /// Factors that a step applies to the high-pass state and to the sums.
    keep: f32,
    forget: f32,
}

impl SlopePlan {
    /// For steps of `dt_s` seconds.
    pub fn new(config: SlopeConfig, dt_s: f32) -> Self {
        let (keep, forget) = (1.0 / (1.0 + dt_s / config.highpass_s), 1.0 / (1.0 + dt_s / config.forget_s));
        Self { config, dt_s, keep, forget }
    }
}

/// State of the regression.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct Slope {
    expected: f32,
    measured: f32,
    square: f32,
    product: f32,
    measured_square: f32,
    /// Time for which the excitation has been sufficient \[s\].
    excited_s: f32,
}

impl Slope {
    /// Adds the changes of both signals in a step; returns the slope, if the excitation suffices.
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

    /// The slope, if the excitation suffices.
    pub fn value(&self, config: &SlopeConfig) -> Option<f32> {
        (self.excited_s > config.settle_s).then(|| self.product / self.square)
    }

    /// Correlation of measured and expected signal, -1 to 1, if the excitation suffices. Unlike the slope it does not
    /// depend on the size of the expected signal, and other causes of the measured signal reduce it.
    pub fn correlation(&self, config: &SlopeConfig) -> Option<f32> {
        (self.excited_s > config.settle_s)
            .then(|| self.product * rsqrt(self.square) * rsqrt(self.measured_square))
    }
}

/// Means over short blocks of control periods, and of the previous block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct BlockMean<const N: usize> {
    sums: [f32; N],
    periods: u16,
    before: Option<[f32; N]>,
}

impl<const N: usize> Default for BlockMean<N> {
    fn default() -> Self {
        Self { sums: [0.0; N], periods: 0, before: None }
    }
}

impl<const N: usize> BlockMean<N> {
    /// Adds the values of a control period.
    #[inline]
    pub fn add(&mut self, values: [f32; N]) {
        for (sum, value) in self.sums.iter_mut().zip(values) {
            *sum += value;
        }
        self.periods = self.periods.saturating_add(1);
    }

    /// Ends the block; returns its means and those of the previous block. A block without values has no means, and the
    /// next block has no previous one.
    pub fn end(&mut self) -> Option<([f32; N], [f32; N])> {
        if self.periods == 0 {
            *self = Self::default();
            return None;
        }
        let per_period = 1.0 / f32::from(self.periods);
        let means = self.sums.map(|sum| per_period * sum);
        let before = self.before.replace(means);
        (self.sums, self.periods) = ([0.0; N], 0);
        before.map(|before| (means, before))
    }
}
