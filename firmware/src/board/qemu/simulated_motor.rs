//! Simulated motor for counting the instructions of the motor loop: modelled windings, rotor at constant speed.

use motor::angle::Angle;
use motor::transform::{Vector, clarke, phases, stator};
use motor::{Inputs, MotorCommand, Output, Phases, Plan};

/// Bus voltage \[V\].
const BUS_V: f32 = 24.0;

/// The motor; calls are one PWM period apart.
pub struct SimulatedMotor {
    angle: Angle,
    /// Motor angle \[turns\].
    turned_per_call: f32,
    /// Current in stator axes \[A\].
    current: Vector,
    /// Duty cycles of the period that begins with the next call.
    duties: Option<[f32; 3]>,
}

impl SimulatedMotor {
    /// Without current, turning at the given speed \[turns/s\].
    pub fn new(plan: &Plan, turns_s: f32) -> Self {
        let turned_per_call = turns_s / plan.config().rate_hz;
        Self { angle: Angle(0), turned_per_call, current: Vector::new(0.0, 0.0), duties: None }
    }

    /// Present measurements, with the given command.
    pub fn inputs(&self, plan: &Plan, command: MotorCommand) -> Inputs {
        let counts = u32::from(plan.config().encoder.counts);
        Inputs {
            phases: Phases::Three(phases(self.current)),
            bus_v: BUS_V,
            angle_counts: (((self.angle.0 >> 16) * counts) >> 16) as u16,
            angle_age_calls: 0,
            temperature_c: 25.0,
            command,
        }
    }

    /// The period after a call: the duty cycles of the previous call act.
    pub fn advance(&mut self, plan: &Plan, output: &Output) {
        let (motor, rate_hz) = (&plan.config().motor, plan.config().rate_hz);
        let acting = core::mem::replace(&mut self.duties, output.duties);
        let omega_rad_s =
            core::f32::consts::TAU * f32::from(motor.pole_pairs) * self.turned_per_call * rate_hz;
        self.current = match (acting, output.duties) {
            (Some(duties), Some(_)) => {
                let voltage = clarke(duties).times(BUS_V);
                let back_emf = Vector::new(0.0, omega_rad_s * motor.flux_wb);
                // Mean over the period.
                let middle = self.angle.plus(Angle::of(0.5 * self.turned_per_call));
                let back_emf = stator(back_emf, middle.times(motor.pole_pairs).sin_cos());
                let left = voltage.minus(back_emf).minus(self.current.times(motor.resistance_ohm));
                self.current.plus(left.times(1.0 / (motor.inductance_q_h * rate_hz)))
            }
            // With an open bridge the current decays quickly.
            _ => Vector::new(0.0, 0.0),
        };
        self.angle = self.angle.plus(Angle::of(self.turned_per_call));
    }
}
