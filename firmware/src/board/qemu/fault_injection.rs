//! Failures on purpose, once, in the first start: the argument `mishap=KIND` at `at_ms=N`.
//!
//! | kind | what happens |
//! | --- | --- |
//! | `control-mute`, `line-mute`, `report-mute` | the task's reports get lost, as if it waited for ever |
//! | `control-spin`, `line-spin`, `report-spin` | the task never ends |
//! | `panic`, `bus` | a panic; an access to memory that is not there |
//! | `brown-out` | the supply's warning |
//! | `flash-stuck` | what is written to the flash from then on never gets there |

use super::semihosting::{argument, command_line};
use crate::crash;
use crate::heartbeat::Task;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_time::{Instant, Timer};

/// When, or never.
static AT_MS: AtomicU32 = AtomicU32::new(u32::MAX);
/// What, as a place in [`KINDS`].
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

/// Reads the arguments; what happens besides the tasks' own, if any, is to be spawned as [`strike`]. `false`: there is no
/// such mishap.
pub fn prepare() -> bool {
    let words = command_line();
    let Some(kind) = words.split(' ').find_map(|word| word.strip_prefix("mishap=")) else { return true };
    let (Some(kind), Some(at_ms)) = (KINDS.iter().position(|known| *known == kind), argument("at_ms")) else {
        return false;
    };
    if crash::starts() == 1 {
        KIND.store(kind as u32, Ordering::Relaxed);
        AT_MS.store(at_ms, Ordering::Relaxed);
    }
    true
}

/// A mishap of the whole program, when it is time.
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

/// Whether the flash takes nothing any more.
pub(super) fn flash_is_stuck() -> bool {
    KIND.load(Ordering::Relaxed) as usize == FLASH
        && super::time::milliseconds() >= AT_MS.load(Ordering::Relaxed)
}

/// Whether this task's report gets lost. Spins for ever where that is the mishap.
pub fn strikes(task: Task) -> bool {
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
