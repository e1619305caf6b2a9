//! Limits the requested torque by magnitude, rate and available current.

use control::maths::bounded;
use control::param::{ParamSpec, ParamVisitor};

/// Limits of the torque on the steer axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimit {
    /// Largest torque \[N m\].
    pub max_nm: f32,
    /// Largest rate of change \[N m/s\].
    pub slew_nm_s: f32,
}

impl TorqueLimit {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("demand", "max_nm", 0.1, 100.0), &mut self.max_nm);
        to.number(&ParamSpec::new("demand", "slew_nm_s", 1.0, 1e6), &mut self.slew_nm_s);
    }
}

/// One call of `period_s`: the torque that follows `before_nm`, for the request `requested_nm` and the current limit
/// `max_a`. `torque_nm_a` is the torque per ampere, with its sign.
pub fn step(
    demand: &TorqueLimit,
    period_s: f32,
    before_nm: f32,
    requested_nm: f32,
    max_a: f32,
    torque_nm_a: f32,
) -> f32 {
    let size = if torque_nm_a < 0.0 { -torque_nm_a } else { torque_nm_a };
    let target = bounded(bounded(requested_nm, demand.max_nm), max_a * size);
    before_nm + bounded(target - before_nm, demand.slew_nm_s * period_s)
}
