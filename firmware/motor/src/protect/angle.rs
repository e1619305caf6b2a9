//! Checks the direction of the back-EMF against the encoder's angle; only this check detects a slipped encoder.
//!
//! The magnets' voltage `omega flux` lies along q. An angle error `x` rotates it to `omega flux (sin x, cos x)`.
//! Without d current, an error of the resistance lies along q alone, and so does most of the dead-time error. The d
//! component therefore shows an error near a quarter turn already at low speed, the q component one near a half turn
//! at higher speed. A consistent back-EMF confirms the angle for a limited time; without confirmation only a small
//! torque is permitted.

use super::follow_mean;
use crate::fault::Fault;
use crate::transform::Vector;
use control::param::{ParamSpec, ParamVisitor};

/// Tolerances of the back-EMF, and the torque without confirmation of the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleConfig {
    /// Constant tolerance of the mean voltage: offsets and noise of the current sensors, bus voltage \[V\].
    pub error_v: f32,
    /// Tolerance as a fraction of the resistive voltage.
    pub resistance_part: f32,
    /// Tolerance along d or q as a fraction of the magnets' voltage: flux, inductance, alignment.
    pub flux_part: f32,
    /// Tolerance as a fraction of a phase's dead-time voltage.
    pub dead_part: f32,
    /// Time constant of the mean values \[calls\].
    pub mean_calls: u16,
    /// Largest torque on the steer axis while the angle is unconfirmed \[N m\].
    pub unproved_nm: f32,
    /// Time for which a confirmation is valid \[calls\].
    pub proof_calls: u16,
}

impl AngleConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("angle", "error_v", 0.01, 50.0), &mut self.error_v);
        to.number(&ParamSpec::new("angle", "resistance_part", 0.0, 2.0), &mut self.resistance_part);
        to.number(&ParamSpec::new("angle", "flux_part", 0.0, 0.65), &mut self.flux_part);
        to.number(&ParamSpec::new("angle", "dead_part", 0.0, 5.0), &mut self.dead_part);
        to.count(&ParamSpec::new("angle", "mean_calls", 1.0, 10_000.0), &mut self.mean_calls);
        to.number(&ParamSpec::new("angle", "unproved_nm", 0.1, 100.0), &mut self.unproved_nm);
        to.count(&ParamSpec::new("angle", "proof_calls", 1.0, 65535.0), &mut self.proof_calls);
    }
}

/// Voltages of one call \[V\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voltages {
    /// Applied voltage less the part that current and speed explain.
    pub unexplained: Vector,
    /// Magnets' voltage from the encoder's speed, with sign.
    pub magnets: f32,
    /// Expected resistive voltage.
    pub resistive: f32,
    /// Dead-time voltage of a phase.
    pub dead: f32,
}

/// Mean voltages \[V\], and remaining validity of the last confirmation \[calls\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleState {
    /// Unexplained voltage along d.
    aside: f32,
    /// Unexplained voltage along q, positive with the magnets' voltage.
    along: f32,
    magnets: f32,
    resistive: f32,
    proved: u16,
}

impl AngleState {
    /// Whether the angle is confirmed.
    pub fn is_proved(&self) -> bool {
        self.proved > 0
    }
}

/// One call.
pub fn step(config: &AngleConfig, state: &mut AngleState, now: &Voltages) -> Option<Fault> {
    let gain = 1.0 / f32::from(config.mean_calls);
    let along = if now.magnets < 0.0 { -now.unexplained.q } else { now.unexplained.q };
    follow_mean(&mut state.aside, now.unexplained.d, gain);
    follow_mean(&mut state.along, along, gain);
    follow_mean(&mut state.magnets, now.magnets.abs(), gain);
    follow_mean(&mut state.resistive, now.resistive, gain);

    let dead = config.dead_part * now.dead;
    let (aside, flux) = (state.aside.abs(), config.flux_part * state.magnets);
    // A small current has a small resistive voltage, and its dead time is compensated only in part.
    let error = config.error_v + dead + dead.max(config.resistance_part * state.resistive);
    // The error is less than an eighth of a turn, for all tolerated errors.
    let proved = state.magnets + state.along > error + aside;
    state.proved = if proved { config.proof_calls } else { state.proved.saturating_sub(1) };
    let wrong = aside > config.error_v + dead + flux || -state.along > error + flux;
    wrong.then_some(Fault::AngleMismatch)
}
