//! Every pin in use, as types: the table of docs/hardware.md, with the source of each assignment.

use embassy_stm32::gpio::{AfType, AnyPin, Flex, Level, Output, Speed};
use embassy_stm32::peripherals::{DMA1_CH1, DMA1_CH3, FLASH, PB10, USART3};
use embassy_stm32::{Peri, Peripherals};

/// A pin that is needed only by its number.
pub(super) type Pin = Peri<'static, AnyPin>;

/// Number of the gate driver's enable pin on port B.
pub(super) const GATE_ENABLE: usize = 5;

/// Pins of a software SPI bus.
pub(super) struct Bus {
    pub(super) select: Pin,
    pub(super) clock: Pin,
    /// Data to the device; none if the device needs no data.
    pub(super) to_part: Option<Pin>,
    pub(super) from_part: Pin,
}

/// Serial port of the link, and its DMA streams.
pub(super) struct Link {
    pub(super) uart: Peri<'static, USART3>,
    pub(super) tx: Peri<'static, PB10>,
    pub(super) rx: Pin,
    pub(super) tx_stream: Peri<'static, DMA1_CH3>,
    pub(super) rx_stream: Peri<'static, DMA1_CH1>,
}

/// The pins by function.
pub(super) struct Pins {
    /// Upper switches of a, b, c, then the lower ones.
    pub(super) bridge: [Pin; 6],
    pub(super) gate_enable: Pin,
    pub(super) gate_fault: Pin,
    pub(super) gate_bus: Bus,
    /// Analog inputs.
    pub(super) analog: [Pin; 8],
    /// Dividers of the phase voltages, unused.
    pub(super) phase_voltages: [Pin; 3],
    pub(super) phase_filter: Pin,
    pub(super) current_filter: Pin,
    pub(super) hold_power: Pin,
    pub(super) sensor_port_5v: Pin,
    pub(super) imu_bus: Bus,
    pub(super) encoder_bus: Bus,
    pub(super) front_wheel: Pin,
    pub(super) rear_wheel: Pin,
    pub(super) link: Link,
    pub(super) can_receive: Pin,
    pub(super) can_transmit: Pin,
    pub(super) green: Pin,
    pub(super) red: Pin,
    /// Flash peripheral, passed along with the pins.
    pub(super) flash: Peri<'static, FLASH>,
}

impl Pins {
    /// Takes the pins.
    pub(super) fn of(p: Peripherals) -> Self {
        Self {
            bridge: [p.PA8.into(), p.PA9.into(), p.PA10.into(), p.PB13.into(), p.PB14.into(), p.PB15.into()],
            gate_enable: p.PB5.into(),
            gate_fault: p.PB7.into(),
            gate_bus: Bus {
                select: p.PC9.into(),
                clock: p.PC10.into(),
                to_part: Some(p.PB4.into()),
                from_part: p.PB3.into(),
            },
            analog: [
                p.PC0.into(),
                p.PC1.into(),
                p.PC2.into(),
                p.PC3.into(),
                p.PA3.into(),
                p.PC4.into(),
                p.PA5.into(),
                p.PA6.into(),
            ],
            phase_voltages: [p.PA0.into(), p.PA1.into(), p.PA2.into()],
            phase_filter: p.PC13.into(),
            current_filter: p.PD2.into(),
            hold_power: p.PC5.into(),
            sensor_port_5v: p.PA4.into(),
            imu_bus: Bus {
                select: p.PA15.into(),
                clock: p.PC15.into(),
                to_part: Some(p.PB2.into()),
                from_part: p.PB12.into(),
            },
            encoder_bus: Bus {
                select: p.PC8.into(),
                clock: p.PC6.into(),
                to_part: None,
                from_part: p.PC7.into(),
            },
            front_wheel: p.PB6.into(),
            rear_wheel: p.PA7.into(),
            link: Link {
                uart: p.USART3,
                tx: p.PB10,
                rx: p.PB11.into(),
                tx_stream: p.DMA1_CH3,
                rx_stream: p.DMA1_CH1,
            },
            can_receive: p.PB8.into(),
            can_transmit: p.PB9.into(),
            green: p.PB0.into(),
            red: p.PB1.into(),
            flash: p.FLASH,
        }
    }
}

/// Sets a pin permanently high or low.
pub(super) fn fixed(pin: Pin, level: Level) {
    // Dropping it would release the pin.
    core::mem::forget(Output::new(pin, level, Speed::Low));
}

/// Assigns a pin permanently to a timer, CAN or the serial port, as its alternate function of this number.
pub(super) fn alternate(pin: Pin, function: u8, kind: AfType) {
    let mut pin = Flex::new(pin);
    pin.set_as_af_unchecked(function, kind);
    core::mem::forget(pin);
}

/// Makes a pin permanently analog.
pub(super) fn analog(pin: Pin) {
    let mut pin = Flex::new(pin);
    pin.set_as_analog();
    core::mem::forget(pin);
}
