//! Software SPI, as the board's wires lead to no SPI peripheral of the chip.

use super::pins::{Bus, Pin};
use embassy_stm32::gpio::{Input, Level, Output, Pin as _, Pull, Speed};
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::{GPIOA, GPIOB, GPIOC, GPIOD};

/// Clock edge, from idle low, at which both sides sample the data.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    Rising,
    Falling,
}

/// Delay from chip select to the first bit, and between two words: 417 ns; the DRV8301 requires 400 and the AS5047P
/// 350.
const SELECT_CYCLES: u32 = 70;

/// Samples per bit of encoder and gate driver, whose wires run beside the bridge's; the majority decides. The VESC
/// firmware reads the encoder in the same way (`driver/spi_bb.c` in vedderb/bldc). The IMU's 152 bits per millisecond
/// are sampled once.
const SAMPLES_PER_BIT: u32 = 5;

/// A bus with one device.
pub(super) struct SoftSpi {
    select: Output<'static>,
    clock: Output<'static>,
    to_part: Option<Output<'static>>,
    /// Port and pin number of the device's data output.
    from_part: (Gpio, u8),
    edge: Edge,
    half_cycles: u32,
}

impl SoftSpi {
    /// Bus with a half clock period of at least `half_cycles` core cycles. The input has a pull-up.
    pub(super) fn new(bus: Bus, edge: Edge, half_cycles: u32) -> Self {
        Self {
            select: Output::new(bus.select, Level::High, Speed::Medium),
            clock: Output::new(bus.clock, Level::Low, Speed::Medium),
            to_part: bus.to_part.map(|pin| Output::new(pin, Level::High, Speed::Medium)),
            from_part: input(bus.from_part),
            edge,
            half_cycles,
        }
    }

    /// Transfers one 16-bit word with its own chip select; returns the answer.
    pub(super) fn word(&mut self, word: u16) -> u16 {
        self.begin();
        let answer = self.shift(word, 16);
        self.end();
        answer
    }

    /// Transfers bytes under one chip select; each is replaced by the answer.
    pub(super) fn bytes(&mut self, bytes: &mut [u8]) {
        self.begin();
        for byte in bytes {
            *byte = self.shift(u16::from(*byte), 8) as u8;
        }
        self.end();
    }

    fn begin(&mut self) {
        self.select.set_low();
        cortex_m::asm::delay(SELECT_CYCLES);
    }

    fn end(&mut self) {
        self.select.set_high();
        cortex_m::asm::delay(SELECT_CYCLES);
    }

    fn shift(&mut self, word: u16, bits: u16) -> u16 {
        let mut answer = 0;
        for bit in (0..bits).rev() {
            if let Some(to_part) = &mut self.to_part {
                to_part.set_level(Level::from(word >> bit & 1 == 1));
            }
            if self.edge == Edge::Rising {
                self.wait();
                answer = answer << 1 | self.bit();
            }
            self.clock.set_high();
            self.wait();
            if self.edge == Edge::Falling {
                answer = answer << 1 | self.bit();
            }
            self.clock.set_low();
            if self.edge == Edge::Falling {
                self.wait();
            }
        }
        answer
    }

    /// The present bit of the device.
    fn bit(&self) -> u16 {
        let samples = if self.edge == Edge::Falling { SAMPLES_PER_BIT } else { 1 };
        let (port, pin) = self.from_part;
        let high: u32 = (0..samples).map(|_| port.idr().read().0 >> pin & 1).sum();
        u16::from(2 * high > samples)
    }

    fn wait(&self) {
        cortex_m::asm::delay(self.half_cycles);
    }
}

/// Ports by number; the package has no pins of the others.
const PORTS: [Gpio; 4] = [GPIOA, GPIOB, GPIOC, GPIOD];

/// Makes a pin permanently an input with pull-up; returns its port.
fn input(pin: Pin) -> (Gpio, u8) {
    let place = (PORTS[usize::from(pin.port())], pin.pin());
    core::mem::forget(Input::new(pin, Pull::Up));
    place
}
