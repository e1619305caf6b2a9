//! The temperature: less current from warm to hot, none beyond.

use super::share;
use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// Temperatures of the hottest place that is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureConfig {
    /// Above it the current is limited, down to none at `hot_c` \[deg C\].
    pub warm_c: f32,
    /// Above it the bridge goes off \[deg C\].
    pub hot_c: f32,
}

impl TemperatureConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("heat", "warm_c", 20.0, 150.0), &mut self.warm_c);
        to.number(&ParamSpec::new("heat", "hot_c", 21.0, 160.0), &mut self.hot_c);
    }
}

/// What a working sensor can show \[deg C\]: a broken wire or a short shows more or less.
const BELIEVABLE_C: core::ops::RangeInclusive<f32> = -40.0..=180.0;

/// The share of the current that may flow, and what is wrong.
pub fn check(config: &TemperatureConfig, temperature_c: f32) -> (f32, Option<Fault>) {
    if !BELIEVABLE_C.contains(&temperature_c) {
        return (0.0, Some(Fault::HeatSensor));
    }
    let fault = (temperature_c > config.hot_c).then_some(Fault::Hot);
    (share(temperature_c, config.hot_c, config.warm_c), fault)
}
