//! Every pin in use. The table of docs/hardware.md, as types: what is on which pin, and where that is known from.

use embassy_stm32::gpio::{AfType, AnyPin, Flex, Level, Output, Speed};
use embassy_stm32::peripherals::{DMA1_CH1, DMA1_CH3, FLASH, PB10, USART3};
use embassy_stm32::{Peri, Peripherals};

/// A pin of which only the number matters.
pub(super) type Pin = Peri<'static, AnyPin>;

/// Number of the gate driver's enabling pin on port B.
pub(super) const GATE_ENABLE: usize = 5;

/// A serial bus that is moved by hand.
pub(super) struct Bus {
    pub(super) select: Pin,
    pub(super) clock: Pin,
    /// Into the part; none where the part need not be told anything.
    pub(super) to_part: Option<Pin>,
    pub(super) from_part: Pin,
}

/// The link's serial port, and the streams that carry its bytes.
pub(super) struct Link {
    pub(super) uart: Peri<'static, USART3>,
    pub(super) tx: Peri<'static, PB10>,
    pub(super) rx: Pin,
    pub(super) tx_stream: Peri<'static, DMA1_CH3>,
    pub(super) rx_stream: Peri<'static, DMA1_CH1>,
}

/// The pins by what is on them.
pub(super) struct Pins {
    /// Upper switches of a, b, c, then the lower ones.
    pub(super) bridge: [Pin; 6],
    pub(super) gate_enable: Pin,
    pub(super) gate_fault: Pin,
    pub(super) gate_bus: Bus,
    /// Everything that a converter reads.
    pub(super) analog: [Pin; 8],
    /// Dividers of the phases' voltages, which nothing reads.
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
    /// No pin, but on its way with them.
    pub(super) flash: Peri<'static, FLASH>,
}

impl Pins {
    /// The pins are the board's own from now on.
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

/// Sets a pin high or low for good.
pub(super) fn fixed(pin: Pin, level: Level) {
    // Dropped, it would let go of the pin.
    core::mem::forget(Output::new(pin, level, Speed::Low));
}

/// Gives a pin to a timer, CAN or the serial port for good, as its alternate function of this number.
pub(super) fn alternate(pin: Pin, function: u8, kind: AfType) {
    let mut pin = Flex::new(pin);
    pin.set_as_af_unchecked(function, kind);
    core::mem::forget(pin);
}

/// Gives a pin to the converters for good.
pub(super) fn analog(pin: Pin) {
    let mut pin = Flex::new(pin);
    pin.set_as_analog();
    core::mem::forget(pin);
}
