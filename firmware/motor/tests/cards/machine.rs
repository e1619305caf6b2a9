//! Model of a motor on a bicycle's steer, in f64, as the plant of the loop's tests. It shares no code with the loop.
//!
//! Dq axes with inductances that fall with the current, back-EMF, resistance; a bridge averaged over the PWM period
//! with dead time, diodes when open, phases that can open; a bus with resistance and capacitor; a rigid gear; inertia
//! and friction of a steer.

use std::f64::consts::TAU;

/// Parameters; those of the example unless a test changes them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Params {
    pub(crate) pole_pairs: f64,
    pub(crate) resistance_ohm: f64,
    pub(crate) inductance_d_h: f64,
    pub(crate) inductance_q_h: f64,
    /// Current at which the inductances have halved \[A\].
    pub(crate) saturation_a: f64,
    pub(crate) flux_wb: f64,
    /// Gear ratio: turns of the motor per turn of the steer; negative if reversed.
    pub(crate) ratio: f64,
    /// Inertia of steer and rotor.
    pub(crate) inertia_kg_m2: f64,
    pub(crate) viscous_nm_s_rad: f64,
    pub(crate) coulomb_nm: f64,
    pub(crate) source_v: f64,
    pub(crate) source_ohm: f64,
    pub(crate) capacitor_f: f64,
    pub(crate) dead_time_s: f64,
    pub(crate) rate_hz: f64,
}

impl Default for Params {
    /// The example motor on the benchmark bicycle's steer (inertia 0.298 kg m^2, Meijaard et al. 2007) and the
    /// reflected rotor, friction as measured on the Davis bicycle. Assumed: half the inductance at 20 A, the
    /// battery's resistance, the capacitor.
    fn default() -> Self {
        let sheet_nm_a = 40.4e-3;
        Self {
            pole_pairs: 8.0,
            resistance_ohm: 0.573 / 2.0,
            inductance_d_h: 0.301e-3 / 2.0,
            inductance_q_h: 0.301e-3 / 2.0,
            saturation_a: 20.0,
            flux_wb: sheet_nm_a * std::f64::consts::FRAC_PI_3 / 3.0_f64.sqrt() / 8.0,
            ratio: 36.0,
            inertia_kg_m2: 0.298 + 181e-7 * 36.0 * 36.0,
            viscous_nm_s_rad: 0.34,
            coulomb_nm: 0.15,
            source_v: 25.2,
            source_ohm: 0.1,
            capacitor_f: 1e-3,
            dead_time_s: 0.5e-6,
            rate_hz: 20_000.0,
        }
    }
}

/// State.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Machine {
    pub(crate) params: Params,
    /// Currents in stator axes, alpha and beta \[A\].
    pub(crate) alpha_beta_a: [f64; 2],
    /// Turns of the motor since the start, electrically forward.
    pub(crate) motor_turns: f64,
    pub(crate) steer_rate_rad_s: f64,
    pub(crate) bus_v: f64,
    /// Open phases.
    pub(crate) cut: [bool; 3],
    /// Whether the handlebar is held at rest.
    pub(crate) held: bool,
    /// Torque of hands \[N m\].
    pub(crate) load_nm: f64,
}

const STEPS: usize = 20;
const AXES: [[f64; 2]; 3] = [[1.0, 0.0], [-0.5, 0.866_025_403_784_438_6], [-0.5, -0.866_025_403_784_438_6]];

impl Machine {
    pub(crate) fn new(params: Params) -> Self {
        Self {
            params,
            alpha_beta_a: [0.0; 2],
            motor_turns: 0.0,
            steer_rate_rad_s: 0.0,
            bus_v: params.source_v,
            cut: [false; 3],
            held: false,
            load_nm: 0.0,
        }
    }

    pub(crate) fn electrical_rad(&self) -> f64 {
        self.motor_turns * self.params.pole_pairs * TAU
    }

    /// Phase currents, as projections of the axes.
    pub(crate) fn phases_a(&self) -> [f64; 3] {
        let [a, b] = self.alpha_beta_a;
        AXES.map(|[x, y]| x * a + y * b)
    }

    /// Currents d and q.
    pub(crate) fn dq_a(&self) -> [f64; 2] {
        let (sin, cos) = self.electrical_rad().sin_cos();
        let [a, b] = self.alpha_beta_a;
        [a * cos + b * sin, b * cos - a * sin]
    }

    fn inductances_h(&self, [d, q]: [f64; 2]) -> [f64; 2] {
        let p = &self.params;
        let fall = |i: f64| 1.0 / (1.0 + (i / p.saturation_a).powi(2));
        [p.inductance_d_h * fall(d), p.inductance_q_h * fall(q)]
    }

    /// Torque on the steer, without friction.
    pub(crate) fn torque_nm(&self) -> f64 {
        let p = &self.params;
        let [d, q] = self.dq_a();
        let [ld, lq] = self.inductances_h([d, q]);
        1.5 * p.pole_pairs * (p.flux_wb * q + (ld - lq) * d * q) * p.ratio
    }

    /// One PWM period.
    pub(crate) fn advance(&mut self, duties: Option<[f64; 3]>) {
        self.advance_for(duties, 1.0 / self.params.rate_hz);
    }

    /// Advances by a part of a PWM period, or more \[s\].
    pub(crate) fn advance_for(&mut self, duties: Option<[f64; 3]>, seconds: f64) {
        let steps = (seconds * self.params.rate_hz * STEPS as f64).ceil().max(1.0);
        let dt = seconds / steps;
        for _ in 0..steps as usize {
            let bus_a = self.windings(duties, dt);
            self.steer(dt);
            let p = &self.params;
            self.bus_v += dt / p.capacitor_f * ((p.source_v - self.bus_v) / p.source_ohm - bus_a);
        }
    }

    /// Advances the currents by `dt`; returns the bus current \[A\].
    fn windings(&mut self, duties: Option<[f64; 3]>, dt: f64) -> f64 {
        let p = self.params;
        let phases = self.phases_a();
        let Some(duties) = duties else {
            // The diodes turn the bus against the current until there is none.
            let [a, b] = self.alpha_beta_a;
            let size = a.hypot(b);
            let left = (size - 2.0 / 3.0 * self.bus_v / p.inductance_d_h * dt).max(0.0);
            let keep = if size > 0.0 { left / size } else { 0.0 };
            self.alpha_beta_a = [a * keep, b * keep];
            return -size;
        };
        let lost = p.dead_time_s * p.rate_hz;
        let legs: [f64; 3] =
            std::array::from_fn(|x| self.bus_v * (duties[x] - lost * (phases[x] / 0.1).clamp(-1.0, 1.0)));
        let stator: [f64; 2] =
            std::array::from_fn(|k| (0..3).map(|x| legs[x] * AXES[x][k]).sum::<f64>() * 2.0 / 3.0);
        let omega = self.steer_rate_rad_s * p.ratio * p.pole_pairs;
        let (sin, cos) = self.electrical_rad().sin_cos();
        let [vd, vq] = [stator[0] * cos + stator[1] * sin, stator[1] * cos - stator[0] * sin];
        let [d, q] = self.dq_a();
        let [ld, lq] = self.inductances_h([d, q]);
        let d = d + dt * (vd - p.resistance_ohm * d + omega * lq * q) / ld;
        let q = q + dt * (vq - p.resistance_ohm * q - omega * (ld * d + p.flux_wb)) / lq;
        let (sin, cos) = (self.electrical_rad() + omega * dt).sin_cos();
        self.alpha_beta_a = [d * cos - q * sin, d * sin + q * cos];
        for (axis, cut) in AXES.iter().zip(self.cut) {
            let [a, b] = self.alpha_beta_a;
            if cut {
                let along = a * axis[0] + b * axis[1];
                self.alpha_beta_a = [a - along * axis[0], b - along * axis[1]];
            }
        }
        duties.iter().zip(phases).map(|(d, i)| d * i).sum()
    }

    fn steer(&mut self, dt: f64) {
        let p = self.params;
        let rate = self.steer_rate_rad_s;
        let torque = self.torque_nm() - p.viscous_nm_s_rad * rate + self.load_nm;
        let free = rate + dt * torque / p.inertia_kg_m2;
        // Dry friction does not reverse the motion: the steer sticks.
        let dry = (free.abs() - dt * p.coulomb_nm / p.inertia_kg_m2).max(0.0);
        self.steer_rate_rad_s = if self.held { 0.0 } else { dry.copysign(free) };
        self.motor_turns += dt * self.steer_rate_rad_s * p.ratio / TAU;
    }
}
