//! What control asks of the motor's interrupt: one word, so that it is never seen half changed, and a deadline.

use crate::MotorCommand;

/// Words that are no torque; both are NaN, which no torque is.
const OFF: u32 = 0xffff_ffff;
const ALIGN: u32 = 0xffff_fffe;

/// The word of what is asked. A torque that is NaN becomes another NaN, which the motor's loop refuses as such.
pub fn word(command: MotorCommand) -> u32 {
    match command {
        MotorCommand::Off => OFF,
        MotorCommand::Align => ALIGN,
        MotorCommand::Torque(nm) if nm.is_nan() => f32::NAN.to_bits(),
        MotorCommand::Torque(nm) => nm.to_bits(),
    }
}

/// What a word asks.
pub fn command(word: u32) -> MotorCommand {
    match word {
        OFF => MotorCommand::Off,
        ALIGN => MotorCommand::Align,
        torque => MotorCommand::Torque(f32::from_bits(torque)),
    }
}

/// The motor's side of it: how long control has been silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deadline {
    beat: u32,
    silent_calls: u16,
}

impl Default for Deadline {
    /// Nothing was ever asked.
    fn default() -> Self {
        Self { beat: 0, silent_calls: u16::MAX }
    }
}

impl Deadline {
    /// One call of the motor's interrupt: what is to be done now, `asked` while the number `beat` that control raises
    /// with each order has changed within `timeout_calls`, nothing after.
    pub fn step(&mut self, beat: u32, asked: MotorCommand, timeout_calls: u16) -> MotorCommand {
        self.silent_calls = if beat == self.beat { self.silent_calls.saturating_add(1) } else { 0 };
        self.beat = beat;
        if self.is_over(timeout_calls) { MotorCommand::Off } else { asked }
    }

    /// Whether control is silent for too long, or has said nothing yet.
    pub fn is_over(&self, timeout_calls: u16) -> bool {
        self.silent_calls > timeout_calls
    }
}
