//! Handles Ctrl-C and SIGTERM, exit code 130: a command that keeps finished results stops at the first and ends at the second,
//! any other ends at the first.

use super::outputs::complain;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);
/// What is still done after the first signal; unset where nothing is kept.
static KEEPS: OnceLock<&'static str> = OnceLock::new();

/// Installs the handlers, at the program's start.
pub(super) fn handle_signals() {
    // Without a handler the signal ends the program at once, which only loses results.
    let _ = handle();
}

/// The first signal from now on is a request to stop, for computations in columns.
pub(super) fn install() {
    install_saying("finishing the columns under way");
}

/// The same; `what` describes what is still done after the first signal.
pub(super) fn install_saying(what: &'static str) {
    KEEPS.get_or_init(|| what);
}

/// Not SIGHUP: a run under `nohup` would end with its terminal.
#[cfg(unix)]
fn handle() -> std::io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().spawn(move || signals.forever().for_each(|_| interrupted())).map(drop)
}

#[cfg(not(unix))]
fn handle() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(interrupted)
}

fn interrupted() {
    match KEEPS.get() {
        Some(what) if !STOP.swap(true, Ordering::SeqCst) => {
            complain(&format!("\ninterrupted: {what} (again to quit at once)"));
        }
        _ => std::process::exit(130),
    }
}

/// Whether Ctrl-C was pressed or SIGTERM received.
pub(super) fn stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}
