//! The motor's interrupt: samples in, one call of the motor's loop, duty cycles out, 20 000 times a second.
//!
//! It shares atomic words with everything else and never waits, so it may interrupt critical sections.

use super::soft_spi::SoftSpi;
use super::{adc, pwm};
use crate::tasks::Refusal;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU16, AtomicU32, Ordering::Relaxed};
use embassy_stm32::gpio::Input;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use motor::{Ask, Faults, Inputs, Mode, Output, Phases, Plan, State};
use parts::as5047::{ASK_ANGLE, angle_counts};
use parts::order::{self, Deadline};
use parts::vesc6::{PATIENCE_CALLS, SHUNT, SUPPLY};

/// What control asks, by `parts::order`, and a number that rises with each order.
static ORDER: AtomicU32 = AtomicU32::new(u32::MAX);
static BEAT: AtomicU32 = AtomicU32::new(0);
/// The bridge stays open: until the next start, and while the flash is at work.
static OFF: AtomicBool = AtomicBool::new(false);
static HOLD: AtomicBool = AtomicBool::new(false);
/// The gate driver told of a fault.
static GATE_FAULT: AtomicBool = AtomicBool::new(false);
/// Control was silent in the last call.
static SILENT: AtomicBool = AtomicBool::new(true);
/// Temperature beside the switches, as bits of an f32 \[deg C\]; made of the counts by control, as it takes a logarithm.
static HEAT_C: AtomicU32 = AtomicU32::new(f32::NAN.to_bits());
/// What the interrupt says, each by itself.
static TOLD: Told = Told::new();

struct Told {
    calls: AtomicU32,
    late: AtomicU32,
    mode: AtomicU32,
    faults: AtomicU32,
    torque_nm: AtomicU32,
    iq_a: AtomicU32,
    steer_rate_rad_s: AtomicU32,
    offset_turns: AtomicU32,
    encoder_counts: AtomicU16,
    encoder_age: AtomicU16,
    supply_v: AtomicU32,
    steer: AtomicU16,
    rider_torque: AtomicU16,
    switch: AtomicU16,
    board_heat: AtomicU16,
}

impl Told {
    const fn new() -> Self {
        const WORD: AtomicU32 = AtomicU32::new(0);
        const HALF: AtomicU16 = AtomicU16::new(0);
        Self {
            calls: WORD,
            late: WORD,
            mode: WORD,
            faults: WORD,
            torque_nm: WORD,
            iq_a: WORD,
            steer_rate_rad_s: WORD,
            offset_turns: AtomicU32::new(f32::NAN.to_bits()),
            encoder_counts: HALF,
            encoder_age: AtomicU16::new(u16::MAX),
            supply_v: WORD,
            steer: HALF,
            rider_torque: HALF,
            switch: HALF,
            board_heat: HALF,
        }
    }
}

/// What the interrupt says of its last call.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// Calls since the start, wrapping.
    pub calls: u32,
    /// Calls that ended after the next samples were there.
    pub late: u32,
    /// Mode of the loop, by its number in `motor::Mode`.
    pub mode: u32,
    /// Faults that it latched.
    pub faults: Faults,
    /// Torque by the measured current, to the right \[N m\].
    pub torque_nm: f32,
    /// Current that makes it \[A\].
    pub iq_a: f32,
    /// Speed of the steer by the encoder, to the right \[rad/s\].
    pub steer_rate_rad_s: f32,
    /// The encoder's offset in use, to be written down as `encoder.offset_turns`; NaN while it is not known.
    pub offset_turns: f32,
    /// The encoder's counts.
    pub encoder_counts: u16,
    /// Their age \[calls\].
    pub encoder_age: u16,
    /// The supply \[V\].
    pub supply_v: f32,
    /// What hangs on the converters beside \[counts\].
    pub steer: u16,
    /// The rider's torque sensor \[counts\].
    pub rider_torque: u16,
    /// The rider's switch \[counts\].
    pub switch: u16,
    /// The thermistor beside the switches \[counts\].
    pub board_heat: u16,
    /// The same \[deg C\]; NaN where it is cut or shorted, and before control looked at it.
    pub board_c: f32,
}

/// What the interrupt says of its last call.
pub fn report() -> Report {
    let float = |word: &AtomicU32| f32::from_bits(word.load(Relaxed));
    Report {
        calls: TOLD.calls.load(Relaxed),
        late: TOLD.late.load(Relaxed),
        mode: TOLD.mode.load(Relaxed),
        faults: Faults(TOLD.faults.load(Relaxed)),
        torque_nm: float(&TOLD.torque_nm),
        iq_a: float(&TOLD.iq_a),
        steer_rate_rad_s: float(&TOLD.steer_rate_rad_s),
        offset_turns: float(&TOLD.offset_turns),
        encoder_counts: TOLD.encoder_counts.load(Relaxed),
        encoder_age: TOLD.encoder_age.load(Relaxed),
        supply_v: float(&TOLD.supply_v),
        steer: TOLD.steer.load(Relaxed),
        rider_torque: TOLD.rider_torque.load(Relaxed),
        switch: TOLD.switch.load(Relaxed),
        board_heat: TOLD.board_heat.load(Relaxed),
        board_c: float(&HEAT_C),
    }
}

/// Asks for something, until [`PATIENCE_CALLS`] have passed without another order.
pub fn order(ask: Ask) {
    ORDER.store(order::word(ask), Relaxed);
    BEAT.store(BEAT.load(Relaxed).wrapping_add(1), Relaxed);
}

/// Tells how hot it is beside the switches \[deg C\].
pub(super) fn heat(celsius: f32) {
    HEAT_C.store(celsius.to_bits(), Relaxed);
}

/// Keeps the bridge open, from now on until it is lifted.
pub(super) fn hold_open(hold: bool) {
    HOLD.store(hold, Relaxed);
    if hold {
        pwm::open();
    }
}

/// Keeps the bridge open until the next start; registers are the caller's.
pub(super) fn off() {
    OFF.store(true, Relaxed);
}

/// Why no torque is given by the last call, if so.
pub fn refusal() -> Option<Refusal> {
    let report = report();
    let fault = report.faults.iter().next();
    let is = |mode: Mode| report.mode == mode as u32;
    match fault {
        Some(fault) => Some(Refusal::MotorFault(fault.code())),
        None if GATE_FAULT.load(Relaxed) => Some(Refusal::GateDriver),
        None if OFF.load(Relaxed) => Some(Refusal::OutputsOff),
        None if SILENT.load(Relaxed) => Some(Refusal::Stale),
        None if is(Mode::Unaligned) || is(Mode::Aligning) => Some(Refusal::NotAligned),
        None if is(Mode::Zeroing) => Some(Refusal::NotReady),
        None => None,
    }
}

/// What the interrupt alone knows.
struct Loop {
    plan: Plan,
    state: State,
    deadline: Deadline,
    encoder: SoftSpi,
    encoder_counts: u16,
    /// Age of the counts \[calls\].
    encoder_age: u16,
    gate_fault: Input<'static>,
    /// Whether the last call had duty cycles, so that the timer has taken them by now.
    had_duties: bool,
}

struct Cell(UnsafeCell<Option<Loop>>);

// SAFETY: written once by `start`, before the interrupt is let through; from then on only the interrupt touches it, and
// it does not interrupt itself.
unsafe impl Sync for Cell {}

static LOOP: Cell = Cell(UnsafeCell::new(None));

/// Starts the loop; the converters and the timer must run. `driver` tells whether the gate driver is there and well. To be
/// called once.
pub(super) fn start(plan: Plan, driver: bool, encoder: SoftSpi, gate_fault: Input<'static>) {
    GATE_FAULT.store(!driver, Relaxed);
    let motor = Loop {
        plan,
        state: State::default(),
        deadline: Deadline::default(),
        encoder,
        encoder_counts: 0,
        encoder_age: u16::MAX,
        gate_fault,
        had_duties: false,
    };
    // SAFETY: the interrupt is not let through yet, so nobody else has the cell.
    unsafe { *LOOP.0.get() = Some(motor) }
    interrupt::ADC.unpend();
    // SAFETY: the interrupt enters no critical section, so it may interrupt those of others.
    unsafe { interrupt::ADC.enable() }
}

#[interrupt]
fn ADC() {
    // SAFETY: only this interrupt has the cell once it runs.
    if let Some(motor) = unsafe { &mut *LOOP.0.get() } {
        motor.call();
    }
}

impl Loop {
    fn call(&mut self) {
        let counts = adc::counts();
        self.ask_encoder();
        if self.gate_fault.is_low() {
            GATE_FAULT.store(true, Relaxed);
            super::outputs_off();
        }
        let asked = order::ask(ORDER.load(Relaxed));
        let ask = self.deadline.step(BEAT.load(Relaxed), asked, PATIENCE_CALLS);
        let supply_v = SUPPLY.volt(counts.supply);
        let kept_open = OFF.load(Relaxed) || HOLD.load(Relaxed);
        let inputs = Inputs {
            phases: Phases::Three(counts.phases.map(|phase| SHUNT.ampere(phase))),
            bus_v: supply_v,
            angle_counts: self.encoder_counts,
            angle_age_ticks: self.encoder_age,
            temperature_c: f32::from_bits(HEAT_C.load(Relaxed)),
            ask: if kept_open { Ask::Off } else { ask },
        };
        let out = motor::step(&self.plan, &mut self.state, &inputs);
        self.switch(&out);

        TOLD.mode.store(out.mode as u32, Relaxed);
        TOLD.faults.store(out.faults.0, Relaxed);
        TOLD.torque_nm.store(out.torque_nm.to_bits(), Relaxed);
        TOLD.iq_a.store(out.iq_a.to_bits(), Relaxed);
        TOLD.steer_rate_rad_s.store(out.steer_rate_rad_s.to_bits(), Relaxed);
        TOLD.offset_turns.store(out.offset_turns.unwrap_or(f32::NAN).to_bits(), Relaxed);
        TOLD.encoder_counts.store(self.encoder_counts, Relaxed);
        TOLD.encoder_age.store(self.encoder_age, Relaxed);
        TOLD.supply_v.store(supply_v.to_bits(), Relaxed);
        TOLD.steer.store(counts.steer, Relaxed);
        TOLD.rider_torque.store(counts.rider_torque, Relaxed);
        TOLD.switch.store(counts.switch, Relaxed);
        TOLD.board_heat.store(counts.board_heat, Relaxed);
        SILENT.store(self.deadline.is_over(PATIENCE_CALLS), Relaxed);
        TOLD.late.store(TOLD.late.load(Relaxed).wrapping_add(u32::from(adc::again())), Relaxed);
        TOLD.calls.store(TOLD.calls.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// The answer to the last transfer is the angle at its time, one call ago.
    fn ask_encoder(&mut self) {
        match angle_counts(self.encoder.word(ASK_ANGLE)) {
            Some(counts) => (self.encoder_counts, self.encoder_age) = (counts, 1),
            None => self.encoder_age = self.encoder_age.saturating_add(1),
        }
    }

    /// Moves the bridge. It closes in the call after the first duty cycles, when the timer has taken them.
    fn switch(&mut self, out: &Output) {
        match out.duties {
            Some(duties) => {
                pwm::duties(duties);
                // Not closed although it was told to: a break in hardware.
                if self.had_duties && !pwm::close() {
                    super::outputs_off();
                }
                self.had_duties = true;
            }
            None => {
                pwm::open();
                self.had_duties = false;
            }
        }
    }
}
