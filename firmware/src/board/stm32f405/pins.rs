//! Every pin in use, in one table.
//!
//! Source: `hwconf/trampa/vesc6/hw_60_core.h` (hardware 60_MK6) in the public repository vedderb/bldc; what it says of a
//! pin stands in the middle column. CAN's two pins are that project's default in `hwconf/hw.h`.
//!
//! | pin | there | here |
//! | --- | --- | --- |
//! | PA8, PA9, PA10 | TIM1 channels 1 to 3 | upper switches of a, b, c |
//! | PB13, PB14, PB15 | TIM1 channels 1N to 3N | lower switches of a, b, c |
//! | PB5 | gate enable | gate driver on, high |
//! | PB7 | gate driver's fault, low | the same, read in every call of the motor's interrupt |
//! | PC9, PC10, PB4, PB3 | DRV8301 select, clock, in, out | the same |
//! | PC0, PC1, PC2 | current 1 to 3, IN10 to IN12 | phase currents of a, b, c |
//! | PC3 | supply, IN13 | the same |
//! | PA3 | board's temperature, IN3 | the same |
//! | PD2 | current filter on, high | the same |
//! | PC5 | power held, high | the same |
//! | PA4 | sensor port: high 5 V, low 3.3 V | low |
//! | PA15, PC15, PB2, PB12 | IMU (BMI160) select, clock, in, out | the same |
//! | PC6, PC7, PC8 | hall or encoder 1 to 3 | encoder AS5047P: clock, out, select |
//! | PC4 | motor's temperature, IN14, pulled up | the rider's switch, to ground |
//! | PA5 | COMM port ADC1, IN5 | steer sensor |
//! | PA6 | COMM port ADC2, IN6 | rider's torque sensor |
//! | PA7 | COMM port MOSI | rear wheel, TIM3 channel 2 |
//! | PB6 | servo, TIM4 channel 1 | front wheel, TIM4 channel 1 |
//! | PB10, PB11 | COMM port TX, RX | link, USART3 |
//! | PB0, PB1 | LED green, red | steps are done; no torque |
//! | PB8, PB9 | CAN receive, transmit | not used |
//! | PA0, PA1, PA2, PC13 | phase voltages and their filter | not used |
//! | PA11, PA12 | USB | not used |
//! | PA13, PA14 | SWD | SWD |

use embassy_stm32::gpio::{AfType, AnyPin, Flex, Level, Output, Speed};
use embassy_stm32::peripherals::{FLASH, PB10, PB11, USART3};
use embassy_stm32::{Peri, Peripherals};

/// A pin of which only the number matters.
pub(super) type Pin = Peri<'static, AnyPin>;

/// Number of the gate driver's enabling pin on port B, for [`super::outputs_off`].
pub(super) const GATE_ENABLE: usize = 5;

/// A serial bus that is moved by hand.
pub(super) struct Bus {
    pub(super) select: Pin,
    pub(super) clock: Pin,
    /// Into the part; none where the part need not be told anything.
    pub(super) to_part: Option<Pin>,
    pub(super) from_part: Pin,
}

/// The link's serial port.
pub(super) struct Link {
    pub(super) uart: Peri<'static, USART3>,
    pub(super) tx: Peri<'static, PB10>,
    pub(super) rx: Peri<'static, PB11>,
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
    pub(super) current_filter: Pin,
    pub(super) hold_power: Pin,
    pub(super) sensor_port_5v: Pin,
    pub(super) imu_bus: Bus,
    pub(super) encoder_bus: Bus,
    pub(super) front_wheel: Pin,
    pub(super) rear_wheel: Pin,
    pub(super) link: Link,
    pub(super) green: Pin,
    pub(super) red: Pin,
    /// No pin, but on its way with them.
    pub(super) flash: Peri<'static, FLASH>,
}

impl Pins {
    /// The table above, as types. The pins are the board's own from now on.
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
            link: Link { uart: p.USART3, tx: p.PB10, rx: p.PB11 },
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

/// Gives a pin to a timer for good, as its alternate function of this number.
pub(super) fn timer(pin: Pin, function: u8, kind: AfType) {
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
