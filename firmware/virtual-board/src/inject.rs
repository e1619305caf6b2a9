//! What a test does to the chip itself: a debugger's halt, other instructions in the flash, a failing crystal or supply.

use crate::bench::{Bench, Error};
use crate::board::Vesc6;
use crate::chip::memory::FLASH;
use rigless::device::Level;
use rigless::emulator::{Host, InterruptLine, Watch};
use rigless::mcu::{Mcu, Operate};
use rigless::session::Session;
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::dbg;
use rigless::time::VirtualNanos;

/// `b .`: a branch to itself.
pub const BRANCH_TO_ITSELF: u16 = 0xe7fe;
/// `udf #0`: a permanently undefined instruction.
pub const UNDEFINED: u16 = 0xde00;

/// Halfwords of the flash that stand in place of others until the next reset, which puts those back.
#[derive(Clone, Debug)]
pub struct Damage {
    pub(crate) address: u32,
    pub(crate) before: Vec<u16>,
    /// Resets when it was done.
    pub(crate) resets: usize,
}

impl Bench {
    /// A debugger halts the core for this time \[ms\], no longer than the watchdog waits: its counter is not stopped
    /// here. With DBG_TIM1_STOP set TIM1's outputs are off meanwhile (RM0090 rev 22, 17.3.21 and 38.16.5); without it
    /// the timer goes on.
    ///
    /// # Errors
    /// As of [`Self::run_ms`].
    pub fn halt_ms(&mut self, ms: f64) -> Result<(), Error> {
        let now_ns = self.now_ns();
        self.with_session(move |session, host| {
            let chip = &mut session.board_mut().chip;
            let frozen =
                chip.library.bus().registers("DBG").map_or(0, |dbg| dbg.get(dbg::Register::DbgmcuApb2Fz));
            chip.wiring.halt(dbg::dbgmcu_apb2_fz::DBG_TIM1_STOP.is_set(frozen), now_ns);
            host.hold(true);
        });
        self.run_ms(ms)?;
        let now_ns = self.now_ns();
        self.with_session(move |session, host| {
            session.board_mut().chip.wiring.go_on(now_ns);
            host.hold(false);
        });
        Ok(())
    }

    /// Puts these halfwords in place of the first ones of a function until the next reset, as a damaged flash would have
    /// them. Each arrival there is noted in [`crate::board::Vesc6::hits`] from now on.
    ///
    /// # Errors
    /// [`Error::Image`] where no function has this name, or several have.
    pub fn damage(&mut self, function: &str, halfwords: &[u16]) -> Result<(), Error> {
        let address = self.function(function)?;
        self.with_session(move |session, _| session.watch(Watch::Instruction(address.into())));
        self.damage_at(address, halfwords);
        Ok(())
    }

    /// Makes an exception's vector lead to another exception's handler until the next reset. Both by their numbers.
    pub fn lead_vector(&mut self, from: u32, to: u32) {
        let vector = |number: u32| FLASH.start as u32 + 4 * number;
        let handler = self.word(vector(to)).unwrap_or(0);
        self.damage_at(vector(from), &[handler as u16, (handler >> 16) as u16]);
    }

    fn damage_at(&mut self, address: u32, halfwords: &[u16]) {
        let halfwords = halfwords.to_vec();
        self.with_session(move |session, host| {
            let before = exchange(host, address, &halfwords);
            let resets = session.resets().len();
            session.board_mut().damage.push(Damage { address, before, resets });
        });
    }

    /// Drives an interrupt line of the chip, as a peripheral would.
    ///
    /// # Panics
    /// With a number that no line has.
    pub fn drive_interrupt(&mut self, line: u16, high: bool) {
        let line = InterruptLine::new(line).expect("a line of the chip");
        self.with_session(move |_, host| host.set_interrupt(line, Level::from(high)));
    }

    /// The crystal stops. The emulated core has no NMI input, so that only the timer's break follows.
    pub fn lose_crystal(&mut self) {
        let at = VirtualNanos(self.now_ns());
        self.with(move |board| {
            board.chip.library.drive_clocks(at, |rcc, registers, context| rcc.fail_hse(registers, context));
        });
    }

    /// Sets the chip's own supply \[mV\].
    pub fn set_chip_supply(&mut self, millivolts: u32) {
        let at = VirtualNanos(self.now_ns());
        self.with(move |board| board.chip.set_supply(millivolts, at));
    }

    /// Writes a register as a fault of the chip would, whatever its lock or gate.
    ///
    /// # Panics
    /// Where no register answers at this address.
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

/// Undoes what was damaged before the reset that just came.
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

/// Programs halfwords of the flash, ones and zeros; what stood there.
fn exchange(host: &mut dyn Host, address: u32, halfwords: &[u16]) -> Vec<u16> {
    (u64::from(address)..)
        .step_by(2)
        .zip(halfwords)
        .map(|(at, halfword)| {
            let before = host.read(at, Width::W16).map_or(0, |before| before as u16);
            // An address outside the flash keeps what it has.
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
