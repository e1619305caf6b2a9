//! The current loop: two PI controllers with what is known of the motor fed forward.
//!
//! **Gains.** With `kp = bandwidth L` and `ki = bandwidth R` the controller's zero lies on the winding's pole, and
//! the closed loop is of the first order with the bandwidth chosen.
//!
//! **Anti-windup** is by back-calculation with the gain `ki / kp`: the integral goes on with the error that
//! would have asked for just the voltage that was left (Hanus's conditioning). Of the ways known it is the one
//! that needs no case for each axis where a circle cuts both, and it forgets within the winding's own time L/R.

use crate::machine::Motor;
use crate::transform::Vector;
use control::maths::bounded;
use control::param::{ParamSpec, ParamVisitor};
use core::f32::consts::TAU;

/// What may be chosen of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentConfig {
    /// Bandwidth of the closed loop \[Hz\]; at most a twelfth of the rate of calls.
    pub bandwidth_hz: f32,
    /// Largest current, as a vector \[A\].
    pub max_a: f32,
}

impl CurrentConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("current", "bandwidth_hz", 10.0, 5000.0), &mut self.bandwidth_hz);
        to.number(&ParamSpec::new("current", "max_a", 0.1, 200.0), &mut self.max_a);
    }
}

/// The loop's gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Proportional, of d and q \[V/A\].
    kp: [f32; 2],
    /// Integral per call \[V/A\].
    ki: f32,
    motor: Motor,
}

impl Gains {
    /// For `rate_hz` calls a second.
    pub fn new(motor: &Motor, config: &CurrentConfig, rate_hz: f32) -> Self {
        let omega = TAU * config.bandwidth_hz;
        Self {
            kp: [omega * motor.inductance_d_h, omega * motor.inductance_q_h],
            ki: omega * motor.resistance_ohm / rate_hz,
            motor: *motor,
        }
    }

    /// Voltage that turning makes in a winding that carries `current`: back-EMF and what d and q lend each
    /// other, at an electrical speed \[rad/s\].
    pub fn turning(&self, current: Vector, omega_rad_s: f32) -> Vector {
        let m = &self.motor;
        Vector::new(
            -omega_rad_s * m.inductance_q_h * current.q,
            omega_rad_s * (m.inductance_d_h * current.d + m.flux_wb),
        )
    }

    /// Voltage that a steady current needs.
    pub fn steady(&self, current: Vector, omega_rad_s: f32) -> Vector {
        current.times(self.motor.resistance_ohm).plus(self.turning(current, omega_rad_s))
    }
}

/// What the loop remembers: the integrals \[V\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurrentState {
    integral: Vector,
}

/// One call: the voltage for a current that is `wanted`, inside a circle of `max_v`.
pub fn step(
    gains: &Gains,
    state: &mut CurrentState,
    wanted: Vector,
    measured: Vector,
    omega_rad_s: f32,
    max_v: f32,
) -> Vector {
    let error = wanted.minus(measured);
    let [kp_d, kp_q] = gains.kp;
    let requested = Vector::new(kp_d * error.d, kp_q * error.q)
        .plus(state.integral)
        .plus(gains.turning(wanted, omega_rad_s));
    let given = requested.inside(max_v);
    let left = given.minus(requested);
    state.integral = Vector::new(
        bounded(state.integral.d + gains.ki * (error.d + left.d / kp_d), max_v),
        bounded(state.integral.q + gains.ki * (error.q + left.q / kp_q), max_v),
    );
    given
}
