//! Memory that keeps its bits through a reset: the ring of the last faults, and how the program ended.
//!
//! The memory is that of `RETAINED` in `memory.x`.
#![allow(unsafe_code)]

use core::cell::RefCell;
use critical_section::Mutex;
use link::fault_log::{self, RING_BYTES};
use link::report::FaultRecord;

unsafe extern "C" {
    #[link_name = "_retained_start"]
    static mut RETAINED: [u8; RING_BYTES];
}

/// Bytes at the start of `RETAINED` that are the ring's; what lies behind them is the board's.
pub const USED: usize = RING_BYTES.next_multiple_of(1024);

static RING: Mutex<RefCell<Option<&'static mut [u8; RING_BYTES]>>> = Mutex::new(RefCell::new(None));

/// To be called once, at the start of the program; how often it has started since power came.
pub fn start() -> u32 {
    let at = &raw mut RETAINED;
    // SAFETY: the linker script gives this memory to nobody else, and the cell hands it out to one at a time. It may
    // hold any bytes, which u8 allows; that nobody wrote them the compiler can't know.
    let memory = unsafe { &mut *at };
    critical_section::with(|cs| {
        let starts = fault_log::start(memory);
        RING.borrow(cs).replace(Some(memory));
        starts
    })
}

/// Keeps a fault. From any context, a fault's handler included.
pub fn note(fault: &FaultRecord<'_>) {
    with(|ring| fault_log::note(ring, fault));
}

/// Gives a look at what is kept; `None` before [`start`].
pub fn with<T>(look: impl FnOnce(&mut [u8; RING_BYTES]) -> T) -> Option<T> {
    critical_section::with(|cs| {
        // A fault within a look finds the cell taken, and gives up rather than fail again.
        let mut cell = RING.borrow(cs).try_borrow_mut().ok()?;
        cell.as_mut().map(|ring| look(ring))
    })
}
