//! The composition: one sensor frame in, one torque command out.

use crate::calibrate::{Calibration, CalibrationPlan};
use crate::fault::{Cause, Causes};
use crate::frame::{SensorFrame, Wheel};
use crate::history::{Aligned, History, Latency};
use crate::input::{self, Believed, Bounds, InputConfig, InputState};
use crate::law::Law;
use crate::limits::{ActiveLimits, Limits, Taper};
use crate::param::{Checker, Leaf, ParamError, Visit};
use crate::permit::{self, Asked, Mode, PermitConfig, PermitState, Reactions};
use crate::shape::{self, ShapePlan, ShapeState};
use crate::watch::{Loss, Sensor};

/// Everything a user may choose. Plain data; [`Config::plan`] checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How often [`step`] is called \[Hz\], 100..=10000.
    pub rate_hz: f32,
    /// The roll-rate law.
    pub law: Law,
    /// How sensors and motor sit on this bicycle.
    pub calibration: Calibration,
    /// The declared sensors.
    pub input: InputConfig,
    /// When torque may flow.
    pub permit: PermitConfig,
    /// How late each sensor is known to be.
    pub latency: Latency,
    /// Limits on the torque.
    pub shape: Limits,
}

impl Config {
    /// The conditions of the published basins: the law alone, every limit and check off, permission
    /// for the asking.
    pub fn thesis(law: Law) -> Self {
        Self {
            rate_hz: 1000.0,
            law,
            calibration: Calibration::default(),
            input: InputConfig::default(),
            permit: PermitConfig::default(),
            latency: Latency::default(),
            shape: Limits::default(),
        }
    }

    /// What is flashed: `h` cut to zero above 7.5 m/s, 7 N m (the largest torque of the published
    /// balance-assist prototype), 100 N m/s (above the 91 N m/s that border rides of unlimited `h`
    /// reach), nothing below 0.5 m/s and all of it from 1.5 m/s, samples up to 10 ms (gyro) and
    /// 250 ms (wheel pulses) old. It refuses to engage until a polarity check was passed.
    pub fn product() -> Self {
        let gyro =
            Sensor { timeout_ticks: 10, qualify_samples: 100, loss: Loss::Fault, ..Sensor::exact(60.0) };
        let wheel =
            Sensor { timeout_ticks: 250, qualify_samples: 3, loss: Loss::Fault, ..Sensor::exact(30.0) };
        let input = InputConfig { gyro, front_wheel: wheel, ..InputConfig::default() };
        let permit = PermitConfig {
            self_test_ticks: 200,
            ramp_in_ticks: 500,
            ramp_out_ticks: 200,
            need_polarity: true,
            ..PermitConfig::default()
        };
        let shape = Limits {
            max_torque_nm: Some(7.0),
            rise_nm_s: Some(100.0),
            fall_nm_s: Some(100.0),
            taper: Some(Taper { zero_m_s: 0.5, full_m_s: 1.5 }),
            ..Limits::default()
        };
        Self { input, permit, shape, ..Self::thesis(Law::H { cut: true }) }
    }

    /// Shows every parameter but the law's.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        to.number(&Leaf::new("", "rate_hz", 100.0, 10_000.0), &mut self.rate_hz);
        self.calibration.leaves(to);
        self.input.leaves(to);
        self.permit.leaves(to);
        self.latency.leaves(to);
        self.shape.leaves(to);
    }

    /// Checks every value and readies what [`step`] needs.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn plan(mut self) -> Result<Plan, ParamError> {
        let mut checker = Checker::default();
        self.leaves(&mut checker);
        checker.note(self.law.validate());
        checker.note(self.shape.validate());
        checker.verdict()?;
        Ok(Plan {
            period_s: 1.0 / self.rate_hz,
            shape: ShapePlan::new(&self.shape, self.rate_hz),
            period_us: (1e6 / self.rate_hz) as u32,
            calibration: self.calibration.plan(),
            reactions: Reactions::new(&self.input),
            config: self,
        })
    }
}

/// A checked [`Config`] with what is derived from it. Read-only while the controller runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    config: Config,
    period_s: f32,
    shape: ShapePlan,
    period_us: u32,
    calibration: CalibrationPlan,
    reactions: Reactions,
}

impl Plan {
    /// The configuration it was made from.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Control periods from boot to full authority, if every sensor is good from the start and the
    /// switch is pressed at once when it may be.
    pub fn ticks_to_engage(&self) -> u32 {
        let Config { input, permit, .. } = &self.config;
        let slowest = input.slowest_to_qualify();
        8 + slowest
            + u32::from(permit.self_test_ticks)
            + u32::from(permit.ramp_in_ticks)
            + u32::from(self.config.latency.roll_rate_ticks.max(self.config.latency.speed_ticks))
    }
}

/// What the controller remembers between steps. `State::default()` is a controller just started.
#[derive(Clone, Debug, Default)]
pub struct State {
    input: InputState,
    permit: PermitState,
    history: History,
    shape: ShapeState,
}

impl State {
    /// The torque commanded last, in the bicycle's sign \[N m\].
    pub fn torque_nm(&self) -> f32 {
        self.shape.torque_nm()
    }

    /// The part of the torque that is permitted, 0 to 1.
    pub fn authority(&self) -> f32 {
        self.permit.authority()
    }
}

/// What the motor is asked for, and how that came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Steer torque, positive to the right as the motor counts \[N m\]. Always finite.
    pub torque_nm: f32,
    /// The gain used \[N m s/rad\]; 0 while there is nothing to use it on.
    pub gain_nm_s_rad: f32,
    /// The limits that changed the torque.
    pub limits: ActiveLimits,
    /// Where the controller stands.
    pub mode: Mode,
    /// Everything that stands in the way of the torque, or is worth knowing.
    pub causes: Causes,
}

/// One control period: the torque for the motor from the sensors of this instant.
///
/// Without a believable roll rate or speed zero torque is wanted, reached as fast as the rate limit
/// lets it.
pub fn step(plan: &Plan, state: &mut State, frame: &SensorFrame) -> Command {
    let config = &plan.config;
    let frame = plan.calibration.frame(frame);
    let last = state.torque_nm();
    let believed = input::step(&config.input, plan.period_s, &mut state.input, &frame, last);
    let speed = speed(&config.input, &believed);
    let mut causes = believed.causes;

    let now = match (believed.gyro_rad_s, speed) {
        (Some([roll_rate_rad_s, ..]), Some(speed)) => {
            let now = state.history.align(&config.latency, Aligned { roll_rate_rad_s, speed });
            causes.note(Cause::Filling, now.is_none());
            now
        }
        _ => {
            state.history.clear();
            None
        }
    };
    let asked = Asked {
        causes,
        engage: frame.engage,
        polarity_checked: config.calibration.polarity_checked,
        roll_rad: None,
        speed_m_s: speed.map(|v| v.newest),
        force_m_s2: believed.accel_m_s2.map(size),
    };
    let permission = permit::step(&config.permit, &plan.reactions, &mut state.permit, &asked);

    let (gain, wanted, slowest) = match now {
        Some(now) if permission.authority > 0.0 => {
            let gain = config.law.gain(now.speed.newest);
            (gain, gain * now.roll_rate_rad_s, now.speed.low)
        }
        _ => (0.0, 0.0, 0.0),
    };
    let asked = shape::Asked {
        wanted_nm: wanted,
        authority: permission.authority,
        limp: permission.mode == Mode::Limp,
        speed_low_m_s: slowest,
        speed_high_m_s: slowest,
        steer_rad: None,
        steer_rate_rad_s: None,
        rider_torque_nm: None,
        elapsed_us: plan.period_us,
    };
    let (torque_nm, limits) = shape::step(&config.shape, &plan.shape, &mut state.shape, &asked);
    Command {
        torque_nm: plan.calibration.motor(torque_nm),
        gain_nm_s_rad: gain,
        limits,
        mode: permission.mode,
        causes: permission.causes,
    }
}

/// The speed that schedules the gain: the chosen wheel's, or the other's while the chosen one is lost.
fn speed(config: &InputConfig, believed: &Believed) -> Option<Bounds> {
    let (front, rear) = (believed.front_wheel_m_s, believed.rear_wheel_m_s);
    match config.wheel {
        Wheel::Front => front.or(rear),
        Wheel::Rear => rear.or(front),
    }
}

fn size([x, y, z]: [f32; 3]) -> f32 {
    libm::sqrtf(x * x + y * y + z * z)
}
