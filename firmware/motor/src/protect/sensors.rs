//! The phase currents: read, freed of their zeros, and held against each other and against the trip.

use crate::fault::{Fault, Faults};
use control::param::{ParamSpec, ParamVisitor};

/// Phase currents as measured, into the motor positive \[A\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phases {
    /// Of a, b and c.
    Three([f32; 3]),
    /// Of a and b; c is what makes the sum zero.
    Two([f32; 2]),
}

impl Phases {
    /// All three \[A\].
    pub fn all(self) -> [f32; 3] {
        match self {
            Phases::Three(all) => all,
            Phases::Two([a, b]) => [a, b, -(a + b)],
        }
    }
}

/// The current sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorsConfig {
    /// Largest current that can be measured \[A\].
    pub range_a: f32,
    /// Phase current at which the bridge goes off at once \[A\].
    pub trip_a: f32,
    /// Largest sum of three phases that is no fault \[A\].
    pub sum_a: f32,
    /// Calls for which the sum may be larger.
    pub sum_ticks: u16,
}

impl SensorsConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("sensors", "range_a", 0.1, 1000.0), &mut self.range_a);
        to.number(&ParamSpec::new("sensors", "trip_a", 0.1, 1000.0), &mut self.trip_a);
        to.number(&ParamSpec::new("sensors", "sum_a", 0.01, 100.0), &mut self.sum_a);
        to.count(&ParamSpec::new("sensors", "sum_ticks", 0.0, 1000.0), &mut self.sum_ticks);
    }
}

/// One call: what is wrong with three currents \[A\]; `beyond` counts the calls with too large a sum.
pub fn step(config: &SensorsConfig, beyond: &mut u16, phases_a: [f32; 3]) -> Faults {
    let mut faults = Faults::NONE;
    // Written so that NaN, which compares false, is a fault.
    if !phases_a.iter().all(|i| i.abs() <= config.range_a) {
        faults.note(Fault::CurrentSensor, true);
        return faults;
    }
    faults.note(Fault::OverCurrent, phases_a.iter().any(|i| i.abs() > config.trip_a));
    let [a, b, c] = phases_a;
    *beyond = if (a + b + c).abs() > config.sum_a { beyond.saturating_add(1) } else { 0 };
    faults.note(Fault::CurrentSum, *beyond > config.sum_ticks);
    faults
}
