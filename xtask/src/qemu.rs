//! Runs images in QEMU, on a machine with the same chip as the board.

use crate::process::{Outcome, capture};
use crate::{Result, paths};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Longer than any image takes, even on a busy machine.
pub const LIMIT: Duration = Duration::from_secs(1800);

/// Simulated time: an instruction takes 2^5 ns, so a millisecond has 31,250.
pub const TIMED: Option<u8> = Some(5);
/// Simulated time: an instruction takes 2^10 ns, so that timers count single instructions.
pub const COUNTED: Option<u8> = Some(10);
/// No simulated time: fastest, for images independent of time.
pub const UNTIMED: Option<u8> = None;

/// Runs an image with `arguments` in a directory with its files; an instruction takes 2^`shift` ns of
/// simulated time.
///
/// # Errors
/// QEMU cannot be run, or exceeded the limit.
pub fn run(
    image: &str,
    arguments: &[&str],
    directory: &Path,
    shift: Option<u8>,
    limit: Duration,
) -> Result<Outcome> {
    let options: String =
        [image].iter().chain(arguments).map(|argument| format!(",arg={argument}")).collect();
    let mut qemu = Command::new("qemu-system-arm");
    qemu.current_dir(directory);
    qemu.args(["-machine", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none"]);
    if let Some(shift) = shift {
        qemu.arg("-icount").arg(format!("shift={shift},sleep=off"));
    }
    qemu.arg("-semihosting-config").arg(format!("enable=on,target=native{options}"));
    capture(qemu.arg("-kernel").arg(paths::path(image)), limit)
}

/// A directory for one run's files, under `target`. Removed with this value, except in a failing test, where it remains
/// for inspection.
pub struct Directory(PathBuf);

impl Deref for Directory {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Directory {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            // A leftover directory is harmless.
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// An empty directory that no other program uses.
///
/// # Errors
/// It cannot be created.
pub fn directory(name: &str) -> Result<Directory> {
    let directory = paths::root().join("target/qemu").join(format!("{name}-{}", std::process::id()));
    // It may not exist.
    let _ = std::fs::remove_dir_all(&directory);
    std::fs::create_dir_all(&directory).map_err(|e| format!("{}: {e}", directory.display()))?;
    Ok(Directory(directory))
}
