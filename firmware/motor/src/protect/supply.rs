//! Supply protection: reduces the current while the bus voltage sags, opens the bridge outside its limits.

use super::share;
use crate::fault::Fault;
use control::param::{ParamSpec, ParamVisitor};

/// Voltage limits of the bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplyConfig {
    /// Voltage below which the bridge opens \[V\].
    pub low_v: f32,
    /// Voltage below which the current is limited, down to zero at `low_v` \[V\].
    pub sag_v: f32,
    /// Voltage above which the bridge opens \[V\].
    pub high_v: f32,
    /// Calls for which the bus voltage can be outside its limits.
    pub persist_calls: u16,
}

impl SupplyConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("supply", "low_v", 1.0, 100.0), &mut self.low_v);
        to.number(&ParamSpec::new("supply", "sag_v", 1.0, 100.0), &mut self.sag_v);
        to.number(&ParamSpec::new("supply", "high_v", 1.0, 100.0), &mut self.high_v);
        to.count(&ParamSpec::new("supply", "persist_calls", 0.0, 1000.0), &mut self.persist_calls);
    }
}

/// Smallest plausible voltage: the controller itself needs more \[V\].
const NONE_V: f32 = 1.0;
/// Largest plausible voltage \[V\].
const ABSURD_V: f32 = 200.0;

/// Number of consecutive calls outside the limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SupplyState {
    low: u16,
    high: u16,
}

/// One call: the permitted share of the current, and a fault.
pub fn step(config: &SupplyConfig, state: &mut SupplyState, bus_v: f32) -> (f32, Option<Fault>) {
    if !(NONE_V..=ABSURD_V).contains(&bus_v) {
        return (0.0, Some(Fault::BusSensor));
    }
    let count = |calls: u16, outside: bool| if outside { calls.saturating_add(1) } else { 0 };
    state.low = count(state.low, bus_v < config.low_v);
    state.high = count(state.high, bus_v > config.high_v);
    let fault = if state.low > config.persist_calls {
        Some(Fault::BusLow)
    } else {
        (state.high > config.persist_calls).then_some(Fault::BusHigh)
    };
    (share(bus_v, config.low_v, config.sag_v), fault)
}
