//! The controller with the motor's loop and a simulated motor behind it, on the bicycle of `sim-host`.

use crate::machine::{Machine, Params};
use control::{Mode, Plan, Sample, SensorFrame};
use motor::example::EXAMPLE;
use motor::{Faults, Inputs, MotorCommand, Output, Phases};
use sim_host::ride::{Remote, RemoteError, Start, Stepped};
use std::f64::consts::TAU;

/// A slip of the encoder on its shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slip {
    /// Final angle \[electrical degrees\].
    pub(crate) by_deg: f64,
    /// Beginning in the ride \[s\]; before power-on if negative.
    pub(crate) from_s: f64,
    /// Duration \[s\].
    pub(crate) in_s: f64,
}

/// State of the drive of one ride.
struct Drive {
    control: control::State,
    plan: Plan,
    state: motor::State,
    machine: Machine,
    acting: Option<[f32; 3]>,
    out: Output,
    /// Rate of the previous step \[rad/s\].
    before_rad_s: f64,
    /// Calls of the motor's loop since the knock; none before.
    since: Option<u64>,
}

/// Controller, motor's loop and motor; one power-on for each ride.
pub(crate) struct Axle {
    motor: motor::Plan,
    step_s: f64,
    slip: Option<Slip>,
    drive: Option<Drive>,
    /// Seconds after the knock at which the loop latched its faults, and the faults.
    pub(crate) opened: Option<(f64, Faults)>,
    /// Torque against the commanded one while the bridge was closed, times time \[N m s\].
    pub(crate) against_nm_s: f64,
}

impl Axle {
    /// The example's motor with its offset.
    pub(crate) fn new(step_s: f64, slip: Option<Slip>, change: impl FnOnce(&mut motor::Config)) -> Self {
        let mut config = EXAMPLE;
        config.encoder.offset_turns = Some(0.0);
        change(&mut config);
        let motor = config.plan().expect("a valid configuration");
        Self { motor, step_s, slip, drive: None, opened: None, against_nm_s: 0.0 }
    }

    /// Angle of the slip \[turns of the motor\].
    fn slipped_turns(&self, drive: &Drive) -> f64 {
        let Some(slip) = self.slip else { return 0.0 };
        let t = drive.since.map_or(0.0, |calls| calls as f64 / f64::from(self.motor.config().rate_hz));
        let part = if slip.from_s < 0.0 { 1.0 } else { ((t - slip.from_s) / slip.in_s).clamp(0.0, 1.0) };
        part * slip.by_deg / 360.0 / drive.machine.params.pole_pairs
    }

    /// One call of the motor's loop.
    fn call(&mut self, drive: &mut Drive, command: MotorCommand) {
        let counts = f64::from(self.motor.config().encoder.counts);
        let turns = drive.machine.motor_turns + self.slipped_turns(drive);
        let inputs = Inputs {
            phases: Phases::Three(drive.machine.phases_a().map(|i| i as f32)),
            bus_v: drive.machine.bus_v as f32,
            angle_counts: (turns * counts).floor().rem_euclid(counts) as u16,
            angle_age_calls: 0,
            temperature_c: 25.0,
            command,
        };
        drive.out = motor::step(&self.motor, &mut drive.state, &inputs);
        let acting = if drive.out.duties.is_none() { None } else { drive.acting };
        let machine = &mut drive.machine;
        if acting.is_none() && machine.alpha_beta_a == [0.0; 2] {
            // Without current only the angle changes.
            machine.motor_turns +=
                machine.steer_rate_rad_s * machine.params.ratio / TAU / machine.params.rate_hz;
        } else {
            machine.advance(acting.map(|duties| duties.map(f64::from)));
        }
        drive.acting = drive.out.duties;
        if !drive.out.faults.is_empty() && self.opened.is_none() {
            let t = drive.since.map_or(-1.0, |calls| calls as f64 / f64::from(self.motor.config().rate_hz));
            self.opened = Some((t, drive.out.faults));
        }
        drive.since = drive.since.map(|calls| calls + 1);
    }
}

impl Remote for Axle {
    fn begin(&mut self, plan: &Plan, _: &Start) -> Result<(), RemoteError> {
        // An axis of infinite inertia keeps its given rate.
        let params = Params { inertia_kg_m2: f64::INFINITY, coulomb_nm: 0.0, ..Params::default() };
        let mut drive = Drive {
            control: control::State::default(),
            plan: plan.clone(),
            state: motor::State::default(),
            machine: Machine::new(params),
            acting: None,
            out: Output::default(),
            before_rad_s: 0.0,
            since: None,
        };
        (self.opened, self.against_nm_s) = (None, 0.0);
        for _ in 0..=self.motor.config().zero.samples {
            self.call(&mut drive, MotorCommand::Off);
        }
        self.drive = Some(drive);
        Ok(())
    }

    fn disturb(&mut self) {
        if let Some(drive) = &mut self.drive {
            drive.since = Some(0);
        }
    }

    fn step(&mut self, frame: &SensorFrame) -> Result<Stepped, RemoteError> {
        let mut drive = self.drive.take().ok_or(RemoteError("no ride was begun".into()))?;
        let mut measured = *frame;
        measured.motor_torque_nm =
            if drive.out.faults.is_empty() { Sample::fresh(drive.out.torque_nm) } else { Sample::missing() };
        measured.steer_rate_rad_s = Sample::fresh(drive.out.steer_rate_rad_s);
        let mut command = control::step(&drive.plan, &mut drive.control, &measured);

        let rate = f64::from(frame.steer_rate_rad_s.value);
        // The rate expected in the middle of the step; after a knock the present one.
        let fresh = drive.since == Some(0);
        let middle = if fresh { rate } else { rate + 0.5 * (rate - drive.before_rad_s) };
        drive.before_rad_s = rate;
        drive.machine.steer_rate_rad_s = middle;
        drive.machine.motor_turns = f64::from(frame.steer_rad.value) * drive.machine.params.ratio / TAU;

        let expected = command.torque_nm != 0.0 || matches!(command.mode, Mode::Engaged | Mode::Limp);
        let motor_command =
            if expected { MotorCommand::Torque(command.torque_nm) } else { MotorCommand::Off };
        let calls = (self.step_s * f64::from(self.motor.config().rate_hz)).round() as usize;
        let mut sum_nm = 0.0;
        for _ in 0..calls {
            self.call(&mut drive, motor_command);
            sum_nm += drive.machine.torque_nm();
        }
        let mean_nm = sum_nm / calls as f64;
        let against = -mean_nm * f64::from(command.torque_nm).signum();
        self.against_nm_s += against.max(0.0) * self.step_s;
        command.torque_nm = mean_nm as f32;
        let authority = drive.control.authority();
        self.drive = Some(drive);
        Ok(Stepped { command, authority })
    }
}
