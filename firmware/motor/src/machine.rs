//! Model of the permanent-magnet motor and its gear: torque per current, speed per voltage.

use control::param::{ParamSpec, ParamVisitor};

/// Motor and gear, from a data sheet or a measurement. Electrical values are per phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Pole pairs.
    pub pole_pairs: u16,
    /// Phase resistance: half of the terminal-to-terminal resistance \[ohm\].
    pub resistance_ohm: f32,
    /// Inductance along d \[H\].
    pub inductance_d_h: f32,
    /// Inductance along q \[H\].
    pub inductance_q_h: f32,
    /// Flux linkage of the magnets, peak: phase back-EMF per electrical speed \[Wb\].
    pub flux_wb: f32,
    /// Gear ratio: turns of the motor per turn of the steer.
    pub ratio: f32,
    /// Whether a motor turning forward (phases a, b, c in this order) steers to the left.
    pub reversed: bool,
}

impl Motor {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.count(&ParamSpec::new("motor", "pole_pairs", 1.0, 50.0), &mut self.pole_pairs);
        to.number(&ParamSpec::new("motor", "resistance_ohm", 1e-3, 10.0), &mut self.resistance_ohm);
        to.number(&ParamSpec::new("motor", "inductance_d_h", 1e-6, 0.1), &mut self.inductance_d_h);
        to.number(&ParamSpec::new("motor", "inductance_q_h", 1e-6, 0.1), &mut self.inductance_q_h);
        to.number(&ParamSpec::new("motor", "flux_wb", 1e-5, 1.0), &mut self.flux_wb);
        to.number(&ParamSpec::new("motor", "ratio", 1.0, 1000.0), &mut self.ratio);
        to.switch(&ParamSpec::switch("motor", "reversed"), &mut self.reversed);
    }

    /// Torque on the steer axis per q current, positive to the right \[N m/A\]; without gear losses, and without
    /// reluctance torque, as the d current is zero.
    pub fn torque_nm_a(&self) -> f32 {
        let size = 1.5 * f32::from(self.pole_pairs) * self.flux_wb * self.ratio;
        if self.reversed { -size } else { size }
    }

    /// Motor speed at which the terminal-to-terminal back-EMF has the peak `volt`, with the bridge open \[turns/s\].
    pub fn turns_s_at(&self, volt: f32) -> f32 {
        const SQRT_3: f32 = 1.732_050_8;
        volt / (SQRT_3 * self.flux_wb * f32::from(self.pole_pairs) * core::f32::consts::TAU)
    }
}
