//! Sensor errors: sampling, scale, bias, noise, range, quantisation, loss and delay.

use super::fitted::{FittedErrors, FittedState};
use super::{PlantError, Sensor};
use crate::num::RandomStream;
use crate::num::sin_cos;
use crate::range::within;
use std::collections::VecDeque;

/// Largest delay and sampling interval \[control periods\].
const MAX_TICKS: u16 = 5000;

/// Errors of one sensor, in the order in which they act. The default is exact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct SensorModel {
    /// Sampling interval \[control periods\]; the last sample is held in between.
    pub every_ticks: u16,
    /// Scale factor: measured over true value.
    pub scale: f64,
    /// Added to each axis, in the sensor's unit.
    pub bias: [f64; 3],
    /// Standard deviation of white Gaussian noise on every sample, in the sensor's unit.
    pub noise: f64,
    /// Largest magnitude that the sensor reports, in its unit; null is no limit.
    pub range: Option<f64>,
    /// Quantisation step, in the sensor's unit; 0 is none.
    pub quantum: f64,
    /// Probability that a sample is lost.
    pub dropout: f64,
    /// Control periods from the measurement to its arrival.
    pub delay_ticks: u16,
    /// Errors fitted to recordings of a real sensor.
    pub fitted: FittedErrors,
}

impl Default for SensorModel {
    fn default() -> Self {
        Self {
            every_ticks: 1,
            scale: 1.0,
            bias: [0.0; 3],
            noise: 0.0,
            range: None,
            quantum: 0.0,
            dropout: 0.0,
            delay_ticks: 0,
            fitted: FittedErrors::default(),
        }
    }
}

impl SensorModel {
    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self, sensor: Sensor) -> Result<(), PlantError> {
        let name = sensor.name();
        let within = |key: &str, value, min, max| within(&format!("{name} {key}"), value, min, max);
        within("every (control periods)", f64::from(self.every_ticks), 1.0, f64::from(MAX_TICKS))?;
        within("scale", self.scale, -10.0, 10.0)?;
        self.bias.iter().try_for_each(|bias| within("bias", *bias, -1e3, 1e3))?;
        within("noise", self.noise, 0.0, 1e3)?;
        self.range.map_or(Ok(()), |range| within("range", range, 1e-6, 1e6))?;
        within("quantum", self.quantum, 0.0, 1e3)?;
        within("dropout", self.dropout, 0.0, 1.0)?;
        within("delay (control periods)", f64::from(self.delay_ticks), 0.0, f64::from(MAX_TICKS))?;
        self.fitted.check(sensor, self.every_ticks)
    }

    /// Whether `tick` is a sampling instant.
    fn samples_at(&self, tick: i64) -> bool {
        self.every_ticks == 1
            || (tick - i64::from(self.fitted.phase_ticks)).rem_euclid(i64::from(self.every_ticks)) == 0
    }

    /// Whether samples are the true values.
    fn is_true(&self) -> bool {
        *self == Self { delay_ticks: self.delay_ticks, every_ticks: self.every_ticks, ..Self::default() }
    }

    /// Age of the newest sample at the control instant before the first, without losses \[control periods\].
    pub(super) fn age_before_boot(&self) -> u16 {
        let latest = -1 - i64::from(self.delay_ticks) - i64::from(self.fitted.phase_ticks);
        latest.rem_euclid(i64::from(self.every_ticks)) as u16
    }

    /// The sample of `truth` at a forward speed \[m/s\]; none if it is lost.
    fn sample(
        &self,
        truth: [f64; 3],
        speed_m_s: f64,
        random: Option<&mut RandomStream>,
        fitted: Option<&mut FittedState>,
    ) -> Option<[f64; 3]> {
        let mut output = truth;
        for (output, bias) in output.iter_mut().zip(self.bias) {
            *output = *output * self.scale + bias;
        }
        if let Some(random) = random {
            if self.noise > 0.0 {
                output.iter_mut().for_each(|x| *x += self.noise * random.normal());
            }
            if random.chance(self.dropout) {
                return None;
            }
        }
        if let Some(state) = fitted {
            output = state.disturbed(&self.fitted, output, speed_m_s);
            output = state.repeated(&self.fitted, output);
        }
        for (x, own) in output.iter_mut().zip(self.fitted.quantum) {
            if let Some(range) = self.range {
                *x = x.clamp(-range, range);
            }
            for quantum in [self.quantum, own] {
                if quantum > 0.0 {
                    *x = (*x / quantum).round() * quantum;
                }
            }
        }
        Some(output)
    }
}

/// Position and orientation of the IMU (gyro and accelerometer) on the rear frame.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ImuMount {
    /// Position from the rear wheel's centre: forward, right, down \[m\].
    pub point_m: [f64; 3],
    /// Orientation in the frame: rotated about z (down), then its y, then its x by these angles about x, y
    /// and z \[rad\].
    pub turned_rad: [f64; 3],
}

impl Default for ImuMount {
    /// On the down tube, axes aligned with the frame.
    fn default() -> Self {
        Self { point_m: [0.5, 0.0, -0.2], turned_rad: [0.0; 3] }
    }
}

impl ImuMount {
    /// Checks every value.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), PlantError> {
        let point = self.point_m.iter().try_for_each(|x| within("imu point (m)", *x, -3.0, 3.0));
        let turned = |()| {
            let half_turn = std::f64::consts::PI;
            self.turned_rad.iter().try_for_each(|x| within("imu turned (rad)", *x, -half_turn, half_turn))
        };
        Ok(point.and_then(turned)?)
    }

    /// Components of a frame vector in the IMU's axes.
    pub fn rotated(&self, vector: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = vector;
        let [(s1, c1), (s2, c2), (s3, c3)] = self.turned_rad.map(sin_cos);
        let (x, y) = (x * c3 + y * s3, y * c3 - x * s3);
        let (x, z) = (x * c2 - z * s2, z * c2 + x * s2);
        let (y, z) = (y * c1 + z * s1, z * c1 - y * s1);
        [x, y, z]
    }
}

/// Errors of all sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorConfig {
    models: [SensorModel; Sensor::ALL.len()],
    /// Position and orientation of the IMU.
    pub imu: ImuMount,
}

impl SensorConfig {
    /// The model of a sensor.
    pub fn model(&self, sensor: Sensor) -> &SensorModel {
        &self.models[sensor as usize]
    }

    /// The model of a sensor, mutable.
    pub fn model_mut(&mut self, sensor: Sensor) -> &mut SensorModel {
        &mut self.models[sensor as usize]
    }

    /// Whether all sensors are exact and without delay; the IMU's mounting does not count.
    pub fn exact(&self) -> bool {
        self.imu.turned_rad == [0.0; 3] && self.models.iter().all(|model| *model == SensorModel::default())
    }

    /// Whether a mirrored motion gives mirrored samples.
    pub fn mirrors(&self) -> bool {
        let odd =
            |m: &SensorModel| m.bias == [0.0; 3] && m.noise == 0.0 && m.dropout == 0.0 && !m.fitted.draws();
        self.imu.turned_rad == [0.0; 3] && self.imu.point_m[1] == 0.0 && self.models.iter().all(odd)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// States the sensor, the value and its range.
    pub fn check(&self) -> Result<(), PlantError> {
        self.imu.check()?;
        Sensor::ALL.into_iter().try_for_each(|sensor| self.model(sensor).check(sensor))
    }
}

/// State of one sensor in one ride, with its delayed samples.
#[derive(Debug)]
pub struct SensorState {
    /// Delayed samples, oldest first; `None` where none was taken or it was lost.
    on_their_way: VecDeque<Option<[f64; 3]>>,
    /// Whether samples are the true values.
    exact: bool,
    /// For models with noise or losses only.
    random: Option<RandomStream>,
    /// For models with fitted errors only.
    fitted: Option<Box<FittedState>>,
}

/// Random numbers of a sensor: for data-sheet noise and for fitted errors.
#[derive(Debug)]
pub struct SensorRng {
    /// For noise and dropout.
    pub plain: RandomStream,
    /// For [`FittedErrors`].
    pub fitted: RandomStream,
}

/// True values before the control instant 0.
#[derive(Clone, Copy, Debug)]
pub struct Before {
    /// True value.
    pub truth: [f64; 3],
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// The control period \[s\].
    pub period_s: f64,
}

impl SensorState {
    /// A copy; `None` if anything is random.
    pub fn copied(&self) -> Option<Self> {
        let on_their_way = self.on_their_way.clone();
        let fixed = self.random.is_none() && self.fitted.is_none();
        fixed.then_some(Self { on_their_way, exact: self.exact, random: None, fitted: None })
    }

    /// State before the control instant 0.
    pub fn new(model: &SensorModel, before: &Before, random: SensorRng) -> Self {
        let Before { truth, speed_m_s, period_s } = *before;
        let sample_s = f64::from(model.every_ticks) * period_s;
        let fitted = (model.fitted != FittedErrors::default())
            .then(|| Box::new(FittedState::new(&model.fitted, truth, sample_s, period_s, random.fitted)));
        let random = (model.noise > 0.0 || model.dropout > 0.0).then_some(random.plain);
        let mut state = Self { on_their_way: VecDeque::new(), exact: model.is_true(), random, fitted };
        let before = -i64::from(model.delay_ticks)..0;
        state.on_their_way = before.map(|at| state.taken(model, at, truth, speed_m_s)).collect();
        state
    }

    /// Accepts true value and forward speed \[m/s\] at `tick`, called for consecutive ticks; returns the
    /// sample that arrives now.
    pub fn arriving(
        &mut self,
        model: &SensorModel,
        tick: i64,
        truth: [f64; 3],
        speed_m_s: f64,
    ) -> Option<[f64; 3]> {
        let new = self.taken(model, tick, truth, speed_m_s);
        let arrived = match self.on_their_way.pop_front() {
            // Without delay the queue stays empty.
            None => new,
            Some(arrived) => {
                self.on_their_way.push_back(new);
                arrived
            }
        };
        match &mut self.fitted {
            Some(state) => state.due(&model.fitted, tick, arrived),
            None => arrived,
        }
    }

    /// The sample taken at `tick`, if any.
    fn taken(&mut self, model: &SensorModel, tick: i64, truth: [f64; 3], speed_m_s: f64) -> Option<[f64; 3]> {
        if self.exact {
            return model.samples_at(tick).then_some(truth);
        }
        let truth = self.fitted.as_mut().map_or(truth, |state| state.measured(truth));
        let (random, fitted) = (self.random.as_mut(), self.fitted.as_deref_mut());
        model.samples_at(tick).then(|| model.sample(truth, speed_m_s, random, fitted)).flatten()
    }
}
