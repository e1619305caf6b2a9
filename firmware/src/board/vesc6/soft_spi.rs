//! A serial bus moved by hand, because the board's wires lead to no serial peripheral of the chip.

use super::pins::{Bus, Pin};
use embassy_stm32::gpio::{Input, Level, Output, Pin as _, Pull, Speed};
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::{GPIOA, GPIOB, GPIOC, GPIOD};

/// The edge of the clock, low at rest, at which both sides take the data.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    Rising,
    Falling,
}

/// From selecting a part to its first bit, and between two words: 417 ns, of 400 that the DRV8301 wants and 350 that
/// the AS5047P wants.
const SELECT_CYCLES: u32 = 70;

/// Readings of a bit of encoder and gate driver, whose wires run beside the bridge's; the majority counts. So does the
/// drive's own firmware read the encoder (`driver/spi_bb.c` in vedderb/bldc). The IMU's 152 bits a millisecond are read
/// once.
const LOOKS: u32 = 5;

/// The bus and its only part.
pub(super) struct SoftSpi {
    select: Output<'static>,
    clock: Output<'static>,
    to_part: Option<Output<'static>>,
    /// The port that the part's pin is on, and its number there.
    from_part: (Gpio, u8),
    edge: Edge,
    half_cycles: u32,
}

impl SoftSpi {
    /// With a half clock of at least `half_cycles` of the core. What comes from the part is pulled up.
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

    /// One word of 16 bits, the part selected for it alone; what came back.
    pub(super) fn word(&mut self, word: u16) -> u16 {
        self.begin();
        let answer = self.shift(word, 16);
        self.end();
        answer
    }

    /// Bytes, the part selected for all of them together; each is replaced by what came back.
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

    /// The bit that the part holds now.
    fn bit(&self) -> u16 {
        let looks = if self.edge == Edge::Falling { LOOKS } else { 1 };
        let (port, pin) = self.from_part;
        let high: u32 = (0..looks).map(|_| port.idr().read().0 >> pin & 1).sum();
        u16::from(2 * high > looks)
    }

    fn wait(&self) {
        cortex_m::asm::delay(self.half_cycles);
    }
}

/// The chip's ports, by their numbers; the others have no pins on it.
const PORTS: [Gpio; 4] = [GPIOA, GPIOB, GPIOC, GPIOD];

/// Makes a pin an input for good, pulled up; where it is read.
fn input(pin: Pin) -> (Gpio, u8) {
    let place = (PORTS[usize::from(pin.port())], pin.pin());
    core::mem::forget(Input::new(pin, Pull::Up));
    place
}
