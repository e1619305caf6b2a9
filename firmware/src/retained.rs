//! Memory that survives a reset: the fault log, and the board's data behind it.
//!
//! The memory is the region `RETAINED` of `memory.x`.
#![allow(unsafe_code)]

use core::cell::RefCell;
use critical_section::Mutex;
use link::fault_log::{self, RING_BYTES};
use link::report::FaultRecord;

unsafe extern "C" {
    #[link_name = "_retained_start"]
    static mut RETAINED: [u8; RING_BYTES];
}

/// Length of the fault log at the start of `RETAINED`; the rest belongs to the board \[bytes\].
pub const USED: usize = RING_BYTES.next_multiple_of(1024);

static RING: Mutex<RefCell<Option<&'static mut [u8; RING_BYTES]>>> = Mutex::new(RefCell::new(None));

/// Initialises the fault log; call once at the start. Returns the number of starts since power-on.
pub fn start() -> u32 {
    let at = &raw mut RETAINED;
    // SAFETY: the linker script reserves this memory, and the cell gives exclusive access. It can hold any bytes,
    // which u8 allows; the compiler can't know that they are uninitialised.
    let memory = unsafe { &mut *at };
    critical_section::with(|cs| {
        let starts = fault_log::start(memory);
        RING.borrow(cs).replace(Some(memory));
        starts
    })
}

/// Stores a fault. Can be called from any context, fault handlers included.
pub fn note(fault: &FaultRecord<'_>) {
    with(|ring| fault_log::note(ring, fault));
}

/// Accesses the fault log; `None` before [`start`].
pub fn with<T>(look: impl FnOnce(&mut [u8; RING_BYTES]) -> T) -> Option<T> {
    critical_section::with(|cs| {
        // A fault handler that interrupts an access can't borrow the cell, and gives up rather than fail again.
        let mut cell = RING.borrow(cs).try_borrow_mut().ok()?;
        cell.as_mut().map(|ring| look(ring))
    })
}
