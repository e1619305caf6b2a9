//! One ride after a disturbance.

use super::{CommandError, Setup};
use crate::report::document::RideDocument;
use crate::ride::{Assist, Conditions, Ride, Start, TracePoint, traced, traced_until};
use crate::scenario::speeds::FASTEST_M_S;
use crate::scenario::{Scenario, ScenarioError, SpeedsError};

/// A ride with its record.
#[derive(Clone, Debug)]
pub struct Ridden {
    /// The ride.
    pub ride: Ride,
    /// One point per control period.
    pub trace: Vec<TracePoint>,
}

/// The initial state of a scenario.
///
/// # Errors
/// The scenario has none.
pub fn start(scenario: &Scenario) -> Result<Start, ScenarioError> {
    scenario.start.ok_or_else(|| {
        ScenarioError::value("start.speed_m_s", SpeedsError::Missing { least_m_s: -FASTEST_M_S })
    })
}

/// Rejects a backward ride with assist or rider, which are defined for forward riding only.
///
/// # Errors
/// Assist or rider at a negative speed.
pub fn check_direction(start: Start, conditions: &Conditions) -> Result<(), ScenarioError> {
    let alone = matches!(conditions.assist, Assist::None) && conditions.rider.is_none();
    if start.speed_m_s < 0.0 && !alone {
        let reason = format!(
            "{} m/s is outside 0 to 30; laws and riders are those of riding forward, below 0 goes only law none \
             without a rider",
            start.speed_m_s
        );
        return Err(ScenarioError::value("start.speed_m_s", reason));
    }
    Ok(())
}

/// Simulates the ride of a scenario.
///
/// # Errors
/// The scenario has no start, or one of riding backwards with an assist or a rider.
pub fn ride(setup: &Setup) -> Result<Ridden, CommandError> {
    let start = start(&setup.scenario)?;
    check_direction(start, &setup.conditions)?;
    let (ride, trace) = traced(&setup.conditions, start);
    Ok(Ridden { ride, trace })
}

/// As [`ride`]; `stop` is called in every control period, and there is no ride once it returns true.
///
/// # Errors
/// As of [`ride`].
pub fn ride_until(setup: &Setup, stop: &dyn Fn() -> bool) -> Result<Option<Ridden>, CommandError> {
    let start = start(&setup.scenario)?;
    check_direction(start, &setup.conditions)?;
    Ok(traced_until(&setup.conditions, start, stop).map(|(ride, trace)| Ridden { ride, trace }))
}

impl Ridden {
    /// The document.
    pub fn document(&self, setup: &Setup) -> RideDocument {
        RideDocument::new(setup.config.clone(), setup.scenario.clone(), &self.ride)
    }
}
