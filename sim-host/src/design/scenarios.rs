//! Trials of a design: training trials and hold-out scenarios.

use crate::ride::FallCriterion;
use crate::study::trial::Trial;
use control::{Config, Limits};

/// Training trials and hold-out trials.
#[derive(Clone, Debug)]
pub struct Scenarios {
    /// The design maximises the smallest area over these.
    pub training: Vec<Trial>,
    /// Hold-out riders and bicycles, not used by the design.
    pub held_out: Vec<Trial>,
    /// Limits of the motor torque in every trial.
    pub limits: Limits,
    /// When a ride counts as fallen.
    pub fall: FallCriterion,
}

/// Bicycle of the training trials.
const BICYCLE: &str = "rigid_jason";
/// Hold-out bicycles, all with a rigid rider.
const OTHERS: [&str; 5] =
    ["benchmark", "rigid_luke", "balanceassistv1_jason", "browser_jason", "stratos_rider"];
/// Hold-out riders; the naive old rider is the young one with a delay of 60 ms.
const RIDERS: [(&str, Option<f64>); 4] =
    [("young", Some(0.060)), ("smart6", None), ("undelayed", None), ("hess", None)];
/// Sensor delay of the hold-out trials \[ms\].
const LATE_MS: u16 = 20;

/// Training: no rider, the young and the smart rider, with sensor delays of 0, 20 and 50 ms. Hold-out: other
/// riders and other bicycles. The motor has the product's limits.
pub fn scenarios(fall: FallCriterion) -> Scenarios {
    let limits = Config::product().limits;
    let on = |bicycle, rider, delay_s, late| {
        let mut trial = Trial::new(bicycle, rider, delay_s, late, limits);
        trial.scenario.fall = fall.into();
        trial
    };
    let mut training = Vec::new();
    for rider in [None, Some("young"), Some("smart")] {
        for late in [0, 20, 50] {
            training.push(on(BICYCLE, rider, None, late));
        }
    }
    let riders = RIDERS.iter().map(|(rider, delay_s)| on(BICYCLE, Some(rider), *delay_s, LATE_MS));
    let bicycles = OTHERS.iter().map(|bicycle| on(bicycle, None, None, LATE_MS));
    Scenarios { training, held_out: riders.chain(bicycles).collect(), limits, fall }
}
