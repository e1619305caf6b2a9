//! From the torque asked for to the q current wanted.

use control::maths::bounded;
use control::param::{ParamSpec, ParamVisitor};

/// Limits of the torque on the steer axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimit {
    /// Largest torque \[N m\].
    pub max_nm: f32,
    /// Largest change per second \[N m/s\].
    pub slew_nm_s: f32,
}

impl TorqueLimit {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("demand", "max_nm", 0.1, 100.0), &mut self.max_nm);
        to.number(&ParamSpec::new("demand", "slew_nm_s", 1.0, 1e6), &mut self.slew_nm_s);
    }
}

/// One call of `period_s`: the torque wanted after `before_nm`, when `asked_nm` is asked for and `max_a` may flow,
/// `torque_nm_a` being the torque of 1 A (its sign is the direction).
pub fn step(
    demand: &TorqueLimit,
    period_s: f32,
    before_nm: f32,
    asked_nm: f32,
    max_a: f32,
    torque_nm_a: f32,
) -> f32 {
    let size = if torque_nm_a < 0.0 { -torque_nm_a } else { torque_nm_a };
    let target = bounded(bounded(asked_nm, demand.max_nm), max_a * size);
    before_nm + bounded(target - before_nm, demand.slew_nm_s * period_s)
}
