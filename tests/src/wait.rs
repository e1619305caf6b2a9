//! Waiting for something that another program does: for as long as a busy machine may take, and no longer than it is there.

use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longer than anything here takes, however busy the machine.
pub const LONG: Duration = Duration::from_secs(600);

/// Between two looks.
const PAUSE: Duration = Duration::from_millis(5);

/// What `look` finds, as soon as it finds something.
///
/// # Panics
/// When it finds nothing for [`LONG`].
pub fn until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(begin.elapsed() < LONG, "{what}: not within {LONG:?}");
        sleep(PAUSE);
    }
}

/// Processor time that a process of Linux has used \[s\]; nothing when there is none of this number.
pub fn used_s(process: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The twelfth field after the name is the user time in hundredths of a second.
    let hundredths: f64 = stat.rsplit_once(')')?.1.split_whitespace().nth(11)?.parse().ok()?;
    Some(0.01 * hundredths)
}

/// Waits until a program has computed for this long.
///
/// # Panics
/// When it ended before, or does nothing.
pub fn until_used(child: &Child, seconds: f64) {
    until("processor time", || (used_s(child.id()).expect("the program runs") >= seconds).then_some(()));
}
