//! Model of bridge, motor and steer axis.

use crate::machine::{Machine, Params};
use std::f64::consts::TAU;

/// Encoder counts per turn.
const ENCODER_COUNTS: f64 = devices::as5047::COUNTS as f64;

/// Rotor inertia of the example motor at the steer axis: 181 g cm^2 behind 36:1 \[kg m^2\]. A bicycle that drives the
/// steer must contain it in its own inertia.
pub const ROTOR_KG_M2: f64 = 181e-7 * 36.0 * 36.0;
/// Supply voltage at the start \[V\].
pub const SOURCE_V: f64 = 25.2;

/// Load of the steer axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// A free steer with its own inertia and friction.
    Free,
    /// A held handlebar.
    Held,
    /// A rate that another model sets \[rad/s\].
    Driven,
}

/// Bridge, motor and steer.
#[derive(Debug)]
pub struct PowerStage {
    machine: Machine,
    at_ns: u64,
    steer_zero_rad: f64,
    /// Encoder zero \[turns of the motor\].
    pub encoder_zero_turns: f64,
    /// Motor phase at each of the bridge's terminals.
    pub terminals: [usize; 3],
    /// Whether the encoder counts backwards.
    pub encoder_reversed: bool,
    /// Time integral of the torque on the steer since [`Self::take_impulse`] \[N m s\].
    impulse_nm_s: f64,
    /// Largest phase current since the start \[A\].
    pub largest_phase_a: f64,
}

impl PowerStage {
    /// The example motor on a free steer, at rest straight ahead.
    pub fn new() -> Self {
        Self {
            machine: Machine::new(Params::default()),
            at_ns: 0,
            steer_zero_rad: 0.0,
            encoder_zero_turns: 0.3,
            terminals: [0, 1, 2],
            encoder_reversed: false,
            impulse_nm_s: 0.0,
            largest_phase_a: 0.0,
        }
    }

    /// Advances to a time, with these duty cycles since the last call.
    pub(crate) fn advance(&mut self, now_ns: u64, duties: Option<[f64; 3]>, dead_time_s: f64) {
        let dt = now_ns.saturating_sub(self.at_ns) as f64 * 1e-9;
        if dt > 0.0 {
            self.machine.params.dead_time_s = dead_time_s;
            self.machine.advance_for(duties.map(|duties| self.at_phases(duties)), dt);
            self.impulse_nm_s += dt * self.machine.torque_nm();
            self.largest_phase_a =
                self.phases_a().into_iter().fold(self.largest_phase_a, |m, i| m.max(i.abs()));
            self.at_ns = now_ns;
        }
    }

    /// Sets the load of the steer axis.
    pub fn set_axis(&mut self, axis: Axis) {
        let (params, machine) = (Params::default(), &mut self.machine);
        machine.held = axis == Axis::Held;
        let driven = axis == Axis::Driven;
        // An axis of infinite inertia keeps its rate.
        machine.params.inertia_kg_m2 = if driven { f64::INFINITY } else { params.inertia_kg_m2 };
        machine.params.coulomb_nm = if driven { 0.0 } else { params.coulomb_nm };
    }

    /// Sets angle \[rad\] and rate \[rad/s\] of a driven steer.
    pub fn drive(&mut self, steer_rad: f64, rate_rad_s: f64) {
        self.machine.steer_rate_rad_s = rate_rad_s;
        self.machine.motor_turns = (steer_rad - self.steer_zero_rad) * self.machine.params.ratio / TAU;
    }

    /// Sets the torque of hands on a free steer \[N m\].
    pub fn set_hands(&mut self, torque_nm: f64) {
        self.machine.load_nm = torque_nm;
    }

    /// Mean motor torque on the steer since the last call, `seconds` ago \[N m\].
    pub fn take_mean_torque_nm(&mut self, seconds: f64) -> f64 {
        std::mem::take(&mut self.impulse_nm_s) / seconds
    }

    /// Present motor torque on the steer \[N m\].
    pub fn torque_nm(&self) -> f64 {
        self.machine.torque_nm()
    }

    /// Currents out of the bridge's terminals \[A\].
    pub fn phases_a(&self) -> [f64; 3] {
        let phases_a = self.machine.phases_a();
        self.terminals.map(|phase| phases_a[phase])
    }

    /// Reorders the terminals by the motor's phases.
    fn at_phases(&self, terminals: [f64; 3]) -> [f64; 3] {
        let mut phases = [0.0; 3];
        self.terminals.iter().zip(terminals).for_each(|(phase, value)| phases[*phase] = value);
        phases
    }

    /// Opens a phase.
    pub fn cut_phase(&mut self, phase: usize) {
        self.machine.cut[phase] = true;
    }

    /// Steer angle, to the right \[rad\].
    pub fn steer_rad(&self) -> f64 {
        self.steer_zero_rad + self.machine.motor_turns * TAU / self.machine.params.ratio
    }

    /// Steer rate, to the right \[rad/s\].
    pub fn steer_rate_rad_s(&self) -> f64 {
        self.machine.steer_rate_rad_s
    }

    /// Voltage of the supply at the bridge \[V\].
    pub fn bus_v(&self) -> f64 {
        self.machine.bus_v
    }

    /// Sets the supply \[V\].
    pub fn set_source_v(&mut self, volt: f64) {
        self.machine.params.source_v = volt;
    }

    /// The offset that an alignment finds \[electrical turns, -0.5 to 0.5\], the encoder counting forward.
    pub fn offset_turns(&self) -> f32 {
        let electrical = self.encoder_zero_turns * self.machine.params.pole_pairs;
        (electrical - electrical.round()) as f32
    }

    pub(crate) fn encoder_counts(&self) -> u16 {
        let sense = if self.encoder_reversed { -1.0 } else { 1.0 };
        let turns = sense * (self.machine.motor_turns + self.encoder_zero_turns);
        (turns * ENCODER_COUNTS).floor().rem_euclid(ENCODER_COUNTS) as u16
    }
}

impl Default for PowerStage {
    fn default() -> Self {
        Self::new()
    }
}
