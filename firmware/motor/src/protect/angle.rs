//! Whether the back-EMF lies where the encoder's angle puts it: the only sign of an encoder that slipped on its shaft.
//!
//! The magnets' voltage lies along q, by `omega flux`. An angle that is wrong by `x` turns it to
//! `omega flux (sin x, cos x)`. With no current along d an error of the resistance lies along q alone, and so does most
//! of the dead time's: d shows an angle near a quarter turn at low speeds already, q one near a half turn, later. What
//! speaks for the angle proves it for a while; without proof only a small torque is given.

use super::follow_mean;
use crate::fault::Fault;
use crate::transform::Vector;
use control::param::{ParamSpec, ParamVisitor};

/// What the back-EMF may be off by, and the torque without its proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleConfig {
    /// Largest error of the mean voltage that is left: zeros of the current sensors, their noise, the bus \[V\].
    pub error_v: f32,
    /// Part of the resistance's voltage by which it may be wrong.
    pub resistance_part: f32,
    /// Part of the magnets' voltage by which the back-EMF may be off along d or q: flux, inductance, alignment.
    pub flux_part: f32,
    /// Part of the voltage that the dead time takes of a phase by which it may be wrong.
    pub dead_part: f32,
    /// Time constant of the means \[calls\].
    pub mean_ticks: u16,
    /// Largest torque on the steer axis while the angle is not proved \[N m\].
    pub unproved_nm: f32,
    /// Time for which a proof counts \[calls\].
    pub proof_ticks: u16,
}

impl AngleConfig {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("angle", "error_v", 0.01, 50.0), &mut self.error_v);
        to.number(&ParamSpec::new("angle", "resistance_part", 0.0, 2.0), &mut self.resistance_part);
        to.number(&ParamSpec::new("angle", "flux_part", 0.0, 0.65), &mut self.flux_part);
        to.number(&ParamSpec::new("angle", "dead_part", 0.0, 5.0), &mut self.dead_part);
        to.count(&ParamSpec::new("angle", "mean_ticks", 1.0, 10_000.0), &mut self.mean_ticks);
        to.number(&ParamSpec::new("angle", "unproved_nm", 0.1, 100.0), &mut self.unproved_nm);
        to.count(&ParamSpec::new("angle", "proof_ticks", 1.0, 65535.0), &mut self.proof_ticks);
    }
}

/// Voltages of one call \[V\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voltages {
    /// Applied, less what current and speed explain.
    pub unexplained: Vector,
    /// The magnets' by the encoder's speed, with its sign.
    pub magnets: f32,
    /// What the resistance should take.
    pub resistive: f32,
    /// What the dead time takes of a phase.
    pub dead: f32,
}

/// Means of the last calls \[V\], and how long the last proof still counts \[calls\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleState {
    /// Unexplained along d.
    aside: f32,
    /// Unexplained along q, positive with the magnets' voltage.
    along: f32,
    magnets: f32,
    resistive: f32,
    proved: u16,
}

impl AngleState {
    /// Whether the angle was proved lately.
    pub fn is_proved(&self) -> bool {
        self.proved > 0
    }
}

/// One call.
pub fn step(config: &AngleConfig, state: &mut AngleState, now: &Voltages) -> Option<Fault> {
    let gain = 1.0 / f32::from(config.mean_ticks);
    let along = if now.magnets < 0.0 { -now.unexplained.q } else { now.unexplained.q };
    follow_mean(&mut state.aside, now.unexplained.d, gain);
    follow_mean(&mut state.along, along, gain);
    follow_mean(&mut state.magnets, now.magnets.abs(), gain);
    follow_mean(&mut state.resistive, now.resistive, gain);

    let dead = config.dead_part * now.dead;
    let (aside, flux) = (state.aside.abs(), config.flux_part * state.magnets);
    // A small current, whose resistance takes little, is the one whose dead time is made up for in part only.
    let error = config.error_v + dead + dead.max(config.resistance_part * state.resistive);
    // Less than an eighth of a turn off, whatever the errors.
    let proved = state.magnets + state.along > error + aside;
    state.proved = if proved { config.proof_ticks } else { state.proved.saturating_sub(1) };
    let wrong = aside > config.error_v + dead + flux || -state.along > error + flux;
    wrong.then_some(Fault::AngleAstray)
}
