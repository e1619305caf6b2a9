//! Flash array behind the library's interface registers: programming, erasing, and the time for which the core halts.
//!
//! The chip has one bank, so every access to it waits while it is busy (RM0090 rev 22, 3.6). A short loop could run
//! from the instruction cache until its first miss; here the core halts at once.

use crate::board::Vesc6;
use crate::cache::DataCache;
use crate::chip::memory::{FLASH, sector};
use rigless::emulator::{Access, AccessKind, Host, Settled};
use rigless::session::Session;
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::flash::{Register, cr, sr};
use rigless::time::VirtualNanos;

/// Addresses of the access control and control registers.
const ACR: u64 = 0x4002_3c00;
const CR: u64 = 0x4002_3c10;

/// Timing of the array, DS8626 rev 9, table 40.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Typical times.
    Typical,
    /// Longest times.
    Longest,
}

impl Pace {
    /// Programming time of a unit of any width \[ns\].
    pub const fn program_ns(self) -> u64 {
        match self {
            Pace::Typical => 16_000,
            Pace::Longest => 100_000,
        }
    }

    /// Erase time of a sector of a size \[bytes\] with the field PSIZE of the control register \[ns\].
    pub fn erase_ns(self, bytes: u64, psize: u64) -> u64 {
        /// By 8, 16, 32 bits: typical and longest \[ms\].
        const SMALL: [[u64; 2]; 3] = [[400, 800], [300, 600], [250, 500]];
        const MIDDLE: [[u64; 2]; 3] = [[1200, 2400], [700, 1400], [550, 1100]];
        const LARGE: [[u64; 2]; 3] = [[2000, 4000], [1300, 2600], [1000, 2000]];
        let times = match bytes >> 10 {
            0..=16 => SMALL,
            17..=64 => MIDDLE,
            _ => LARGE,
        };
        let [typical, longest] = times[psize.min(2) as usize];
        1_000_000 * if self == Pace::Typical { typical } else { longest }
    }
}

/// A completed operation of the array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// A sector was erased.
    Erased {
        /// Number of the sector.
        sector: u32,
        /// Field PSIZE of the control register.
        psize: u64,
    },
    /// A word was programmed: only ones become zeros.
    Programmed {
        /// Address of the word.
        address: u64,
        /// Written value.
        value: u32,
    },
}

/// Present operation of the array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Work {
    end_ns: u64,
    /// The sector being erased; none while a word is programmed.
    sector: Option<u32>,
}

/// The array.
#[derive(Clone, Debug)]
pub struct Array {
    /// Timing.
    pub pace: Pace,
    /// Operations since power-on, with the time of their end \[ns\].
    pub changes: Vec<(u64, Change)>,
    /// First time at which the data cache returned, or could have returned, erased data \[ns\].
    pub stale_ns: Option<u64>,
    cache: DataCache,
    work: Option<Work>,
    resets: usize,
}

impl Array {
    /// An array with this timing.
    pub const fn new(pace: Pace) -> Self {
        Self { pace, changes: Vec::new(), stale_ns: None, cache: DataCache::new(), work: None, resets: 0 }
    }

    /// Whether the run's next step concerns the array; fast, as it is called after every access.
    pub(crate) fn concerns(&self, settled: &Settled) -> bool {
        match settled {
            Settled::Access { access, .. } => {
                access.kind == AccessKind::Write
                    && (matches!(access.address, ACR | CR) || FLASH.contains(&access.address))
            }
            _ => self.work.is_some(),
        }
    }

    /// Runs one step.
    pub(crate) fn settled(&mut self, session: &mut Session<Vesc6>, host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Access { access, .. } if access.address == CR => self.control(session, host, &access),
            Settled::Access { access, .. } if access.address == ACR => {
                let (_, registers) = session.board_mut().chip.library.program();
                self.cache.control(registers.get(Register::Acr));
                self.look_at_cache(access.virtual_time.0);
            }
            Settled::Access { access, .. } => self.store(session, host, &access),
            Settled::Stop(stop) => self.stop(session, host, stop.at.0),
            _ => (),
        }
    }

    /// Handles a write of the control register, which can start an erase.
    fn control(&mut self, session: &mut Session<Vesc6>, host: &mut dyn Host, access: &Access) {
        let (_, registers) = session.board_mut().chip.library.program();
        let (status, control) = (registers.get(Register::Sr), registers.get(Register::Cr));
        if self.work.is_some() || !sr::BSY.is_set(status) || !cr::SER.is_set(control) {
            return;
        }
        let (number, psize) = (cr::SNB.get(control) as u32, cr::PSIZE.get(control));
        let Some(range) = sector(number) else { return };
        let end_ns = access.virtual_time.0 + self.pace.erase_ns(range.end - range.start, psize);
        self.changes.push((end_ns, Change::Erased { sector: number, psize }));
        self.begin(session, host, Work { end_ns, sector: Some(number) });
    }

    /// Handles a store into the array: programs a word if the interface permits (3.6.4), else raises the error.
    fn store(&mut self, session: &mut Session<Vesc6>, host: &mut dyn Host, access: &Access) {
        let (_, registers) = session.board_mut().chip.library.program();
        let (status, control) = (registers.get(Register::Sr), registers.get(Register::Cr));
        let unlocked = cr::PG.is_set(control) && !cr::LOCK.is_set(control);
        let fits = access.width == Width::W32 && cr::PSIZE.get(control) == 2;
        let Ok(old) = host.read(access.address, Width::W32) else { return };
        if !unlocked || !fits {
            let error = if unlocked { &sr::PGPERR } else { &sr::PGSERR };
            registers.set(Register::Sr, error.set(status, 1));
            return;
        }
        // Only the interface programs the region.
        let _ = host.program(access.address, Width::W32, old & access.value);
        let end_ns = access.virtual_time.0 + self.pace.program_ns();
        let (address, value) = (access.address, access.value as u32);
        self.changes.push((end_ns, Change::Programmed { address, value }));
        self.begin(session, host, Work { end_ns, sector: None });
    }

    fn begin(&mut self, session: &mut Session<Vesc6>, host: &mut dyn Host, work: Work) {
        (self.work, self.resets) = (Some(work), session.resets().len());
        host.hold(true);
        session.pause_at(Some(VirtualNanos(work.end_ns)));
    }

    /// Completes an operation at its end, or leaves a sector half erased if a reset came first.
    fn stop(&mut self, session: &mut Session<Vesc6>, host: &mut dyn Host, now_ns: u64) {
        let Some(work) = self.work else { return };
        let cut = session.resets().len() != self.resets;
        if now_ns < work.end_ns && !cut {
            session.pause_at(Some(VirtualNanos(work.end_ns)));
            return;
        }
        if let Some(range) = work.sector.and_then(sector) {
            let end = if cut { range.start + (range.end - range.start) / 2 } else { range.end };
            for address in (range.start..end).step_by(8) {
                // Only the interface programs the region.
                let _ = host.program(address, Width::W64, u64::MAX);
            }
        }
        if cut {
            self.cache.reset();
        } else if work.sector.is_some() {
            self.cache.erased();
            self.look_at_cache(now_ns);
        }
        self.work = None;
        host.hold(false);
    }

    fn look_at_cache(&mut self, now_ns: u64) {
        if self.cache.answers_with_erased() {
            self.stale_ns.get_or_insert(now_ns);
        }
    }
}
