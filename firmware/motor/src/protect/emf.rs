//! Whether the back-EMF belongs to the encoder's speed: the only sign of an encoder that stands while the motor turns.

use super::follow_mean;
use crate::fault::Fault;
use crate::transform::Vector;
use control::param::{Leaf, Visit};

/// How far the voltage may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmfConfig {
    /// Largest mean distance between the voltage applied and that which current and speed explain \[V\]. More than the
    /// error of the resistance, hot and cold, at the largest current.
    pub error_v: f32,
    /// Time constant of the mean \[calls\].
    pub mean_ticks: u16,
}

impl EmfConfig {
    /// Shows every parameter.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        to.number(&Leaf::new("emf", "error_v", 0.1, 50.0), &mut self.error_v);
        to.count(&Leaf::new("emf", "mean_ticks", 1.0, 10_000.0), &mut self.mean_ticks);
    }
}

/// One call: `unexplained` is the voltage applied less that which current and speed explain.
pub fn step(config: &EmfConfig, mean_v: &mut f32, unexplained: Vector) -> Option<Fault> {
    follow_mean(mean_v, unexplained.length(), 1.0 / f32::from(config.mean_ticks));
    (*mean_v > config.error_v).then_some(Fault::VoltageAstray)
}
