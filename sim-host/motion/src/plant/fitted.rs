//! Sensor errors fitted to recordings, beyond those of a data sheet: bias spread and random walk, white noise
//! per axis, vibration proportional to speed, sampling jitter. `docs/plant.md`, `docs/sensors.md`.

use super::{PlantError, Sensor};
use crate::num::RandomStream;
use crate::num::sin_cos;
use crate::range::within;
use control::sensors::wheel_speed::{self, Direction, WheelPulses, WheelPulsesConfig, WheelPulsesState};
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Lower ends of the octaves of vibration \[Hz\]. Each ends where the next begins, the last at 160 Hz; none
/// extends beyond half the sensor's sample rate.
pub const OCTAVES_HZ: [f64; 4] = [10.0, 20.0, 40.0, 80.0];
/// Sinusoids per octave: enough for their sum to be practically normal in a ride.
const SINUSOIDS: usize = 12;
/// Longest averaging window and longest jitter \[control periods\].
const MAX_TICKS: u16 = 10_000;

/// Errors fitted to recordings. The default has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct FittedErrors {
    /// Offset of the sampling instants from the whole multiples of `every_ticks` \[control periods\].
    pub phase_ticks: u16,
    /// Random delay of a sample \[control periods\]: uniform up to the first value for 99 in 100 samples,
    /// from there to the second for the others.
    pub jitter_ticks: [u16; 2],
    /// A sample is the mean over this number of control periods; 0 and 1 are no averaging.
    pub window_ticks: u16,
    /// Pulses per turn, for wheels: the speed is computed from pulses by `control::sensors::wheel_speed`; 0
    /// is none.
    pub pulses_per_turn: u16,
    /// Standard deviation of white normal noise on every sample, by axis, in the sensor's unit.
    pub white: [f64; 3],
    /// Random walk of the bias, by axis, in the sensor's unit per square root of a second.
    pub walk: [f64; 3],
    /// Standard deviation of a bias that is drawn once per ride, by axis, in the sensor's unit.
    pub bias_spread: [f64; 3],
    /// Root mean square of the vibration in each of [`OCTAVES_HZ`], by axis, in the sensor's unit per 1 m/s
    /// of forward speed.
    pub vibration: [[f64; 4]; 3],
    /// Quantisation step, by axis, in the sensor's unit; 0 is none.
    pub quantum: [f64; 3],
    /// Probability that a sample repeats the previous one.
    pub repeat: f64,
}

impl FittedErrors {
    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self, sensor: Sensor, every_ticks: u16) -> Result<(), PlantError> {
        let name = sensor.name();
        let within = |key: &str, value, min, max| within(&format!("{name} {key}"), value, min, max);
        let ticks = |key: &str, value: u16, max: u16| within(key, f64::from(value), 0.0, f64::from(max));
        ticks("phase (control periods)", self.phase_ticks, every_ticks.saturating_sub(1))?;
        self.jitter_ticks.iter().try_for_each(|t| ticks("jitter (control periods)", *t, MAX_TICKS))?;
        if self.jitter_ticks[1] < self.jitter_ticks[0] {
            return Err(PlantError::Jitter { sensor: name });
        }
        ticks("window (control periods)", self.window_ticks, MAX_TICKS)?;
        ticks("pulses per turn", self.pulses_per_turn, 4096)?;
        if self.pulses_per_turn > 0 && !matches!(sensor, Sensor::FrontWheel | Sensor::RearWheel) {
            return Err(PlantError::Pulses { sensor: name });
        }
        let by_axis = [
            ("white", self.white),
            ("walk", self.walk),
            ("bias spread", self.bias_spread),
            ("quantum", self.quantum),
        ];
        for (key, axes) in by_axis {
            axes.iter().try_for_each(|x| within(key, *x, 0.0, 1e3))?;
        }
        self.vibration.iter().flatten().try_for_each(|x| within("vibration", *x, 0.0, 1e3))?;
        within("repeat", self.repeat, 0.0, 0.999)?;
        Ok(())
    }

    /// Whether any error is random.
    pub(super) fn draws(&self) -> bool {
        let quiet = Self {
            phase_ticks: self.phase_ticks,
            window_ticks: self.window_ticks,
            pulses_per_turn: self.pulses_per_turn,
            quantum: self.quantum,
            ..Self::default()
        };
        *self != quiet
    }
}

/// State of the fitted errors of one sensor in one ride.
#[derive(Debug)]
pub(super) struct FittedState {
    random: RandomStream,
    /// Bias of this ride plus its random walk, by axis.
    bias: [f64; 3],
    /// Square root of the time between samples \[s^0.5\].
    root_s: f64,
    vibration: Vec<[Vec<Octave>; 3]>,
    /// True values of the control periods in the averaging window, newest last.
    window: VecDeque<[f64; 3]>,
    counter: Option<PulseCounter>,
    last: Option<[f64; 3]>,
    /// Delayed samples and the ticks at which they are due.
    late: VecDeque<(i64, [f64; 3])>,
}

impl FittedState {
    /// State before boot: the true value was `steady`; a sample each `sample_s`, a control period of
    /// `period_s`.
    pub(super) fn new(
        errors: &FittedErrors,
        steady: [f64; 3],
        sample_s: f64,
        period_s: f64,
        mut random: RandomStream,
    ) -> Self {
        let bias = errors.bias_spread.map(|spread| if spread > 0.0 { spread * random.normal() } else { 0.0 });
        let shakes = errors.vibration != [[0.0; 4]; 3];
        let mut octaves = |axis: [f64; 4]| {
            OCTAVES_HZ
                .iter()
                .zip(axis)
                .filter_map(|(low, rms)| Octave::new(*low, rms, sample_s, &mut random))
                .collect()
        };
        Self {
            bias,
            root_s: sample_s.sqrt(),
            vibration: if shakes { vec![errors.vibration.map(&mut octaves)] } else { Vec::new() },
            window: vec![steady; usize::from(errors.window_ticks)].into(),
            counter: (errors.pulses_per_turn > 0)
                .then(|| PulseCounter::new(errors.pulses_per_turn, steady[0], period_s)),
            last: None,
            late: VecDeque::new(),
            random,
        }
    }

    /// Value measured at a control instant, before noise.
    pub(super) fn measured(&mut self, truth: [f64; 3]) -> [f64; 3] {
        if let Some(counter) = &mut self.counter {
            return [counter.speed(truth[0]), 0.0, 0.0];
        }
        if self.window.pop_front().is_none() {
            return truth;
        }
        self.window.push_back(truth);
        let mut mean = [0.0; 3];
        for past in &self.window {
            mean.iter_mut().zip(past).for_each(|(mean, x)| *mean += x);
        }
        mean.map(|sum| sum / self.window.len() as f64)
    }

    /// A sample with its errors, at a forward speed \[m/s\].
    pub(super) fn disturbed(
        &mut self,
        errors: &FittedErrors,
        mut sample: [f64; 3],
        speed_m_s: f64,
    ) -> [f64; 3] {
        for (axis, sample) in sample.iter_mut().enumerate() {
            if errors.walk[axis] > 0.0 {
                self.bias[axis] += errors.walk[axis] * self.root_s * self.random.normal();
            }
            *sample += self.bias[axis];
            if errors.white[axis] > 0.0 {
                *sample += errors.white[axis] * self.random.normal();
            }
        }
        for axes in &mut self.vibration {
            for (sample, octaves) in sample.iter_mut().zip(axes) {
                *sample += speed_m_s * octaves.iter_mut().map(Octave::next).sum::<f64>();
            }
        }
        sample
    }

    /// The sample, or the previous one repeated.
    pub(super) fn repeated(&mut self, errors: &FittedErrors, sample: [f64; 3]) -> [f64; 3] {
        let again = errors.repeat > 0.0 && self.random.chance(errors.repeat);
        *self.last.insert(self.last.filter(|_| again).unwrap_or(sample))
    }

    /// The newest sample due at `tick`; `arrived` is the sample that arrives without jitter.
    pub(super) fn due(
        &mut self,
        errors: &FittedErrors,
        tick: i64,
        arrived: Option<[f64; 3]>,
    ) -> Option<[f64; 3]> {
        let [most, worst] = errors.jitter_ticks;
        if worst == 0 {
            return arrived;
        }
        if let Some(sample) = arrived {
            let later = if self.random.chance(0.99) {
                self.random.below(usize::from(most) + 1)
            } else {
                usize::from(most) + self.random.below(usize::from(worst - most) + 1)
            };
            let before = self.late.back().map_or(tick, |(due, _)| *due);
            self.late.push_back((before.max(tick + later as i64), sample));
        }
        let mut newest = None;
        while self.late.front().is_some_and(|(due, _)| *due <= tick) {
            newest = self.late.pop_front();
        }
        newest.map(|(_, sample)| sample)
    }
}

/// Vibration in one octave: a sum of sinusoids of random frequency and phase (Shinozuka 1972), without power
/// outside the octave.
#[derive(Debug)]
struct Octave {
    /// Amplitude of each sinusoid per 1 m/s.
    amplitude: f64,
    /// Cosine and sine of each phase, and of its increment per sample.
    turning: Vec<[(f64, f64); 2]>,
}

impl Octave {
    /// From `low_hz` to its double or half the sample rate; none without power, or above half the sample
    /// rate.
    fn new(low_hz: f64, rms: f64, sample_s: f64, random: &mut RandomStream) -> Option<Self> {
        let high_hz = (2.0 * low_hz).min(0.5 / sample_s);
        if rms == 0.0 || high_hz <= low_hz {
            return None;
        }
        let mut sinusoid = |i: usize| {
            let frequency_hz = low_hz + (high_hz - low_hz) * (i as f64 + random.uniform()) / SINUSOIDS as f64;
            let angle = |turns: f64| {
                let (sin, cos) = sin_cos(TAU * turns);
                (cos, sin)
            };
            [angle(random.uniform()), angle(frequency_hz * sample_s)]
        };
        let turning = (0..SINUSOIDS).map(&mut sinusoid).collect();
        Some(Self { amplitude: rms * (2.0 / SINUSOIDS as f64).sqrt(), turning })
    }

    fn next(&mut self) -> f64 {
        let mut sum = 0.0;
        for [phase, step] in &mut self.turning {
            *phase = (phase.0 * step.0 - phase.1 * step.1, phase.1 * step.0 + phase.0 * step.1);
            sum += phase.0;
        }
        self.amplitude * sum
    }
}

/// Pulses of a turning wheel, and the speed that the controller's code computes from them.
#[derive(Debug)]
struct PulseCounter {
    config: WheelPulsesConfig,
    state: WheelPulsesState,
    pulses: WheelPulses,
    period_s: f64,
    /// Speed at the previous control instant \[m/s\].
    speed_m_s: f64,
    /// Distance since the last pulse \[m\].
    distance_m: f64,
    /// Time since the last pulse \[s\]; none before the first.
    age_s: Option<f64>,
}

impl PulseCounter {
    fn new(pulses_per_turn: u16, speed_m_s: f64, period_s: f64) -> Self {
        Self {
            config: WheelPulsesConfig { pulses_per_turn, ..WheelPulsesConfig::default() },
            state: WheelPulsesState::default(),
            pulses: WheelPulses {
                last_edge_age_us: u32::MAX,
                direction: Direction::Unknown,
                ..WheelPulses::default()
            },
            period_s,
            speed_m_s,
            distance_m: 0.0,
            age_s: None,
        }
    }

    /// Speed computed at the end of a control period, where the wheel's speed is `now_m_s` \[m/s\].
    fn speed(&mut self, now_m_s: f64) -> f64 {
        let each_m = TAU * f64::from(self.config.radius_m) / f64::from(self.config.pulses_per_turn);
        let mean_m_s = 0.5 * (self.speed_m_s + now_m_s).abs();
        self.speed_m_s = now_m_s;
        self.distance_m += mean_m_s * self.period_s;
        let before_s = self.age_s.map(|age| age + self.period_s);
        self.age_s = before_s;
        let new = (self.distance_m / each_m).floor();
        if new >= 1.0 {
            self.distance_m -= new * each_m;
            let age_s = self.distance_m / mean_m_s;
            // With several pulses in one period, the last two are evenly spaced.
            let apart_s =
                if new > 1.0 { Some(each_m / mean_m_s) } else { before_s.map(|before| before - age_s) };
            self.pulses.count = self.pulses.count.wrapping_add(new as u16);
            self.pulses.last_period_us = apart_s.map_or(0, |s| (1e6 * s) as u32);
            self.age_s = Some(age_s);
        }
        self.pulses.last_edge_age_us = self.age_s.map_or(u32::MAX, |s| (1e6 * s) as u32);
        let elapsed_us = (1e6 * self.period_s).round() as u32;
        f64::from(wheel_speed::step(&self.config, &mut self.state, &self.pulses, elapsed_us).speed_m_s)
    }
}
