//! Fault injection into the chip: debugger halt, replaced instructions, failing crystal or supply, register writes.

use crate::bench::{Bench, Error};
use crate::board::Vesc6;
use rigless::device::Level;
use rigless::emulator::{Host, InterruptLine, Watch};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// `b .`: a branch to itself.
pub const BRANCH_TO_ITSELF: u16 = 0xe7fe;
/// `udf #0`: a permanently undefined instruction.
pub const UNDEFINED: u16 = 0xde00;
/// Sets NMIPENDSET of ICSR at 0xe000ed04 (ARMv7-M, B3.2.4): the NMI comes before the next instruction, a branch to
/// itself. `movw r0, #0xed04; movt r0, #0xe000; mov.w r1, #0x80000000; str r1, [r0]; b .`
pub const RAISE_NMI: [u16; 8] = [0xf64e, 0x5004, 0xf2ce, 0x0000, 0xf04f, 0x4100, 0x6001, BRANCH_TO_ITSELF];

/// Replaced halfwords of the flash; the next reset restores them.
#[derive(Clone, Debug)]
pub struct Damage {
    pub(crate) address: u32,
    pub(crate) before: Vec<u16>,
    /// Number of resets at the time of replacement.
    pub(crate) resets: usize,
}

impl Bench {
    /// A debugger halts the core for a time \[ms\]. Of the timers TIM1 and TIM3 to TIM5 and the watchdog, those stop
    /// whose bits in DBGMCU are set, with TIM1's outputs off (RM0090 rev 22, 17.3.21, 38.16.4, 38.16.5). Everything
    /// else continues.
    ///
    /// # Errors
    /// As of [`Self::run_ms`].
    pub fn halt_ms(&mut self, ms: f64) -> Result<(), Error> {
        let at = VirtualNanos(self.now_ns());
        self.with_session(move |session, host| {
            session.board_mut().chip.halt(at);
            host.hold(true);
        });
        self.run_ms(ms)?;
        let at = VirtualNanos(self.now_ns());
        self.with_session(move |session, host| {
            session.board_mut().chip.go_on(at);
            host.hold(false);
        });
        Ok(())
    }

    /// Replaces the first halfwords of a function until the next reset, like damaged flash. Each execution is
    /// recorded in [`crate::board::Vesc6::hits`].
    ///
    /// # Errors
    /// [`Error::Image`] if no function has this name, or several.
    pub fn damage(&mut self, function: &str, halfwords: &[u16]) -> Result<(), Error> {
        let address = self.function(function)?;
        let halfwords = halfwords.to_vec();
        self.with_session(move |session, host| {
            session.watch(Watch::Instruction(address.into()));
            let before = exchange(host, address, &halfwords);
            let resets = session.resets().len();
            session.board_mut().damage.push(Damage { address, before, resets });
        });
        Ok(())
    }

    /// Drives an interrupt line of the chip, like a peripheral.
    ///
    /// # Panics
    /// If the number is not that of a line.
    pub fn drive_interrupt(&mut self, line: u16, high: bool) {
        let line = InterruptLine::new(line).expect("a line of the chip");
        self.with_session(move |_, host| host.set_interrupt(line, Level::from(high)));
    }

    /// Stops the crystal. The emulated core has the NMI but no input for it, so only the timer's break follows.
    pub fn lose_crystal(&mut self) {
        let at = VirtualNanos(self.now_ns());
        self.with(move |board| {
            board.chip.library.drive_clocks(at, |rcc, registers, context| rcc.fail_hse(registers, context));
        });
    }

    /// Sets the supply of the chip \[mV\].
    pub fn set_chip_supply(&mut self, millivolts: u32) {
        let at = VirtualNanos(self.now_ns());
        self.with(move |board| board.chip.set_supply(millivolts, at));
    }

    /// Writes a register like a fault of the chip, ignoring locks and clock gates.
    ///
    /// # Panics
    /// If no register has this address.
    pub fn force_register(&mut self, address: u32, change: impl FnOnce(u32) -> u32 + Send + 'static) {
        let at = VirtualNanos(self.now_ns());
        self.with(move |board| {
            let chip = &mut board.chip;
            let before = chip.peek(at, u64::from(address), Width::W32).expect("a register");
            chip.write(at, u64::from(address), Width::W32, u64::from(change(before as u32)))
                .expect("a register");
        });
    }
}

/// Restores replaced instructions after a reset.
pub(crate) fn put_back(session: &mut Session<Vesc6>, host: &mut dyn Host) {
    let resets = session.resets().len();
    session.board_mut().damage.retain(|damage| {
        let reset = damage.resets < resets;
        if reset {
            exchange(host, damage.address, &damage.before);
        }
        !reset
    });
}

/// Writes halfwords of the flash, ones and zeros; returns the previous ones.
fn exchange(host: &mut dyn Host, address: u32, halfwords: &[u16]) -> Vec<u16> {
    (u64::from(address)..)
        .step_by(2)
        .zip(halfwords)
        .map(|(at, halfword)| {
            let before = host.read(at, Width::W16).map_or(0, |before| before as u16);
            // An address outside the flash is left unchanged.
            let _ = host.program(at, Width::W16, u64::from(*halfword));
            before
        })
        .collect()
}

/// A branch from one address to another, at most 16 MiB apart (ARMv7-M, A7.7.12, encoding T4).
pub fn branch(from: u32, to: u32) -> [u16; 2] {
    let offset = to.wrapping_sub(from.wrapping_add(4)) as i32 >> 1;
    let sign = (offset >> 23 & 1) as u16;
    let j = |bit: i32| (bit as u16 & 1) ^ sign ^ 1;
    let high = 0xf000 | sign << 10 | (offset >> 11 & 0x3ff) as u16;
    let low = 0x9000 | j(offset >> 22) << 13 | j(offset >> 21) << 11 | (offset & 0x7ff) as u16;
    [high, low]
}
