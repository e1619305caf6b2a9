//! Checks of the phase currents: range, trip and sum.

use crate::fault::{Fault, Faults};
use control::param::{ParamSpec, ParamVisitor};

/// Measured phase currents, positive into the motor \[A\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phases {
    /// Phases a, b and c.
    Three([f32; 3]),
    /// Phases a and b; c makes the sum zero.
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

/// Limits of the current sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorsConfig {
    /// Range of the sensors \[A\].
    pub range_a: f32,
    /// Trip: phase current that opens the bridge at once \[A\].
    pub trip_a: f32,
    /// Largest valid sum of three phases \[A\].
    pub sum_a: f32,
    /// Calls for which a larger sum is tolerated.
    pub sum_calls: u16,
}

impl SensorsConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("sensors", "range_a", 0.1, 1000.0), &mut self.range_a);
        to.number(&ParamSpec::new("sensors", "trip_a", 0.1, 1000.0), &mut self.trip_a);
        to.number(&ParamSpec::new("sensors", "sum_a", 0.01, 100.0), &mut self.sum_a);
        to.count(&ParamSpec::new("sensors", "sum_calls", 0.0, 1000.0), &mut self.sum_calls);
    }
}

/// One call: the faults of three currents \[A\]; `beyond` counts the calls with too large a sum.
pub fn step(config: &SensorsConfig, beyond: &mut u16, phases_a: [f32; 3]) -> Faults {
    let mut faults = Faults::NONE;
    // Negated so that NaN, which compares false, is a fault.
    if !phases_a.iter().all(|i| i.abs() <= config.range_a) {
        faults.note(Fault::CurrentSensor, true);
        return faults;
    }
    faults.note(Fault::OverCurrent, phases_a.iter().any(|i| i.abs() > config.trip_a));
    let [a, b, c] = phases_a;
    *beyond = if (a + b + c).abs() > config.sum_a { beyond.saturating_add(1) } else { 0 };
    faults.note(Fault::CurrentSum, *beyond > config.sum_calls);
    faults
}
