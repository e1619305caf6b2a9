//! The loop on the machine: current sensors, encoder and the PWM's delay between them.

use crate::machine::{Machine, Params};
use motor::example::EXAMPLE;
use motor::{Config, Inputs, Mode, MotorCommand, Output, Phases, Plan, State, step};

/// Current of one step of the converter \[A\].
pub(crate) const ADC_A: f64 = 3.3 / 4096.0 / (0.5e-3 * 20.0);

/// The loop, the machine and the components between them.
pub(crate) struct Bench {
    pub(crate) plan: Plan,
    pub(crate) state: State,
    pub(crate) machine: Machine,
    /// Duty cycles that act in this period.
    acting: Option<[f32; 3]>,
    /// Zeros of the current sensors, and the standard deviation of their noise \[A\].
    pub(crate) zeros_a: [f64; 3],
    pub(crate) noise_a: f64,
    /// Position of the encoder's zero \[turns of the motor\].
    pub(crate) encoder_zero: f64,
    pub(crate) encoder_reversed: bool,
    /// Part of the motor's motion that reaches the encoder.
    pub(crate) encoder_grip: f64,
    pub(crate) temperature_c: f32,
    random: u64,
    pub(crate) tick: u64,
}

/// Result of one call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record {
    pub(crate) out: Output,
    /// Actual values of the machine.
    pub(crate) torque_nm: f64,
    pub(crate) id_a: f64,
    pub(crate) iq_a: f64,
    pub(crate) largest_phase_a: f64,
}

impl Bench {
    /// At rest, nothing measured yet.
    pub(crate) fn new(config: Config, params: Params) -> Self {
        Self {
            plan: config.plan().expect("a valid configuration"),
            state: State::default(),
            machine: Machine::new(params),
            acting: None,
            zeros_a: [0.9, -1.3, 0.4],
            noise_a: ADC_A,
            encoder_zero: 0.0,
            encoder_reversed: config.encoder.reversed,
            encoder_grip: 1.0,
            temperature_c: 25.0,
            random: 0x9e37_79b9_7f4a_7c15,
            tick: 0,
        }
    }

    /// The example with measured current offsets and an exactly aligned encoder: ready, with the whole torque
    /// permitted at an unconfirmed angle.
    pub(crate) fn ready(change: impl FnOnce(&mut Config)) -> Self {
        Self::started(|config| {
            config.angle.unproved_nm = 100.0;
            change(config);
        })
    }

    /// As [`Bench::ready`], but with the example's confirmation of the angle.
    pub(crate) fn started(change: impl FnOnce(&mut Config)) -> Self {
        let mut config = EXAMPLE;
        config.encoder.offset_turns = Some(0.0);
        change(&mut config);
        let params = Params {
            ratio: if config.motor.reversed { -36.0 } else { 36.0 },
            rate_hz: f64::from(config.rate_hz),
            ..Params::default()
        };
        let mut bench = Self::new(config, params);
        let last = bench.run(usize::from(config.zero.samples) + 1, MotorCommand::Off).pop().expect("a call");
        assert_eq!(last.out.mode, Mode::Ready, "{:?}", last.out);
        bench
    }

    /// A normal deviate, approximately: the sum of twelve uniform ones.
    fn gauss(&mut self) -> f64 {
        let mut even = || {
            self.random ^= self.random << 13;
            self.random ^= self.random >> 7;
            self.random ^= self.random << 17;
            (self.random >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| even()).sum::<f64>() - 6.0
    }

    /// The present sensor values.
    pub(crate) fn inputs(&mut self, command: MotorCommand) -> Inputs {
        let phases = self.machine.phases_a();
        let measured = std::array::from_fn(|x| {
            let raw = phases[x] + self.zeros_a[x] + self.noise_a * self.gauss();
            ((raw / ADC_A).round() * ADC_A).clamp(-165.0, 165.0) as f32
        });
        let counts = f64::from(self.plan.config().encoder.counts);
        let sense = if self.encoder_reversed { -1.0 } else { 1.0 };
        let turns = sense * (self.machine.motor_turns * self.encoder_grip + self.encoder_zero);
        Inputs {
            phases: Phases::Three(measured),
            bus_v: self.machine.bus_v as f32,
            angle_counts: (turns * counts).floor().rem_euclid(counts) as u16,
            angle_age_calls: 0,
            temperature_c: self.temperature_c,
            command,
        }
    }

    /// One call, its inputs changed by `tamper`.
    pub(crate) fn call(&mut self, command: MotorCommand, tamper: impl FnOnce(u64, &mut Inputs)) -> Record {
        let mut inputs = self.inputs(command);
        tamper(self.tick, &mut inputs);
        self.tick += 1;
        let (torque_nm, [id_a, iq_a]) = (self.machine.torque_nm(), self.machine.dq_a());
        let largest_phase_a = self.machine.phases_a().into_iter().fold(0.0, |m: f64, i| m.max(i.abs()));
        let out = step(&self.plan, &mut self.state, &inputs);
        // Opening the bridge does not wait for the next period.
        let acting = if out.duties.is_none() { None } else { self.acting };
        self.machine.advance(acting.map(|d| d.map(f64::from)));
        self.acting = out.duties;
        Record { out, torque_nm, id_a, iq_a, largest_phase_a }
    }

    /// This number of calls.
    pub(crate) fn run(&mut self, calls: usize, command: MotorCommand) -> Vec<Record> {
        self.tampered(calls, command, |_, _| ())
    }

    /// This number of calls, each with its inputs changed; the number of the call counts from 0.
    pub(crate) fn tampered(
        &mut self,
        calls: usize,
        command: MotorCommand,
        tamper: impl Fn(u64, &mut Inputs),
    ) -> Vec<Record> {
        let from = self.tick;
        (0..calls).map(|_| self.call(command, |tick, inputs| tamper(tick - from, inputs))).collect()
    }
}

/// The call, counted from 1, in which the bridge opened.
pub(crate) fn opened(records: &[Record]) -> Option<usize> {
    records.iter().position(|r| r.out.duties.is_none()).map(|i| i + 1)
}

/// The last call of a run.
pub(crate) fn last(records: &[Record]) -> Record {
    *records.last().expect("a call")
}

/// Mean of a value over the records.
pub(crate) fn mean(records: &[Record], of: impl Fn(&Record) -> f64) -> f64 {
    records.iter().map(of).sum::<f64>() / records.len() as f64
}
