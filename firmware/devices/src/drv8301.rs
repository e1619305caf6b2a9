//! Gate driver DRV8301: SPI frames, settings and status.
//!
//! 16-bit words, most significant bit first, clock idle low, data sampled on its falling edge. Bit 15 requests a
//! read, bits 14..11 are the register, bits 10..0 the data. The answer comes in the next transfer, with bit 15 set if
//! the frame was damaged. Source: data sheet SLOS719.

/// A register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Register {
    /// Present faults, bits of [`Status`].
    Status1 = 0,
    /// One more fault bit, and the device identifier.
    Status2 = 1,
    /// Gate current and over-current protection.
    Control1 = 2,
    /// Current-sense amplifiers.
    Control2 = 3,
}

/// The word that reads a register.
pub const fn read(register: Register) -> u16 {
    0x8000 | (register as u16) << 11
}

/// The word that writes a register.
pub const fn write(register: Register, data: u16) -> u16 {
    (register as u16) << 11 | data & 0x07ff
}

/// Data of an answer; `None` if the frame was damaged or the answer is of another register.
///
/// A line held low or high by a missing driver is rejected too, except for a zero of [`Register::Status1`]: check
/// [`is_present`] before using that register.
pub const fn data(register: Register, answer: u16) -> Option<u16> {
    let right = answer & 0x8000 == 0 && answer >> 11 & 0xf == register as u16;
    if right { Some(answer & 0x07ff) } else { None }
}

/// Whether the data of [`Register::Status2`] have the identifier of a DRV8301.
pub const fn is_present(status2: u16) -> bool {
    status2 & 0x000f == 1
}

/// Peak gate current.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum GateCurrent {
    /// 1.7 A.
    A1_7 = 0,
    /// 0.7 A.
    A0_7 = 1,
    /// 0.25 A.
    A0_25 = 2,
}

/// Reaction to over-current in a switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum OverCurrent {
    /// The switch opens for the rest of the cycle.
    Limit = 0,
    /// All switches open and stay open.
    Latch = 1,
    /// Reported only.
    Report = 2,
    /// Disabled.
    Off = 3,
}

/// Gain of the driver's two amplifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Gain {
    /// 10 V/V.
    X10 = 0,
    /// 20 V/V.
    X20 = 1,
    /// 40 V/V.
    X40 = 2,
    /// 80 V/V.
    X80 = 3,
}

/// Over-current thresholds, as the voltage across a closed switch, by their number in the data sheet \[mV\].
pub const OVER_CURRENT_MV: [u16; 32] = [
    60, 68, 76, 86, 97, 109, 123, 138, 155, 175, 197, 222, 250, 282, 317, 358, 403, 454, 511, 576, 648, 730,
    822, 926, 1043, 1175, 1324, 1491, 1679, 1892, 2131, 2400,
];

/// Settings of the gate driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Peak gate current.
    pub gate_current: GateCurrent,
    /// Reaction to over-current.
    pub over_current: OverCurrent,
    /// Over-current threshold \[mV\], rounded down to a value of [`OVER_CURRENT_MV`], at least the smallest.
    pub over_current_mv: u16,
    /// Gain of the amplifiers.
    pub gain: Gain,
}

impl Settings {
    /// Number of the over-current threshold, and the threshold \[mV\].
    pub const fn over_current_step(&self) -> (u16, u16) {
        let mut step = OVER_CURRENT_MV.len() - 1;
        while step > 0 && OVER_CURRENT_MV[step] > self.over_current_mv {
            step -= 1;
        }
        (step as u16, OVER_CURRENT_MV[step])
    }

    /// Data of [`Register::Control1`]: six PWM inputs, no reset.
    pub const fn control1(&self) -> u16 {
        self.over_current_step().0 << 6 | (self.over_current as u16) << 4 | self.gate_current as u16
    }

    /// Data of [`Register::Control2`]: all faults on the fault pin, amplifiers on, over-current cycle by cycle.
    pub const fn control2(&self) -> u16 {
        (self.gain as u16) << 2
    }
}

/// Faults of the gate driver: the data of [`Register::Status1`] and [`Register::Status2`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status(pub u16, pub u16);

/// Bit of [`Register::Status2`]: gate supply voltage too high.
const GATE_SUPPLY_HIGH: u16 = 0x80;

/// Names of the bits of [`Register::Status1`], from bit 0.
pub const STATUS: [&str; 11] = [
    "over-current low c",
    "over-current high c",
    "over-current low b",
    "over-current high b",
    "over-current low a",
    "over-current high a",
    "hot",
    "too hot",
    "supply low",
    "gate supply low",
    "fault",
];

impl Status {
    /// Names of the present faults.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let first = STATUS.into_iter().enumerate().filter(move |(bit, _)| self.0 >> bit & 1 == 1);
        let high = self.1 & GATE_SUPPLY_HIGH != 0;
        first.map(|(_, name)| name).chain(high.then_some("gate supply high"))
    }
}
