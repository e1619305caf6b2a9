//! Everything a ride depends on.

use super::{Assist, FallCriterion};
use crate::bicycle::Geometry;
use crate::plant::Plant;
use crate::range::within;
use crate::rider::Rider;

/// The speed that schedules the gains of assist and rider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum ScheduleSpeed {
    /// Front wheel rate times its radius: what reproduces the published basins.
    Front,
    /// Rear wheel rate times its radius.
    Rear,
    /// The speed at the start, for ever.
    Initial,
}

/// What the rate gyro reports as roll rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Imu {
    /// The exact rate of the roll angle (the published laws' signal).
    Euler,
    /// The rear frame's angular velocity about its own x axis, as a gyro on it measures.
    Body,
}

/// The conditions all rides of a study share.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// The bicycle.
    pub bicycle: Geometry,
    /// What turns the steer.
    pub assist: Assist,
    /// Who rides: human control in parallel with the assist.
    pub rider: Option<Rider>,
    /// Which speed schedules the gains.
    pub schedule_speed: ScheduleSpeed,
    /// What the gyro reports.
    pub imu: Imu,
    /// How late the simulated sensors are, beside what `plant` says \[control periods\].
    pub sensor_delay_ticks: u16,
    /// How sensors and motor depart from exact ones, the steer's friction and its end-stop. All of it but
    /// these two acts on [`Assist::Firmware`] only.
    pub plant: Plant,
    /// When a ride counts as fallen.
    pub fall: FallCriterion,
    /// How long a ride lasts if it does not fall \[s\].
    pub time_limit_s: f64,
    /// The control period, and the integration step \[s\].
    pub step_s: f64,
    /// A ride that did not fall has recovered when roll and steer, in its last second, stay below
    /// this fraction of their largest values.
    pub recovered_below: f64,
}

/// Conditions that can't be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct ConditionsError(pub String);

/// Most control periods a simulated sensor can be late.
pub(super) const MAX_SENSOR_DELAY_TICKS: u16 = 1000;

impl Conditions {
    /// The published conditions: 6 s, 1 kHz, exact sensors without delay, gain by front wheel speed.
    pub fn thesis(bicycle: Geometry, assist: Assist) -> Self {
        Self {
            bicycle,
            assist,
            rider: None,
            schedule_speed: ScheduleSpeed::Front,
            imu: Imu::Euler,
            sensor_delay_ticks: 0,
            plant: Plant::default(),
            fall: FallCriterion::default(),
            time_limit_s: 6.0,
            step_s: 1e-3,
            recovered_below: 0.1,
        }
    }

    /// The number of steps in the time limit.
    pub fn steps(&self) -> u32 {
        (self.time_limit_s / self.step_s).round() as u32
    }

    /// Most shorter steps of a ride, before it counts as fallen: in right-hand sides, one of 6 s costs at most eleven
    /// ordinary ones. Falls that go through 90 degrees at once take up to 1,000.
    pub(super) fn most_pieces(&self) -> u32 {
        10_000 + 7 * self.steps()
    }

    /// Checks what the types do not.
    ///
    /// # Errors
    /// Names the value and its range.
    pub fn check(&self) -> Result<(), ConditionsError> {
        let within = |name, value, min, max| within(name, value, min, max).map_err(ConditionsError);
        within("time limit (s)", self.time_limit_s, self.step_s, 3600.0)?;
        within("step (s)", self.step_s, 1e-5, 1e-2)?;
        within("recovered-below fraction", self.recovered_below, 1e-6, 1.0)?;
        self.fall.check().map_err(ConditionsError)?;
        if let Some(rider) = &self.rider {
            rider.check(self.step_s).map_err(|e| ConditionsError(e.0))?;
        }
        self.plant.check().map_err(|e| ConditionsError(e.0))?;
        if matches!(self.assist, Assist::Ideal(_)) && !self.plant.exact() {
            let error = "the ideal law has exact sensors and an exact motor: of the plant only friction and end-stop act on it";
            return Err(ConditionsError(error.into()));
        }
        within(
            "sensor delay in control periods",
            f64::from(self.sensor_delay_ticks),
            0.0,
            f64::from(MAX_SENSOR_DELAY_TICKS),
        )
    }
}

/// The initial state of one ride: upright, straight, on the path of steady riding but for the
/// disturbance, an instantaneous change of rates.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Start {
    /// Forward speed of the rear wheel \[m/s\].
    pub speed_m_s: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate_rad_s: f64,
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f64,
}
