//! Model of the gate driver DRV8301 (SLOS719): enable, four registers, fault pin.

use super::shift::{Event, Lines, Take};

/// Time from enabling to ready \[ns\]; the data sheet says 5 to 10 ms.
const WAKE_NS: u64 = 10_000_000;
/// Data of status register 2: the device identifier.
const DEVICE: u16 = 1;

/// The driver.
#[derive(Clone, Debug)]
pub struct Drv8301 {
    lines: Lines,
    registers: [u16; 4],
    received: u16,
    bits: u32,
    answer: u16,
    shifting: u16,
    /// Time at which it accepts words \[ns\], once enabled.
    ready_ns: Option<u64>,
    /// Number of words received since power-on.
    pub words: Vec<u16>,
    /// Whether it is missing, or its bus is open.
    pub absent: bool,
    /// Data of status register 1 for an injected fault; also pulls the fault pin.
    pub fault: Option<u16>,
    /// Whether its fault pin is shorted to ground without a reported fault.
    pub fault_pin_shorted: bool,
}

impl Drv8301 {
    /// State after power-on, not enabled.
    pub const fn new() -> Self {
        Self {
            lines: Lines::new(),
            registers: [0, DEVICE, 0, 0],
            received: 0,
            bits: 0,
            answer: 0,
            shifting: 0,
            ready_ns: None,
            words: Vec::new(),
            absent: false,
            fault: None,
            fault_pin_shorted: false,
        }
    }

    /// Whether its enable input is high.
    pub const fn is_enabled(&self) -> bool {
        self.ready_ns.is_some()
    }

    /// Enables or disables it; disabling clears its registers.
    pub fn enable(&mut self, enabled: bool, now_ns: u64) {
        self.ready_ns = enabled.then_some(now_ns + WAKE_NS);
        if !enabled {
            (self.registers, self.fault) = ([0, DEVICE, 0, 0], None);
        }
    }

    /// Whether it passes its inputs to the gates.
    pub const fn drives(&self) -> bool {
        self.is_enabled() && self.fault.is_none() && !self.absent
    }

    /// The open-drain fault pin.
    pub const fn fault_pin(&self) -> Option<bool> {
        if self.fault.is_some() || self.fault_pin_shorted { Some(false) } else { None }
    }

    /// Data output, while selected and enabled.
    pub fn output(&self) -> Option<bool> {
        let speaks = self.lines.is_selected() && self.is_enabled() && !self.absent;
        speaks.then_some(self.shifting & 0x8000 != 0)
    }

    /// Updates the bus lines; a word that ends before it is ready is lost.
    pub fn lines(&mut self, select: bool, clock: bool, data: bool, now_ns: u64) {
        match self.lines.step(Take::Falling, select, clock, data) {
            Event::None => (),
            Event::Selected => (self.received, self.bits, self.shifting) = (0, 0, self.answer),
            Event::Bit(bit) => {
                (self.received, self.bits) = (self.received << 1 | u16::from(bit), self.bits + 1);
            }
            // The first bit is output since the selection.
            Event::Next if self.bits > 0 => self.shifting <<= 1,
            Event::Next => (),
            Event::Released if self.ready_ns.is_some_and(|ready_ns| ready_ns <= now_ns) => self.word(),
            Event::Released => (),
        }
    }

    fn word(&mut self) {
        if self.absent || self.bits == 0 {
            return;
        }
        if self.bits != 16 {
            self.answer = 0x8000;
            return;
        }
        let (word, register) = (self.received, usize::from(self.received >> 11 & 0xf));
        self.words.push(word);
        if word & 0x8000 == 0 && (2..4).contains(&register) {
            self.registers[register] = word & 0x07ff;
        }
        let data = match register {
            0 => self.fault.unwrap_or(0),
            _ => self.registers.get(register).copied().unwrap_or(0),
        };
        self.answer = (register as u16) << 11 | data;
    }
}

impl Default for Drv8301 {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn send(driver: &mut Drv8301, word: u16, now_ns: u64) {
        driver.lines(false, false, false, now_ns);
        for place in (0..16).rev() {
            let bit = word >> place & 1 == 1;
            driver.lines(false, true, bit, now_ns);
            driver.lines(false, false, bit, now_ns);
        }
        driver.lines(true, false, false, now_ns);
    }

    /// Situation: just enabled. Action: the same word just before and when it is ready. Must hold: only the second is
    /// accepted.
    #[test]
    fn a_word_before_it_is_ready_is_lost() {
        const CONTROL_1: u16 = 2 << 11 | 0x155;
        let mut driver = Drv8301::new();
        driver.enable(true, 1_000);
        send(&mut driver, CONTROL_1, WAKE_NS + 999);
        assert!(driver.words.is_empty(), "{:x?}", driver.words);
        send(&mut driver, CONTROL_1, WAKE_NS + 1_000);
        assert_eq!(driver.words, [CONTROL_1]);
    }
}
