//! The command from the control task to the motor interrupt: one word, so that it is read atomically, and a deadline.

use crate::MotorCommand;

/// Words of commands other than torque; both are NaN patterns, which no torque uses.
const OFF: u32 = 0xffff_ffff;
const ALIGN: u32 = 0xffff_fffe;

/// Encodes a command. A NaN torque becomes another NaN pattern, which the motor loop rejects as an invalid command.
pub fn word(command: MotorCommand) -> u32 {
    match command {
        MotorCommand::Off => OFF,
        MotorCommand::Align => ALIGN,
        MotorCommand::Torque(nm) if nm.is_nan() => f32::NAN.to_bits(),
        MotorCommand::Torque(nm) => nm.to_bits(),
    }
}

/// Decodes a command.
pub fn command(word: u32) -> MotorCommand {
    match word {
        OFF => MotorCommand::Off,
        ALIGN => MotorCommand::Align,
        torque => MotorCommand::Torque(f32::from_bits(torque)),
    }
}

/// Timeout of the command, on the motor's side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deadline {
    count: u32,
    silent_calls: u16,
}

impl Default for Deadline {
    /// No command received yet.
    fn default() -> Self {
        Self { count: 0, silent_calls: u16::MAX }
    }
}

impl Deadline {
    /// One call of the motor interrupt: returns `command` if the number `count`, which control increments with each
    /// command, has changed within `timeout_calls`, else [`MotorCommand::Off`].
    pub fn step(&mut self, count: u32, command: MotorCommand, timeout_calls: u16) -> MotorCommand {
        self.silent_calls = if count == self.count { self.silent_calls.saturating_add(1) } else { 0 };
        self.count = count;
        if self.is_over(timeout_calls) { MotorCommand::Off } else { command }
    }

    /// Whether no command was received for longer than the timeout, or none at all.
    pub fn is_over(&self, timeout_calls: u16) -> bool {
        self.silent_calls > timeout_calls
    }
}
