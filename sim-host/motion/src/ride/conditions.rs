//! Conditions of a ride: bicycle, assist, rider, plant, fall criterion and time step.

use super::{Assist, FallCriterion};
use crate::bicycle::Geometry;
use crate::plant::{Imu, Plant, PlantError};
use crate::range::{RangeError, within, within_key};
use crate::rider::{Rider, UnfitError};

/// Speed that schedules the gains of assist and rider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum ScheduleSpeed {
    /// Front wheel rate times its radius; reproduces the published basins.
    Front,
    /// Rear wheel rate times its radius.
    Rear,
    /// The speed at t = 0, constant.
    Initial,
}

/// Conditions common to all rides of a study.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// The bicycle.
    pub bicycle: Geometry,
    /// The steer assist.
    pub assist: Assist,
    /// The rider model, in parallel with the assist.
    pub rider: Option<Rider>,
    /// Speed that schedules the gains.
    pub schedule_speed: ScheduleSpeed,
    /// Signal of the rate gyro.
    pub imu: Imu,
    /// Delay of the simulated sensors, in addition to that in `plant` \[control periods\].
    pub sensor_delay_ticks: u16,
    /// Errors of sensors and motor, and the steer's friction and end-stop. Except for these two it acts on
    /// [`Assist::Firmware`] only.
    pub plant: Plant,
    /// When a ride counts as fallen.
    pub fall: FallCriterion,
    /// Duration of a ride that does not fall \[s\].
    pub time_limit_s: f64,
    /// Control period and time step of the integration \[s\].
    pub step_s: f64,
    /// A ride has recovered if it did not fall and, in its last second, roll and steer stay below this
    /// fraction of their maxima.
    pub recovered_below: f64,
}

/// Conditions that can't be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConditionsError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The rider can't be simulated.
    #[error(transparent)]
    Rider(#[from] UnfitError),
    /// The plant can't be simulated.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// The plant of an ideal law is not exact.
    #[error(
        "the ideal law has exact sensors and an exact motor: of the plant only friction and end-stop act on it"
    )]
    IdealLaw,
}

impl ConditionsError {
    /// The number outside its range, if there is one.
    pub fn range(&self) -> Option<&RangeError> {
        match self {
            Self::Range(error) | Self::Plant(PlantError::Range(error)) => Some(error),
            _ => None,
        }
    }
}

/// Largest delay of a simulated sensor \[control periods\].
pub(super) const MAX_SENSOR_DELAY_TICKS: u16 = 1000;

impl Conditions {
    /// The published conditions: 6 s, 1 kHz, exact sensors without delay, gain scheduled by front wheel
    /// speed.
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

    /// Largest number of substeps of a ride before it counts as fallen. In right-hand sides, a ride of 6 s
    /// costs at most as much as eleven ordinary ones. Falls that pass directly through 90 degrees take up
    /// to 1,000.
    pub(super) fn most_substeps(&self) -> u32 {
        10_000 + 7 * self.steps()
    }

    /// Checks what the types do not guarantee.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), ConditionsError> {
        within_key("time_limit_s", "time limit (s)", self.time_limit_s, self.step_s, 3600.0)?;
        within("step (s)", self.step_s, 1e-5, 1e-2)?;
        within_key("recovered_below", "recovered-below fraction", self.recovered_below, 1e-6, 1.0)?;
        self.fall.check()?;
        self.rider.as_ref().map_or(Ok(()), |rider| rider.check(self.step_s))?;
        self.plant.check()?;
        if matches!(self.assist, Assist::Ideal(_) | Assist::Own(_)) && !self.plant.exact() {
            return Err(ConditionsError::IdealLaw);
        }
        let delay_ticks = f64::from(self.sensor_delay_ticks);
        within("sensor delay in control periods", delay_ticks, 0.0, f64::from(MAX_SENSOR_DELAY_TICKS))?;
        Ok(())
    }
}
