//! Heartbeats of the tasks: the watchdog is fed only while every task reports.

use crate::board;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use embassy_time::Instant;

/// A supervised task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The control step.
    Control,
    /// The serial link.
    Line,
    /// The periodic log line.
    Report,
}

/// Longest time between two reports of a task \[ms\]. The longest regular interval is the transmission of a page of
/// parameters at 115200 baud: 29 ms.
pub const HEARTBEAT_TIMEOUT_MS: u32 = 50;

/// Longest suspension of the supervision \[ms\]. The longest store erases five sectors of 16 KiB: one for each of two
/// items, then, after damage, all three. Each takes at most 0.5 s (data sheet of the STM32F405, table 40), and then at
/// most 0.6 s in which control catches up on its steps; searching and writing take at most 0.2 s each time.
pub const SUSPEND_MS: u32 = 8000;

static LAST_MS: [AtomicU32; 3] = [const { AtomicU32::new(0) }; 3];
/// Set during a store: it searches the flash, and the chip halts, so missing reports are ignored.
static SUSPENDED: AtomicBool = AtomicBool::new(false);
/// Start of the suspension \[ms\].
static SUSPENDED_FROM_MS: AtomicU32 = AtomicU32::new(0);

impl Task {
    /// Name of the task.
    pub const fn name(self) -> &'static str {
        match self {
            Task::Control => "control",
            Task::Line => "line",
            Task::Report => "report",
        }
    }

    /// Reports that this task is running, unless the board drops the report (`heartbeat_lost`).
    pub fn report(self) {
        if !board::heartbeat_lost(self) {
            LAST_MS[self as usize].store(now_ms(), Ordering::Relaxed);
        }
    }
}

/// The first of `tasks` whose last report is too old.
pub fn silent(tasks: &[Task]) -> Option<Task> {
    let now = now_ms();
    if is_suspended() {
        return None;
    }
    let last = |task: Task| LAST_MS[task as usize].load(Ordering::Relaxed);
    // A report can come after `now` was read.
    let age_ms = |task: Task| now.wrapping_sub(last(task)).cast_signed().max(0).cast_unsigned();
    tasks.iter().copied().find(|task| age_ms(*task) > HEARTBEAT_TIMEOUT_MS)
}

/// Starts the supervision; the board's start takes longer than the timeout of a task.
pub fn begin() {
    suspend(false);
}

/// Whether the supervision is suspended, and not for longer than [`SUSPEND_MS`].
pub fn is_suspended() -> bool {
    let suspended_for_ms = now_ms().wrapping_sub(SUSPENDED_FROM_MS.load(Ordering::Relaxed));
    SUSPENDED.load(Ordering::Relaxed) && suspended_for_ms <= SUSPEND_MS
}

/// Suspends the supervision for at most [`SUSPEND_MS`], or resumes it. All tasks count as having just reported.
pub fn suspend(suspended: bool) {
    let now = now_ms();
    LAST_MS.iter().for_each(|last| last.store(now, Ordering::Relaxed));
    SUSPENDED_FROM_MS.store(now, Ordering::Relaxed);
    SUSPENDED.store(suspended, Ordering::Relaxed);
}

/// Wraps after 49 days.
fn now_ms() -> u32 {
    Instant::now().as_millis() as u32
}
