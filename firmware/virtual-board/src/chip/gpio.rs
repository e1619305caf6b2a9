//! GPIO port with sixteen pins (RM0090 rev 22, chapter 8): mode, output type, pull, data.

use crate::wiring::{AsPort, Wiring};
use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::Layout;
use rigless::soc::stm32f427::generated::gpioa::Register;

/// Mode of a pin, section 8.4.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Digital input.
    Input,
    /// Output from the data register.
    Output,
    /// Alternate function of this number.
    Alternate(u8),
    /// Analog: neither driven nor read.
    Analog,
}

/// Registers of a port that determine levels.
#[derive(Clone, Copy, Debug)]
pub struct Port {
    moder: u32,
    otyper: u32,
    pupdr: u32,
    odr: u32,
    afr: u64,
    /// Pins by the mode in the registers above.
    pins: Pins,
}

/// Pins of a port, one bit each.
#[derive(Clone, Copy, Debug)]
struct Pins {
    output: u32,
    analog: u32,
    pulled_up: u32,
}

impl Pins {
    const fn new(moder: u32, pupdr: u32) -> Self {
        let mut pins = Self { output: 0, analog: 0, pulled_up: 0 };
        let mut pin = 0;
        while pin < 16 {
            pins.output |= ((moder >> (2 * pin) & 0b11 == 0b01) as u32) << pin;
            pins.analog |= ((moder >> (2 * pin) & 0b11 == 0b11) as u32) << pin;
            pins.pulled_up |= ((pupdr >> (2 * pin) & 0b11 == 0b01) as u32) << pin;
            pin += 1;
        }
        pins
    }
}

impl Port {
    /// State after reset, by port number: ports A and B have the debug pins assigned (8.4.1, 8.4.4).
    pub const fn new(number: usize) -> Self {
        let (moder, pupdr) = match number {
            0 => (0xa800_0000, 0x6400_0000),
            1 => (0x0000_0280, 0x0000_0100),
            _ => (0, 0),
        };
        Self { moder, otyper: 0, pupdr, odr: 0, afr: 0, pins: Pins::new(moder, pupdr) }
    }

    /// Mode of a pin.
    pub const fn mode(&self, pin: u8) -> Mode {
        match self.moder >> (2 * pin) & 0b11 {
            0b00 => Mode::Input,
            0b01 => Mode::Output,
            0b10 => Mode::Alternate((self.afr >> (4 * pin) & 0xf) as u8),
            _ => Mode::Analog,
        }
    }

    /// Level of the pull resistor, if enabled.
    pub const fn pull(&self, pin: u8) -> Option<bool> {
        match (self.mode(pin), self.pupdr >> (2 * pin) & 0b11) {
            (Mode::Analog, _) => None,
            (_, 0b01) => Some(true),
            (_, 0b10) => Some(false),
            _ => None,
        }
    }

    /// Level that the chip drives from its data register, if any.
    pub const fn driven(&self, pin: u8) -> Option<bool> {
        let (high, open_drain) = (self.odr >> pin & 1 == 1, self.otyper >> pin & 1 == 1);
        match self.mode(pin) {
            Mode::Output if !high || !open_drain => Some(high),
            _ => None,
        }
    }

    /// Level on a pin: the chip's own output, else the external level, else the pull resistor.
    pub fn level(&self, pin: u8, outside: Option<bool>) -> Option<bool> {
        self.driven(pin).or(outside).or(self.pull(pin))
    }

    /// Input data register, with the external levels `outside`; an undriven pin reads low, as does an analog one
    /// (8.3.12).
    pub(crate) const fn input(&self, outside_drives: u32, outside: u32) -> u32 {
        let Pins { output, analog, pulled_up } = self.pins;
        let driven = output & !(self.otyper & self.odr);
        let others = outside & outside_drives | pulled_up & !outside_drives;
        (self.odr & driven | others & !driven) & !analog
    }

    /// Output data register.
    pub const fn odr(&self) -> u32 {
        self.odr
    }
}

impl<const N: usize> Device for AsPort<N> {
    type Register = Register;

    fn read(&mut self, register: Register, _: &mut RegisterFile, _: &mut DeviceContext<'_>) -> Option<u64> {
        let wiring = Wiring::of_port(self);
        (register == Register::Idr).then(|| u64::from(wiring.input_data(N)))
    }

    fn write(
        &mut self,
        register: Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let wiring = Wiring::of_port(self);
        let port = &mut wiring.ports[N];
        let before = port.odr;
        match register {
            Register::Bsrr => {
                let (set, reset) = (value as u32 & 0xffff, value as u32 >> 16);
                port.odr = port.odr & !reset | set;
                registers.set(Register::Odr, u64::from(port.odr));
            }
            Register::Odr => port.odr = value as u32 & 0xffff,
            Register::Moder => port.moder = value as u32,
            Register::Otyper => port.otyper = value as u32,
            Register::Pupdr => port.pupdr = value as u32,
            Register::Afrl => port.afr = port.afr & !0xffff_ffff | value & 0xffff_ffff,
            Register::Afrh => port.afr = port.afr & 0xffff_ffff | value << 32,
            Register::Ospeedr | Register::Idr => (),
            Register::Lckr => context.tell(Register::Lckr.spec().name, "locked pins are not modelled"),
        }
        let port = &mut wiring.ports[N];
        let changed = match register {
            Register::Bsrr | Register::Odr => before ^ port.odr,
            _ => {
                port.pins = Pins::new(port.moder, port.pupdr);
                0xffff
            }
        };
        wiring.pins_changed(N, changed, context.now());
    }
}
