//! Who has reported lately: the watchdog is fed only when every task has.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use embassy_time::Instant;

/// A task that must report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The control step.
    Control,
    /// The engineer's line.
    Line,
    /// The line of text once a second.
    Report,
}

/// How long a task may be silent \[ms\]. The longest that one waits by itself is a page of parameters going out at
/// 115200 baud: 29 ms.
pub const HEARTBEAT_TIMEOUT_MS: u32 = 50;

/// Longest that nobody is blamed \[ms\]. The longest store erases five sectors of 16 KiB: one for each of two items,
/// then, after damage, all three. Each takes 0.5 s at most (data sheet of the STM32F405, table 40), and then 0.3 s in
/// which control makes up for its steps; what is written takes 0.1 s.
pub const SUSPEND_MS: u32 = 5000;

static LAST_MS: [AtomicU32; 3] = [const { AtomicU32::new(0) }; 3];
/// While flash is erased everything stands still, and nobody is blamed.
static SUSPENDED: AtomicBool = AtomicBool::new(false);
/// Since when \[ms\].
static SUSPENDED_FROM_MS: AtomicU32 = AtomicU32::new(0);

impl Task {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Task::Control => "control",
            Task::Line => "line",
            Task::Report => "report",
        }
    }

    /// This task is alive.
    pub fn report(self) {
        #[cfg(feature = "board-qemu")]
        if crate::board::fault_injection::strikes(self) {
            return;
        }
        LAST_MS[self as usize].store(now_ms(), Ordering::Relaxed);
    }
}

/// The first of `tasks` that was silent for too long.
pub fn silent(tasks: &[Task]) -> Option<Task> {
    let now = now_ms();
    let excused_ms = now.wrapping_sub(SUSPENDED_FROM_MS.load(Ordering::Relaxed));
    if SUSPENDED.load(Ordering::Relaxed) && excused_ms <= SUSPEND_MS {
        return None;
    }
    let last = |task: Task| LAST_MS[task as usize].load(Ordering::Relaxed);
    tasks.iter().copied().find(|task| now.saturating_sub(last(*task)) > HEARTBEAT_TIMEOUT_MS)
}

/// Silence counts from now on: the board's start takes longer than any task may be silent.
pub fn begin() {
    suspend(false);
}

/// From now on nobody is blamed for [`SUSPEND_MS`], or again everybody; silence until now is forgiven.
pub fn suspend(suspended: bool) {
    let now = now_ms();
    LAST_MS.iter().for_each(|last| last.store(now, Ordering::Relaxed));
    SUSPENDED_FROM_MS.store(now, Ordering::Relaxed);
    SUSPENDED.store(suspended, Ordering::Relaxed);
}

/// Wraps after 49 days, when everything counts as just reported: one check is lost.
fn now_ms() -> u32 {
    Instant::now().as_millis() as u32
}
