//! The machine: a permanent-magnet motor, its gear, and what they make of a current.

use control::param::{ParamSpec, ParamVisitor};

/// A motor and its gear, as a data sheet or a measurement tells them. Everything electrical is of one phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Pairs of poles.
    pub pole_pairs: u16,
    /// Resistance of a phase: half of that between two terminals \[ohm\].
    pub resistance_ohm: f32,
    /// Inductance along the rotor's flux \[H\].
    pub inductance_d_h: f32,
    /// Inductance a quarter of an electrical turn from it \[H\].
    pub inductance_q_h: f32,
    /// Flux of the magnets through a phase, peak: back-EMF of a phase per electrical speed \[Wb\].
    pub flux_wb: f32,
    /// Turns of the motor to one of the steer.
    pub ratio: f32,
    /// Whether a motor turning forward (phases a, b, c in this order) steers to the left.
    pub reversed: bool,
}

impl Motor {
    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.count(&ParamSpec::new("motor", "pole_pairs", 1.0, 50.0), &mut self.pole_pairs);
        to.number(&ParamSpec::new("motor", "resistance_ohm", 1e-3, 10.0), &mut self.resistance_ohm);
        to.number(&ParamSpec::new("motor", "inductance_d_h", 1e-6, 0.1), &mut self.inductance_d_h);
        to.number(&ParamSpec::new("motor", "inductance_q_h", 1e-6, 0.1), &mut self.inductance_q_h);
        to.number(&ParamSpec::new("motor", "flux_wb", 1e-5, 1.0), &mut self.flux_wb);
        to.number(&ParamSpec::new("motor", "ratio", 1.0, 1000.0), &mut self.ratio);
        to.switch(&ParamSpec::switch("motor", "reversed"), &mut self.reversed);
    }

    /// Torque on the steer axis, to the right, of a q current of 1 A \[N m/A\]; losses of the gear are not in it,
    /// nor the torque of unequal inductances, as d is kept at zero.
    pub fn torque_nm_a(&self) -> f32 {
        let size = 1.5 * f32::from(self.pole_pairs) * self.flux_wb * self.ratio;
        if self.reversed { -size } else { size }
    }

    /// Speed of the motor at which the back-EMF between two terminals peaks at `volt`, the bridge open \[turns/s\].
    pub fn turns_s_at(&self, volt: f32) -> f32 {
        const SQRT_3: f32 = 1.732_050_8;
        volt / (SQRT_3 * self.flux_wb * f32::from(self.pole_pairs) * core::f32::consts::TAU)
    }
}
