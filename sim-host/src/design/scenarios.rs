//! What laws are designed for, and what they are then tried on besides.

use crate::ride::FallCriterion;
use crate::study::trial::Trial;
use control::Config;

/// Trials to design with, and others to judge by.
#[derive(Clone, Debug)]
pub struct Scenarios {
    /// The design maximises the least area over these.
    pub training: Vec<Trial>,
    /// Riders and bicycles the design does not see.
    pub held_out: Vec<Trial>,
}

/// The bicycle of the design.
const BICYCLE: &str = "rigid_jason";
/// Other bicycles, all with a rigid rider.
const OTHERS: [&str; 5] =
    ["benchmark", "rigid_luke", "balanceassistv1_jason", "browser_jason", "stratos_rider"];
/// Other riders; the naive old one is the young with a delay of 60 ms.
const RIDERS: [(&str, Option<f64>); 4] =
    [("young", Some(0.060)), ("smart6", None), ("undelayed", None), ("hess", None)];
/// How late sensors are in what the design does not see \[ms\].
const LATE_MS: u16 = 20;

/// No rider, the young and the smart one with sensors 0, 20 and 50 ms late; held out are other riders and other
/// bicycles. The motor gives what the product's limits let through.
///
/// # Errors
/// When a bicycle or a rider does not ship.
pub fn arena(fall: FallCriterion) -> Result<Scenarios, String> {
    let limits = Config::product().limits;
    let on = |bicycle, rider, delay_s, late| {
        Trial::new(bicycle, rider, delay_s, late, limits).map(|trial| Trial { fall, ..trial })
    };
    let mut training = Vec::new();
    for rider in [None, Some("young"), Some("smart")] {
        for late in [0, 20, 50] {
            training.push(on(BICYCLE, rider, None, late)?);
        }
    }
    let riders = RIDERS.iter().map(|(rider, delay_s)| on(BICYCLE, Some(rider), *delay_s, LATE_MS));
    let bicycles = OTHERS.iter().map(|bicycle| on(bicycle, None, None, LATE_MS));
    Ok(Scenarios { training, held_out: riders.chain(bicycles).collect::<Result<_, _>>()? })
}
