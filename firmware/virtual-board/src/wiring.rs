//! Wiring: the chip's peripherals on one side, the devices of board and bicycle on the other.
//!
//! One struct holds both, so that a write to a port reaches the connected device and a conversion reads the present
//! current. The bus of `rigless` calls one device per instance; [`AsPort`], [`AsTim1`] and [`AsAdc`] are views of
//! this struct.

use crate::analog::Analog;
use crate::chip::adc::Adc;
use crate::chip::can::Can;
use crate::chip::exti::Exti;
use crate::chip::gpio::{Mode, Port};
use crate::chip::tim1::Tim1;
use crate::load::Calls;
use crate::parts::as5047::As5047;
use crate::parts::bmi160::Bmi160;
use crate::parts::drv8301::Drv8301;
use crate::power::PowerStage;
use bytemuck::TransparentWrapper;
use rigless::time::VirtualNanos;

const A: usize = 0;
const B: usize = 1;
const C: usize = 2;

/// Peripherals and devices around those of the library.
#[derive(Debug)]
pub struct Wiring {
    /// Ports A to D.
    pub ports: [Port; 4],
    /// The timer of the bridge.
    pub tim1: Tim1,
    /// The converters.
    pub adc: [Adc; 3],
    /// The CAN controller and its bus.
    pub can: Can,
    /// The external interrupt controller.
    pub exti: Exti,
    /// The gate driver.
    pub gate_driver: Drv8301,
    /// The IMU.
    pub imu: Bmi160,
    /// The encoder on the motor's shaft.
    pub encoder: As5047,
    /// Bridge, motor and steer axis.
    pub power: PowerStage,
    /// Analog inputs other than the currents.
    pub analog: Analog,
    /// Duration of the motor interrupt.
    pub calls: Calls,
    /// Changes of the main output enable: time \[ns\] and new state.
    pub main_output: Vec<(u64, bool)>,
    /// Whether a debugger's halt switched the outputs off.
    halted_output: bool,
}

/// The wiring as the device behind a port.
#[derive(Debug, TransparentWrapper)]
#[repr(transparent)]
pub struct AsPort<const N: usize>(Wiring);

/// The wiring as the device behind TIM1.
#[derive(Debug, TransparentWrapper)]
#[repr(transparent)]
pub struct AsTim1(Wiring);

/// The wiring as the device behind a converter.
#[derive(Debug, TransparentWrapper)]
#[repr(transparent)]
pub struct AsAdc<const N: usize>(Wiring);

/// The wiring as the device behind CAN1.
#[derive(Debug, TransparentWrapper)]
#[repr(transparent)]
pub struct AsCan(Wiring);

/// The wiring as the device behind EXTI.
#[derive(Debug, TransparentWrapper)]
#[repr(transparent)]
pub struct AsExti(Wiring);

impl Wiring {
    /// State after reset, with only the board's own devices connected.
    pub fn new() -> Self {
        Self {
            ports: [0, 1, 2, 3].map(Port::new),
            tim1: Tim1::default(),
            adc: [Adc::default(); 3],
            can: Can::default(),
            exti: Exti::default(),
            gate_driver: Drv8301::new(),
            imu: Bmi160::new(),
            encoder: As5047::new(),
            power: PowerStage::new(),
            analog: Analog::default(),
            calls: Calls::default(),
            main_output: Vec::new(),
            halted_output: false,
        }
    }

    pub(crate) fn of_port<const N: usize>(port: &mut AsPort<N>) -> &mut Self {
        AsPort::peel_mut(port)
    }

    pub(crate) fn of_tim1(tim1: &mut AsTim1) -> &mut Self {
        AsTim1::peel_mut(tim1)
    }

    pub(crate) fn of_adc<const N: usize>(adc: &mut AsAdc<N>) -> &mut Self {
        AsAdc::peel_mut(adc)
    }

    pub(crate) fn of_can(can: &mut AsCan) -> &mut Self {
        AsCan::peel_mut(can)
    }

    pub(crate) fn of_exti(exti: &mut AsExti) -> &mut Self {
        AsExti::peel_mut(exti)
    }

    /// Resets the chip; the devices keep their state.
    pub fn reset(&mut self, at: VirtualNanos) {
        self.advance(at.0);
        let before = self.tim1.main_output();
        self.ports = [0, 1, 2, 3].map(Port::new);
        self.tim1 = Tim1::default();
        self.adc = [Adc::default(); 3];
        self.can.reset();
        self.exti = Exti::default();
        self.note_main_output(before, at.0);
        (0..4).for_each(|port| self.pins_changed(port, 0xffff, at));
    }

    /// Advances bridge, motor and steer axis to a time, with the duty cycles active until then.
    pub fn advance(&mut self, now_ns: u64) {
        while let Some(end_ns) = self.tim1.next_ramp_end_ns().filter(|end| *end <= now_ns) {
            self.power.advance(end_ns, self.duties(), self.tim1.dead_time_s());
            self.tim1.end_ramp();
        }
        self.power.advance(now_ns, self.duties(), self.tim1.dead_time_s());
    }

    /// Duty cycles at the motor: the timer's, unless the gate driver holds all switches open or the pins have another
    /// function.
    pub fn duties(&self) -> Option<[f64; 3]> {
        const PINS: [(usize, u8); 6] = [(A, 8), (A, 9), (A, 10), (B, 13), (B, 14), (B, 15)];
        let connected = PINS.iter().all(|(port, pin)| self.ports[*port].mode(*pin) == Mode::Alternate(1));
        self.tim1.duties().filter(|_| connected && self.gate_driver.drives())
    }

    /// Handles a debugger's halt: if its bit is set, TIM1's outputs go off (17.3.21).
    pub(crate) fn halt(&mut self, stops_tim1: bool, now_ns: u64) {
        self.advance(now_ns);
        let before = self.tim1.main_output();
        self.halted_output = before && stops_tim1;
        if stops_tim1 {
            self.tim1.freeze_outputs();
        }
        self.note_main_output(before, now_ns);
    }

    /// Handles the end of the halt: the outputs return.
    pub(crate) fn go_on(&mut self, now_ns: u64) {
        self.advance(now_ns);
        let before = self.tim1.main_output();
        if std::mem::take(&mut self.halted_output) {
            self.tim1.release_outputs();
        }
        self.note_main_output(before, now_ns);
    }

    /// Records a change of the main output enable; call with the state before the possible change.
    pub(crate) fn note_main_output(&mut self, before: bool, now_ns: u64) {
        let now = self.tim1.main_output();
        if now != before {
            self.main_output.push((now_ns, now));
        }
    }

    /// Level on a pin; `None` if nothing drives it.
    pub fn level(&self, port: usize, pin: u8) -> Option<bool> {
        let outside = match (port, pin) {
            (B, 3) => self.gate_driver.output(),
            (B, 7) => self.gate_driver.fault_pin(),
            (B, 12) => self.imu.output(),
            (C, 7) => self.encoder.output(),
            _ => None,
        };
        self.ports[port].level(pin, outside)
    }

    /// Whether PB8 and PB9 are the CAN controller's.
    pub(crate) fn can_is_connected(&self) -> bool {
        [8, 9].iter().all(|pin| self.ports[B].mode(*pin) == Mode::Alternate(9))
    }

    /// Input data register of a port.
    pub(crate) fn input_data(&self, port: usize) -> u32 {
        // The pins that `level` names.
        let outside: &[(u8, Option<bool>)] = match port {
            B => {
                &[(3, self.gate_driver.output()), (7, self.gate_driver.fault_pin()), (12, self.imu.output())]
            }
            C => &[(7, self.encoder.output())],
            _ => &[],
        };
        let (mut drives, mut levels) = (0, 0);
        for &(pin, level) in outside {
            drives |= u32::from(level.is_some()) << pin;
            levels |= u32::from(level == Some(true)) << pin;
        }
        self.ports[port].input(drives, levels)
    }

    /// Updates the devices on the buses of a port after a change of these pins.
    pub(crate) fn pins_changed(&mut self, port: usize, changed: u32, now: VirtualNanos) {
        // Resistors of the board hold an undriven select line high and an undriven clock low.
        let any = |pins: &[(usize, u8)]| pins.iter().any(|(at, pin)| *at == port && changed >> pin & 1 != 0);
        let high = |wiring: &Self, port: usize, pin: u8| wiring.level(port, pin).unwrap_or(true);
        let low = |wiring: &Self, port: usize, pin: u8| wiring.level(port, pin).unwrap_or(false);
        if any(&[(C, 9), (C, 10), (B, 4), (B, 5)]) {
            let (select, clock, data) = (high(self, C, 9), low(self, C, 10), high(self, B, 4));
            let enabled = low(self, B, 5);
            if enabled != self.gate_driver.is_enabled() {
                self.advance(now.0);
                self.gate_driver.enable(enabled, now.0);
            }
            self.gate_driver.lines(select, clock, data, now.0);
        }
        if any(&[(A, 15), (C, 15), (B, 2)]) {
            let (select, clock, data) = (high(self, A, 15), low(self, C, 15), high(self, B, 2));
            self.imu.lines(select, clock, data, now.0);
        }
        if any(&[(C, 8), (C, 6)]) {
            let (select, clock) = (high(self, C, 8), low(self, C, 6));
            let angle = self.encoder.latches(select).then(|| self.power.encoder_counts());
            self.encoder.lines(select, clock, angle);
        }
    }

    /// Present counts of a converter's channel (pins of docs/hardware.md); `None` if nothing is connected or the pin
    /// is not analog.
    pub(crate) fn counts(&self, channel: u8) -> Option<u16> {
        let (port, pin) = match channel {
            0..=7 => (A, channel),
            8 | 9 => (B, channel - 8),
            10..=15 => (C, channel - 10),
            _ => return None,
        };
        (self.ports[port].mode(pin) == Mode::Analog).then_some(())?;
        Some(match channel {
            10..=12 => self.analog.current_counts(self.power.phases_a(), usize::from(channel - 10)),
            5 => self.analog.steer_counts(self.power.steer_rad()),
            6 => self.analog.rider_torque_counts(),
            14 => self.analog.switch_counts(),
            3 => self.analog.board_temperature_counts(),
            13 => self.analog.supply_counts(self.power.bus_v()),
            _ => return None,
        })
    }
}

impl Default for Wiring {
    fn default() -> Self {
        Self::new()
    }
}
