//! Faults and sensor errors that no ride of a scenario can have.

use super::PlantChoice;
use super::plant::sensor_named;
use crate::plant::Fault;
use crate::ride::{Assist, Conditions};
use std::collections::BTreeSet;

/// Warnings about faults that have no effect, and about errors of sensors that the controller does not have. Models of several
/// sensors at once are for whatever is fitted.
pub(super) fn warnings(plant: &PlantChoice, conditions: &Conditions) -> Vec<String> {
    let told = |fault: &Fault| {
        idle(fault, conditions).map(|reason| format!("the fault {fault} has no effect: {reason}"))
    };
    let faults = plant.faults.iter().filter_map(told);
    let Assist::Firmware(plan) = &conditions.assist else { return faults.collect() };
    let names: BTreeSet<&str> = plant.sensors.iter().filter_map(|change| change.sensor.as_deref()).collect();
    let sensors = names.into_iter().filter_map(|name| {
        let reason = sensor_named(name).ok()?.unfitted(&plan.config().input)?;
        Some(format!("the errors of the sensor {name} have no effect: {reason}"))
    });
    faults.chain(sensors).collect()
}

/// Why a fault has no effect on any ride; `None` if it can have one.
fn idle(fault: &Fault, conditions: &Conditions) -> Option<String> {
    match &conditions.assist {
        Assist::Firmware(plan) => {
            fault.idle(&plan.config().input, u64::from(conditions.steps()), conditions.step_s)
        }
        Assist::None | Assist::Ideal(_) | Assist::Own(_) => {
            Some("without a law there is no controller that measures or commands".into())
        }
    }
}
