//! The composition: one sensor frame in, one torque command out.

use crate::frame::SensorFrame;
use crate::history::{History, Latency};
use crate::input::{InputConfig, Reject};
use crate::law::Law;
use crate::limits::{ActiveLimits, Limits, Taper};
use crate::param::{ParamError, check};
use crate::shape::{self, Asked, ShapePlan, ShapeState};

/// Everything a user may choose. Plain data; [`Config::plan`] checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How often [`step`] is called \[Hz\], 100..=10000.
    pub rate_hz: f32,
    /// The roll-rate law.
    pub law: Law,
    /// What inputs must fulfil.
    pub input: InputConfig,
    /// How late each sensor is known to be.
    pub latency: Latency,
    /// Limits on the torque.
    pub shape: Limits,
}

impl Config {
    /// The conditions of the published basins: the law alone, every limit off.
    pub fn thesis(law: Law) -> Self {
        Self {
            rate_hz: 1000.0,
            law,
            input: InputConfig::default(),
            latency: Latency::default(),
            shape: Limits::default(),
        }
    }

    /// What is flashed: `h` cut to zero above 7.5 m/s, 7 N m (the largest torque of the published
    /// balance-assist prototype), 100 N m/s (above the 91 N m/s that border rides of unlimited `h`
    /// reach), nothing below 0.5 m/s and all of it from 1.5 m/s, samples up to 10 ms (gyro) and
    /// 250 ms (wheel pulses) old.
    pub fn product() -> Self {
        let input =
            InputConfig { roll_rate_max_age_ticks: 10, speed_max_age_ticks: 250, ..InputConfig::default() };
        let shape = Limits {
            max_torque_nm: Some(7.0),
            rise_nm_s: Some(100.0),
            fall_nm_s: Some(100.0),
            taper: Some(Taper { zero_m_s: 0.5, full_m_s: 1.5 }),
            ..Limits::default()
        };
        Self { input, shape, ..Self::thesis(Law::H { cut: true }) }
    }

    /// Checks every value and readies what [`step`] needs.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn plan(self) -> Result<Plan, ParamError> {
        check("rate_hz", self.rate_hz, 100.0, 10_000.0)?;
        self.law.validate()?;
        self.input.validate()?;
        self.latency.validate()?;
        self.shape.validate()?;
        let shape = ShapePlan::new(&self.shape, self.rate_hz);
        let period_us = (1e6 / self.rate_hz) as u32;
        Ok(Plan { config: self, shape, period_us })
    }
}

/// A checked [`Config`] with what is derived from it. Read-only while the controller runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    config: Config,
    shape: ShapePlan,
    period_us: u32,
}

impl Plan {
    /// The configuration it was made from.
    pub fn config(&self) -> &Config {
        &self.config
    }
}

/// What the controller remembers between steps. `State::default()` is a controller just started.
#[derive(Clone, Debug, Default)]
pub struct State {
    history: History,
    shape: ShapeState,
}

impl State {
    /// The torque commanded last \[N m\].
    pub fn torque_nm(&self) -> f32 {
        self.shape.torque_nm()
    }
}

/// How the torque came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// By the law, from this frame.
    Active,
    /// Wanted zero: the sensors' histories do not yet overlap.
    Filling,
    /// Wanted zero: the frame was refused.
    Rejected(Reject),
}

/// What the motor is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Steer torque, positive to the right \[N m\]. Always finite.
    pub torque_nm: f32,
    /// The gain used \[N m s/rad\]; 0 unless [`Status::Active`].
    pub gain_nm_s_rad: f32,
    /// The limits that changed the torque.
    pub limits: ActiveLimits,
    /// How the torque came about.
    pub status: Status,
}

/// One control period: the torque for the motor from the sensors of this instant.
///
/// A frame that cannot be believed asks for zero torque, reached as fast as the rate limit lets it.
pub fn step(plan: &Plan, state: &mut State, frame: &SensorFrame) -> Command {
    let config = &plan.config;
    let (status, gain, wanted, speed) = match config.input.believe(frame) {
        Err(reason) => {
            state.history.clear();
            (Status::Rejected(reason), 0.0, 0.0, 0.0)
        }
        Ok(newest) => match state.history.align(&config.latency, newest) {
            None => (Status::Filling, 0.0, 0.0, 0.0),
            Some(now) => {
                let gain = config.law.gain(now.speed_m_s);
                (Status::Active, gain, gain * now.roll_rate_rad_s, now.speed_m_s)
            }
        },
    };
    let asked = Asked {
        wanted_nm: wanted,
        authority: 1.0,
        limp: false,
        speed_low_m_s: speed,
        speed_high_m_s: speed,
        steer_rad: None,
        steer_rate_rad_s: None,
        rider_torque_nm: None,
        elapsed_us: plan.period_us,
    };
    let (torque_nm, limits) = shape::step(&config.shape, &plan.shape, &mut state.shape, &asked);
    Command { torque_nm, gain_nm_s_rad: gain, limits, status }
}
