//! Fault injection: one fault in the first start, given by the arguments `fault=KIND` and `at_ms=N`.
//!
//! | kind | fault |
//! | --- | --- |
//! | `control-mute`, `line-mute`, `report-mute` | the task's heartbeats are lost, as if it were blocked |
//! | `control-spin`, `line-spin`, `report-spin` | the task never ends |
//! | `panic`, `bus` | a panic; an access to memory that is not there |
//! | `brown-out` | the supply warning |
//! | `flash-stuck` | later writes to flash are lost |

use super::semihosting::{argument, command_line};
use crate::crash;
use crate::heartbeat::Task;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_time::{Instant, Timer};

/// Time of the fault \[ms\]; the maximum means never.
static AT_MS: AtomicU32 = AtomicU32::new(u32::MAX);
/// Index of the fault in [`KINDS`].
static KIND: AtomicU32 = AtomicU32::new(0);

const KINDS: [&str; 10] = [
    "control-mute",
    "line-mute",
    "report-mute",
    "control-spin",
    "line-spin",
    "report-spin",
    "panic",
    "bus",
    "brown-out",
    "flash-stuck",
];
const SPIN: usize = 3;
const PANIC: usize = 6;
const BUS: usize = 7;
const FLASH: usize = 9;

/// Reads the arguments. Faults that do not concern a task need [`strike`] to be spawned. `false`: unknown fault, or
/// missing time.
pub fn prepare() -> bool {
    let arguments = command_line();
    let Some(kind) = arguments.split(' ').find_map(|word| word.strip_prefix("fault=")) else { return true };
    let (Some(kind), Some(at_ms)) = (KINDS.iter().position(|known| *known == kind), argument("at_ms")) else {
        return false;
    };
    if crash::starts() == 1 {
        KIND.store(kind as u32, Ordering::Relaxed);
        AT_MS.store(at_ms, Ordering::Relaxed);
    }
    true
}

/// Injects the faults that concern the whole program.
#[embassy_executor::task]
pub async fn strike() {
    let (kind, at_ms) = (KIND.load(Ordering::Relaxed) as usize, AT_MS.load(Ordering::Relaxed));
    if kind < PANIC || kind == FLASH || at_ms == u32::MAX {
        return;
    }
    Timer::at(Instant::from_millis(at_ms.into())).await;
    match kind {
        PANIC => panic!("on purpose"),
        BUS => super::exit::touch_nothing(),
        _ => crash::brown_out(),
    }
}

/// Whether writes to flash are lost.
pub(super) fn flash_is_stuck() -> bool {
    KIND.load(Ordering::Relaxed) as usize == FLASH
        && super::time::milliseconds() >= AT_MS.load(Ordering::Relaxed)
}

/// Whether this task's heartbeat is lost. Never returns for the faults in which the task does not end.
pub fn heartbeat_lost(task: Task) -> bool {
    let kind = KIND.load(Ordering::Relaxed) as usize;
    if kind >= PANIC
        || kind % SPIN != task as usize
        || super::time::milliseconds() < AT_MS.load(Ordering::Relaxed)
    {
        return false;
    }
    if kind >= SPIN {
        loop {
            core::hint::spin_loop();
        }
    }
    true
}
