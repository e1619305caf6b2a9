//! What the motor's interrupt shares with everything else: orders to it, and its report.
//!
//! It interrupts critical sections, so it is spoken to by atomic words; its report is read whole because the interrupt,
//! which nobody interrupts, raises a number after each one.

use crate::tasks::Refusal;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use motor::command_word;
use motor::{Faults, Mode, MotorCommand};

/// What control asks, by `motor::command_word`, and a number that rises with each order.
static ORDER: AtomicU32 = AtomicU32::new(u32::MAX);
static BEAT: AtomicU32 = AtomicU32::new(0);
/// The bridge stays open: until the next start, and while the flash is at work.
static OFF: AtomicBool = AtomicBool::new(false);
static HOLD: AtomicBool = AtomicBool::new(false);
/// Temperature beside the switches, as bits of an f32 \[deg C\]; control makes it of the counts, as it takes a
/// logarithm.
static HEAT_C: AtomicU32 = AtomicU32::new(f32::NAN.to_bits());

/// What the motor's interrupt says of its last call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Calls since the start, wrapping.
    pub calls: u32,
    /// Calls whose duty cycles were set only after the top that was to take them over, 42.6 us after the interrupt.
    pub late: u32,
    /// What the motor's loop does.
    pub mode: Mode,
    /// Faults that it latched.
    pub faults: Faults,
    /// The gate driver is missing, or told of a fault.
    pub gate_fault: bool,
    /// Pulses of its fault pin that were too short to be one.
    pub gate_pulses: u32,
    /// No order came in time.
    pub silent: bool,
    /// The outputs were switched off until the next start.
    pub off: bool,
    /// Torque by the measured current, to the right \[N m\].
    pub torque_nm: f32,
    /// Current that makes it \[A\].
    pub iq_a: f32,
    /// Speed of the steer by the encoder, to the right \[rad/s\].
    pub steer_rate_rad_s: f32,
    /// The encoder's offset in use.
    pub offset_turns: Option<f32>,
    /// The alignment that is asked for is over and found it.
    pub aligned: bool,
    /// The encoder's counts.
    pub encoder_counts: u16,
    /// Their age \[calls\].
    pub encoder_age: u16,
    /// Answers of the encoder with its error flag, and damaged ones.
    pub encoder_flagged: u32,
    /// As of [`Report::encoder_flagged`].
    pub encoder_damaged: u32,
    /// The supply \[V\].
    pub supply_v: f32,
    /// The steer sensor \[counts\].
    pub steer: u16,
    /// The rider's torque sensor \[counts\].
    pub rider_torque: u16,
    /// The rider's switch \[counts\].
    pub switch: u16,
    /// The thermistor beside the switches of the bridge \[counts\].
    pub board_heat: u16,
}

impl Report {
    /// Before the first call.
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
        board_heat: 0,
    };

    /// Why no torque is given, if so.
    pub fn refusal(&self) -> Option<Refusal> {
        match self.mode {
            Mode::Off => self.faults.iter().next().map(|fault| Refusal::MotorFault(fault.code())),
            _ if self.gate_fault => Some(Refusal::GateDriver),
            _ if self.off => Some(Refusal::OutputsOff),
            Mode::Zeroing => Some(Refusal::NotReady),
            Mode::Unaligned | Mode::Aligning => Some(Refusal::NotAligned),
            Mode::Ready | Mode::Running => self.silent.then_some(Refusal::Stale),
        }
    }
}

struct SharedReport(UnsafeCell<Report>);

// SAFETY: only the motor's interrupt writes it, and nobody interrupts that; a copy that it cut in two is thrown away.
unsafe impl Sync for SharedReport {}

static TOLD: SharedReport = SharedReport(UnsafeCell::new(Report::NONE));
/// Reports so far, wrapping.
static REPORTS: AtomicU32 = AtomicU32::new(0);

/// What the motor's interrupt said last. Read anew where it spoke meanwhile, which it does every 50 us.
pub fn report() -> Report {
    loop {
        let before = REPORTS.load(Ordering::Acquire);
        // SAFETY: the cell lives for ever; every bit pattern that a torn copy can have is made of whole fields.
        let report = unsafe { TOLD.0.get().read_volatile() };
        if REPORTS.load(Ordering::Acquire) == before {
            return report;
        }
    }
}

/// The interrupt's own side of [`report`].
pub(super) fn tell(report: Report) {
    // SAFETY: only the motor's interrupt calls this, and readers do not interrupt it.
    unsafe { TOLD.0.get().write_volatile(report) }
    REPORTS.store(report.calls, Ordering::Release);
}

/// Asks the motor for something, until the patience of its interrupt is over or another order comes.
pub fn order(command: MotorCommand) {
    ORDER.store(command_word::word(command), Ordering::Relaxed);
    BEAT.store(BEAT.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
}

/// The newest order, and its number.
pub(super) fn ordered() -> (u32, MotorCommand) {
    let beat = BEAT.load(Ordering::Acquire);
    (beat, command_word::command(ORDER.load(Ordering::Relaxed)))
}

/// Tells how hot it is beside the switches of the bridge \[deg C\].
pub(super) fn set_heat(celsius: f32) {
    HEAT_C.store(celsius.to_bits(), Ordering::Relaxed);
}

/// How hot it is there \[deg C\]; NaN before it was told, and where the sensor is cut or shorted.
pub(super) fn heat_c() -> f32 {
    f32::from_bits(HEAT_C.load(Ordering::Relaxed))
}

/// Keeps the bridge open until the next start.
pub(super) fn set_off() {
    // What the caller does next to the registers comes after this.
    OFF.store(true, Ordering::SeqCst);
}

/// Whether it is kept open until the next start.
pub(super) fn is_off() -> bool {
    OFF.load(Ordering::Relaxed)
}

/// Keeps the bridge open, or no longer.
pub(super) fn set_hold(hold: bool) {
    HOLD.store(hold, Ordering::SeqCst);
}

/// Whether it is kept open for a while.
pub(super) fn is_held() -> bool {
    HOLD.load(Ordering::Relaxed)
}
