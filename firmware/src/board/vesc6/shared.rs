//! Data shared with the motor interrupt: commands to it, and its report.
//!
//! The interrupt preempts critical sections, so commands are atomic words. The interrupt itself is not preempted and
//! increments a sequence number after each report, so that readers detect a torn copy.

use crate::telemetry::DriveError;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use motor::command_word;
use motor::{Faults, Mode, MotorCommand};

/// Command of control, encoded by `motor::command_word`, and a number that increments with each command.
static COMMAND: AtomicU32 = AtomicU32::new(u32::MAX);
static COMMAND_COUNT: AtomicU32 = AtomicU32::new(0);
/// Keeps the bridge open: until the next start, and during flash access.
static OFF: AtomicBool = AtomicBool::new(false);
static HOLD: AtomicBool = AtomicBool::new(false);
/// Temperature beside the switches, as bits of an f32 \[deg C\]; computed by control, as it needs a logarithm.
static TEMPERATURE_C: AtomicU32 = AtomicU32::new(f32::NAN.to_bits());

/// Report of the motor interrupt's last call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Number of calls since the start, wrapping.
    pub calls: u32,
    /// Number of calls whose duty cycles missed the top that loads them, 42.6 us after the interrupt.
    pub late: u32,
    /// Mode of the motor loop.
    pub mode: Mode,
    /// Latched faults.
    pub faults: Faults,
    /// Whether the gate driver is missing or reported a fault.
    pub gate_fault: bool,
    /// Number of fault-pin pulses too short to be a fault.
    pub gate_pulses: u32,
    /// Whether the command timed out.
    pub silent: bool,
    /// Whether the outputs were switched off until the next start.
    pub off: bool,
    /// Torque from the measured current, positive to the right \[N m\].
    pub torque_nm: f32,
    /// Torque-producing q current \[A\].
    pub iq_a: f32,
    /// Steer rate from the encoder, positive to the right \[rad/s\].
    pub steer_rate_rad_s: f32,
    /// Encoder offset in use.
    pub offset_turns: Option<f32>,
    /// Whether the requested alignment has found the offset.
    pub aligned: bool,
    /// Encoder counts.
    pub encoder_counts: u16,
    /// Age of the counts \[calls\].
    pub encoder_age: u16,
    /// Number of encoder answers with the error flag.
    pub encoder_flagged: u32,
    /// Number of damaged encoder answers.
    pub encoder_damaged: u32,
    /// Supply voltage \[V\].
    pub supply_v: f32,
    /// Steer sensor \[counts\].
    pub steer: u16,
    /// Rider's torque sensor \[counts\].
    pub rider_torque: u16,
    /// Rider's switch \[counts\].
    pub switch: u16,
    /// Thermistor beside the bridge's switches \[counts\].
    pub board_temperature: u16,
}

impl Report {
    /// Report before the first call.
    pub(super) const NONE: Self = Self {
        calls: 0,
        late: 0,
        mode: Mode::Zeroing,
        faults: Faults::NONE,
        gate_fault: false,
        gate_pulses: 0,
        silent: true,
        off: false,
        torque_nm: 0.0,
        iq_a: 0.0,
        steer_rate_rad_s: 0.0,
        offset_turns: None,
        aligned: false,
        encoder_counts: 0,
        encoder_age: u16::MAX,
        encoder_flagged: 0,
        encoder_damaged: 0,
        supply_v: 0.0,
        steer: 0,
        rider_torque: 0,
        switch: 0,
        board_temperature: 0,
    };

    /// Reason for which no torque is given, if any.
    pub fn error(&self) -> Option<DriveError> {
        match self.mode {
            Mode::Off => self.faults.iter().next().map(|fault| DriveError::MotorFault(fault.code())),
            _ if self.gate_fault => Some(DriveError::GateDriver),
            _ if self.off => Some(DriveError::OutputsOff),
            Mode::Zeroing => Some(DriveError::NotReady),
            Mode::Unaligned | Mode::Aligning => Some(DriveError::NotAligned),
            Mode::Ready | Mode::Running => self.silent.then_some(DriveError::Stale),
        }
    }
}

struct SharedReport(UnsafeCell<Report>);

// SAFETY: only the motor interrupt writes it, and nothing preempts that; a torn copy is discarded.
unsafe impl Sync for SharedReport {}

static REPORT: SharedReport = SharedReport(UnsafeCell::new(Report::NONE));
/// Number of reports, wrapping.
static REPORTS: AtomicU32 = AtomicU32::new(0);

/// Last report of the motor interrupt. Repeats the copy if a report came meanwhile; reports are 50 us apart.
pub fn report() -> Report {
    loop {
        let before = REPORTS.load(Ordering::Acquire);
        // SAFETY: the cell is static; every bit pattern of a torn copy consists of whole fields.
        let report = unsafe { REPORT.0.get().read_volatile() };
        if REPORTS.load(Ordering::Acquire) == before {
            return report;
        }
    }
}

/// Writes the report read by [`report`].
pub(super) fn publish(report: Report) {
    // SAFETY: only the motor interrupt calls this, and readers do not preempt it.
    unsafe { REPORT.0.get().write_volatile(report) }
    REPORTS.store(report.calls, Ordering::Release);
}

/// Sends a command to the motor, valid until the next command or the timeout.
pub fn set_command(command: MotorCommand) {
    COMMAND.store(command_word::word(command), Ordering::Relaxed);
    COMMAND_COUNT.store(COMMAND_COUNT.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
}

/// The newest command and its number.
pub(super) fn newest_command() -> (u32, MotorCommand) {
    let count = COMMAND_COUNT.load(Ordering::Acquire);
    (count, command_word::command(COMMAND.load(Ordering::Relaxed)))
}

/// Stores the temperature beside the bridge's switches \[deg C\].
pub(super) fn set_temperature(celsius: f32) {
    TEMPERATURE_C.store(celsius.to_bits(), Ordering::Relaxed);
}

/// Temperature beside the bridge's switches \[deg C\]; NaN before the first value, and if the sensor is open or
/// shorted.
pub(super) fn temperature_c() -> f32 {
    f32::from_bits(TEMPERATURE_C.load(Ordering::Relaxed))
}

/// Keeps the bridge open until the next start.
pub(super) fn set_off() {
    // The caller's next register writes must come after this.
    OFF.store(true, Ordering::SeqCst);
}

/// Whether the bridge is kept open until the next start.
pub(super) fn is_off() -> bool {
    OFF.load(Ordering::Relaxed)
}

/// Keeps the bridge open temporarily, or releases it; returns whether it was kept open before.
pub(super) fn set_hold(hold: bool) -> bool {
    HOLD.swap(hold, Ordering::SeqCst)
}

/// Whether the bridge is temporarily kept open.
pub(super) fn is_held() -> bool {
    HOLD.load(Ordering::Relaxed)
}
