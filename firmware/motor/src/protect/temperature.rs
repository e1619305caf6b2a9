//! Temperature protection: reduces the current from warm to hot, opens the bridge beyond.

use super::share;
use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// Temperature limits, for the highest measured temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureConfig {
    /// Temperature above which the current is limited, down to zero at `hot_c` \[deg C\].
    pub warm_c: f32,
    /// Temperature above which the bridge opens \[deg C\].
    pub hot_c: f32,
}

impl TemperatureConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("heat", "warm_c", 20.0, 150.0), &mut self.warm_c);
        to.number(&ParamSpec::new("heat", "hot_c", 21.0, 160.0), &mut self.hot_c);
    }
}

/// Range of a working sensor \[deg C\]: a broken wire or a short is outside.
const PLAUSIBLE_C: core::ops::RangeInclusive<f32> = -40.0..=180.0;

/// The permitted share of the current, and a fault.
pub fn check(config: &TemperatureConfig, temperature_c: f32) -> (f32, Option<Fault>) {
    if !PLAUSIBLE_C.contains(&temperature_c) {
        return (0.0, Some(Fault::HeatSensor));
    }
    let fault = (temperature_c > config.hot_c).then_some(Fault::Hot);
    (share(temperature_c, config.hot_c, config.warm_c), fault)
}
