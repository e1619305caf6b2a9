//! The model of an FMU from a scenario.

use crate::bicycle::ForcePoint;
use crate::commands::Setup;
use crate::ride::{Assist, Conditions, ScheduleSpeed, Start};
use crate::scenario::Scenario;
use control::wire::encode_config;
use fmi::Setup as Model;
use std::fmt::Write;

/// What an FMU is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Part {
    /// The flashed control step: sensors in, torque, mode, limits and causes out.
    Controller,
    /// The nonlinear bicycle: torques in, motion and exact sensors out.
    Bicycle,
    /// The rider: motion in, torque out after the neural delay.
    Rider,
}

impl Part {
    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Controller => "controller",
            Self::Bicycle => "bicycle",
            Self::Rider => "rider",
        }
    }

    /// The options that describe it, by their names; others can have an effect by chance only, such as a rider's delay on the
    /// time step.
    pub const fn options(self) -> &'static [&'static str] {
        match self {
            Self::Controller => &[
                "bicycle",
                "bicycle-set",
                "law",
                "preset",
                "assist",
                "schedule-speed",
                "torque-limit",
                "rate-limit",
                "taper",
                "parameters",
                "set",
                "speed",
            ],
            Self::Bicycle => &[
                "bicycle",
                "bicycle-set",
                "sensor",
                "actuator",
                "imu",
                "fall",
                "time-limit",
                "speed",
                "steer-rate",
                "roll-rate",
            ],
            Self::Rider => &["rider", "gains", "delay", "gains-outside", "schedule-speed"],
        }
    }
}

/// A scenario that has no such FMU.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// No control crate in the scenario.
    #[error("the scenario has no controller: --law must be a law, and --assist firmware")]
    NoController,
    /// No rider in the scenario.
    #[error("the scenario has no rider: --rider NAME (`sim-host rider list`)")]
    NoRider,
    /// Errors of sensors or motor.
    #[error(
        "an FMU has exact sensors and an exact motor: of the plant only friction and end-stop are part of it; leave out delays, \
         sensor models, motor models and faults, or model them between the FMUs"
    )]
    Plant,
    /// The speed at the start as schedule.
    #[error("an FMU has the speed of a wheel: --schedule-speed front or rear, not initial")]
    InitialSpeed,
}

/// Forward speed at the start of an FMU whose scenario has none \[m/s\].
const SPEED_M_S: f64 = 4.0;

/// The scenario, with a speed where its start has none.
pub fn with_speed(mut scenario: Scenario) -> Scenario {
    let typed = scenario.options.contains("start.speed_m_s");
    if let Some(start) = scenario.start.as_mut().filter(|start| start.speed_m_s.is_nan() && !typed) {
        start.speed_m_s = SPEED_M_S;
    }
    scenario
}

/// The model of `part`, at the start of the scenario or at 4 m/s.
///
/// # Errors
/// The scenario has no such part, or one that an FMU does not have.
pub fn model(part: Part, setup: &Setup) -> Result<Model, PartError> {
    let Setup { conditions, parameters, scenario, .. } = setup;
    let Conditions { assist, rider, schedule_speed, plant, .. } = conditions;
    if !plant.exact() || conditions.sensor_delay_ticks > 0 {
        return Err(PartError::Plant);
    }
    if *schedule_speed == ScheduleSpeed::Initial {
        return Err(PartError::InitialSpeed);
    }
    let start = scenario.start.unwrap_or(Start { speed_m_s: SPEED_M_S, ..Start::default() });
    Ok(match part {
        Part::Controller => {
            let Assist::Firmware(plan) = assist else { return Err(PartError::NoController) };
            let mut configuration = String::new();
            for byte in encode_config(plan.config()) {
                let _ = write!(configuration, "{byte:02x}");
            }
            Model::Controller { configuration, speed_m_s: start.speed_m_s, g_m_s2: parameters.g }
        }
        Part::Bicycle => Model::Bicycle {
            parameters: *parameters,
            start,
            force_point: ForcePoint::SADDLE,
            imu: conditions.imu,
            imu_point_m: plant.sensors.imu.point_m,
            friction: plant.actuator.friction,
            stop: plant.actuator.stop,
            time_limit_s: conditions.time_limit_s,
            fall: conditions.fall,
            step_s: conditions.step_s,
        },
        Part::Rider => {
            let rider = rider.as_ref().ok_or(PartError::NoRider)?;
            Model::Rider {
                gains: rider.schedule.points().to_vec(),
                outside: rider.schedule.outside(),
                schedule_speed: *schedule_speed,
                delay_s: rider.delay_s,
                neuromuscular: rider.neuromuscular,
                step_s: conditions.step_s,
            }
        }
    })
}
