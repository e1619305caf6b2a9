//! Current loop: two PI controllers with feed-forward of the motor model.
//!
//! **Gains.** With `kp = bandwidth L` and `ki = bandwidth R` the controller's zero cancels the winding's pole; the
//! closed loop is of first order with the chosen bandwidth.
//!
//! **Anti-windup** is by back-calculation with the gain `ki / kp`: the integral receives the error that would have
//! requested exactly the limited voltage (Hanus's conditioning). Unlike the alternatives, this method needs no case
//! distinction per axis where a circle limits both, and it recovers within the winding's time constant L/R.

use crate::machine::Motor;
use crate::transform::Vector;
use control::maths::bounded;
use control::param::{ParamSpec, ParamVisitor};
use core::f32::consts::TAU;

/// Parameters of the current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentConfig {
    /// Bandwidth of the closed loop \[Hz\]; at most a twelfth of the call rate.
    pub bandwidth_hz: f32,
    /// Largest current, as the length of a vector \[A\].
    pub max_a: f32,
}

impl CurrentConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("current", "bandwidth_hz", 10.0, 5000.0), &mut self.bandwidth_hz);
        to.number(&ParamSpec::new("current", "max_a", 0.1, 200.0), &mut self.max_a);
    }
}

/// Gains of the current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Proportional gains of d and q \[V/A\].
    kp: [f32; 2],
    /// Integral gain per call \[V/A\].
    ki: f32,
    motor: Motor,
}

impl Gains {
    /// Gains for `rate_hz` calls per second.
    pub fn new(motor: &Motor, config: &CurrentConfig, rate_hz: f32) -> Self {
        let omega = TAU * config.bandwidth_hz;
        Self {
            kp: [omega * motor.inductance_d_h, omega * motor.inductance_q_h],
            ki: omega * motor.resistance_ohm / rate_hz,
            motor: *motor,
        }
    }

    /// Speed-dependent voltage of a winding that carries `current`: back-EMF and cross-coupling of d and q, at an
    /// electrical speed \[rad/s\].
    pub fn turning(&self, current: Vector, omega_rad_s: f32) -> Vector {
        let m = &self.motor;
        Vector::new(
            -omega_rad_s * m.inductance_q_h * current.q,
            omega_rad_s * (m.inductance_d_h * current.d + m.flux_wb),
        )
    }

    /// Voltage for a constant current.
    pub fn steady(&self, current: Vector, omega_rad_s: f32) -> Vector {
        current.times(self.motor.resistance_ohm).plus(self.turning(current, omega_rad_s))
    }
}

/// State of the loop: the integrals \[V\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurrentState {
    integral: Vector,
}

/// One call: the voltage for the current set-point `set_point`, limited to a circle of radius `max_v`.
pub fn step(
    gains: &Gains,
    state: &mut CurrentState,
    set_point: Vector,
    measured: Vector,
    omega_rad_s: f32,
    max_v: f32,
) -> Vector {
    let error = set_point.minus(measured);
    let [kp_d, kp_q] = gains.kp;
    let requested = Vector::new(kp_d * error.d, kp_q * error.q)
        .plus(state.integral)
        .plus(gains.turning(set_point, omega_rad_s));
    let given = requested.inside(max_v);
    let left = given.minus(requested);
    state.integral = Vector::new(
        bounded(state.integral.d + gains.ki * (error.d + left.d / kp_d), max_v),
        bounded(state.integral.q + gains.ki * (error.q + left.q / kp_q), max_v),
    );
    given
}
