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
pub const PATIENCE_MS: u32 = 50;

static LAST_MS: [AtomicU32; 3] = [const { AtomicU32::new(0) }; 3];
/// While flash is erased everything stands still, and nobody is blamed.
static EXCUSED: AtomicBool = AtomicBool::new(false);

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
        if crate::board::mishap::strikes(self) {
            return;
        }
        LAST_MS[self as usize].store(now_ms(), Ordering::Relaxed);
    }
}

/// The first of `tasks` that was silent for too long.
pub fn silent(tasks: &[Task]) -> Option<Task> {
    if EXCUSED.load(Ordering::Relaxed) {
        return None;
    }
    let now = now_ms();
    let last = |task: Task| LAST_MS[task as usize].load(Ordering::Relaxed);
    tasks.iter().copied().find(|task| now.saturating_sub(last(*task)) > PATIENCE_MS)
}

/// From now on nobody is blamed, or again everybody, their silence until now forgiven.
pub fn excuse(excused: bool) {
    let now = now_ms();
    LAST_MS.iter().for_each(|last| last.store(now, Ordering::Relaxed));
    EXCUSED.store(excused, Ordering::Relaxed);
}

/// Wraps after 49 days, when everything counts as just reported: one check is lost.
fn now_ms() -> u32 {
    Instant::now().as_millis() as u32
}
