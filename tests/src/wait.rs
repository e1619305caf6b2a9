//! Waiting for another program: as long as a busy machine may need, and no longer than the program exists.

use std::io::Read;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longer than any wait here, however busy the machine.
pub const LONG: Duration = Duration::from_secs(600);

/// Polling period.
const PAUSE: Duration = Duration::from_millis(5);

/// The result of `look`, as soon as there is one.
///
/// # Panics
/// If there is none for [`LONG`].
pub fn until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < LONG, "{what}: not within {LONG:?}");
        sleep(PAUSE);
    }
}

/// Processor time used by a process of Linux \[s\]; none if there is no such process.
pub fn used_s(process: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The twelfth field after the name is the user time in hundredths of a second.
    let hundredths: f64 = stat.rsplit_once(')')?.1.split_whitespace().nth(11)?.parse().ok()?;
    Some(0.01 * hundredths)
}

/// As [`until`], for something that a program does.
///
/// # Panics
/// If it ends before, with its standard error if that is piped.
pub fn until_done<T>(child: &mut Child, what: &str, mut look: impl FnMut(&Child) -> Option<T>) -> T {
    until(what, || {
        let ended = child.try_wait().expect("a child of this process");
        let found = look(child);
        if let (None, Some(status)) = (&found, ended) {
            let mut said = String::new();
            let read = child.stderr.as_mut().map(|stderr| stderr.read_to_string(&mut said));
            panic!("{what}: the program ended before: {status}; {read:?}: {said}");
        }
        found
    })
}

/// Waits until a program has computed for this long.
///
/// # Panics
/// If it ends before, or does nothing.
pub fn until_used(child: &mut Child, seconds: f64) {
    until_done(child, "processor time", |child| (used_s(child.id())? >= seconds).then_some(()));
}
