//! Motor interrupt: samples in, one call of the motor loop, duty cycles out, 20 000 times per second.

use super::shared::{Report, is_held, is_off, newest_command, publish, set_off, temperature_c};
use super::soft_spi::SoftSpi;
use super::{adc, outputs_off, pwm};
use core::cell::UnsafeCell;
use devices::as5047::{Line, READ_ANGLE};
use devices::fault_pin::FaultPin;
use devices::vesc6::{COMMAND_TIMEOUT_CALLS, SHUNT, SUPPLY};
use embassy_stm32::gpio::Input;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use motor::command_word::Deadline;
use motor::{Inputs, MotorCommand, Output, Phases, Plan, State};

/// State of the interrupt.
struct Loop {
    plan: Plan,
    state: State,
    deadline: Deadline,
    encoder: SoftSpi,
    line: Line,
    gate_fault: Input<'static>,
    gate_pin: FaultPin,
    /// Report of the last call; that of the present call starts from it.
    report: Report,
    bridge: Bridge,
}

/// State of the bridge after the last call.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Bridge {
    /// All six switches open.
    Open,
    /// Still open; the timer loads the first duty cycles.
    Loaded,
    /// Switched by the duty cycles.
    Closed,
}

struct Cell(UnsafeCell<Option<Loop>>);

// SAFETY: written once by `start`, before the interrupt is enabled; afterwards only the interrupt uses it, and it
// does not preempt itself.
unsafe impl Sync for Cell {}

static LOOP: Cell = Cell(UnsafeCell::new(None));

/// Starts the loop; ADCs and timer must run. `driver`: whether the gate driver works. Call once.
pub(super) fn start(plan: Plan, driver: bool, encoder: SoftSpi, gate_fault: Input<'static>) {
    let motor = Loop {
        plan,
        state: State::default(),
        deadline: Deadline::default(),
        encoder,
        line: Line::default(),
        gate_fault,
        gate_pin: FaultPin::default(),
        report: Report { gate_fault: !driver, ..Report::NONE },
        bridge: Bridge::Open,
    };
    // SAFETY: the interrupt is not enabled yet, so the cell has no other user.
    unsafe { *LOOP.0.get() = Some(motor) }
    adc::clear_pending();
    interrupt::ADC.unpend();
    // SAFETY: the interrupt enters no critical section, so it can preempt them.
    unsafe { interrupt::ADC.enable() }
}

#[interrupt]
fn ADC() {
    // SAFETY: only this interrupt uses the cell once it runs.
    if let Some(motor) = unsafe { &mut *LOOP.0.get() } {
        motor.call();
    }
}

impl Loop {
    fn call(&mut self) {
        pwm::begin();
        let counts = adc::counts();
        self.request_angle();
        if self.gate_pin.step(self.gate_fault.is_low()) {
            self.report.gate_fault = true;
            // The driver has opened the switches itself; it stays enabled until its status is read.
            set_off();
        }
        let (count, requested) = newest_command();
        let command = self.deadline.step(count, requested, COMMAND_TIMEOUT_CALLS);
        let supply_v = SUPPLY.volt(counts.supply);
        let inputs = Inputs {
            phases: Phases::Three(counts.phases.map(|phase| SHUNT.ampere(phase))),
            bus_v: supply_v,
            angle_counts: self.report.encoder_counts,
            angle_age_calls: self.report.encoder_age,
            temperature_c: temperature_c(),
            command: if is_off() || is_held() { MotorCommand::Off } else { command },
        };
        let out = motor::step(&self.plan, &mut self.state, &inputs);
        self.switch(&out);
        let late = pwm::period_elapsed() || adc::next_conversion_ended();
        self.report = Report {
            calls: self.report.calls.wrapping_add(1),
            late: self.report.late.wrapping_add(u32::from(late)),
            mode: out.mode,
            faults: out.faults,
            gate_pulses: self.gate_pin.pulses,
            encoder_flagged: self.line.flagged,
            encoder_damaged: self.line.damaged,
            silent: self.deadline.is_over(COMMAND_TIMEOUT_CALLS),
            off: is_off(),
            torque_nm: out.torque_nm,
            iq_a: out.iq_a,
            steer_rate_rad_s: out.steer_rate_rad_s,
            offset_turns: out.offset_turns,
            aligned: out.aligned,
            supply_v,
            steer: counts.steer,
            rider_torque: counts.rider_torque,
            switch: counts.switch,
            board_temperature: counts.board_temperature,
            ..self.report
        };
        publish(self.report);
    }

    /// The answer to the last transfer is the angle at its time, one call ago.
    fn request_angle(&mut self) {
        let report = &mut self.report;
        match self.line.step(self.encoder.word(READ_ANGLE)) {
            Some(counts) => (report.encoder_counts, report.encoder_age) = (counts, 1),
            None => report.encoder_age = report.encoder_age.saturating_add(1),
        }
    }

    /// Sets the bridge. It is closed once: a later break stays in effect.
    fn switch(&mut self, out: &Output) {
        let Some(duties) = out.duties else {
            pwm::open();
            self.bridge = Bridge::Open;
            return;
        };
        pwm::duties(duties);
        self.bridge = match self.bridge {
            Bridge::Open => Bridge::Loaded,
            Bridge::Loaded => {
                pwm::close();
                Bridge::Closed
            }
            Bridge::Closed => {
                if !pwm::is_closed() {
                    outputs_off();
                }
                Bridge::Closed
            }
        };
    }
}
