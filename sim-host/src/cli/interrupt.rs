//! Handles Ctrl-C and SIGTERM: the first requests a stop that keeps finished results, the second ends the program.

use super::outputs::complain;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);
static INSTALLED: OnceLock<()> = OnceLock::new();

/// Installs the handlers once, for computations in columns.
pub(super) fn install() {
    install_saying("finishing the columns under way");
}

/// Installs the handlers once; `what` describes what is still done after the first signal.
pub(super) fn install_saying(what: &'static str) {
    INSTALLED.get_or_init(|| {
        // Without a handler the signal ends the program at once, which only loses results.
        let _ = handle(what);
    });
}

/// Not SIGHUP: a run under `nohup` would end with its terminal.
#[cfg(unix)]
fn handle(what: &'static str) -> std::io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().spawn(move || signals.forever().for_each(|_| interrupted(what))).map(drop)
}

#[cfg(not(unix))]
fn handle(what: &'static str) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || interrupted(what))
}

fn interrupted(what: &str) {
    if STOP.swap(true, Ordering::SeqCst) {
        std::process::exit(130);
    }
    complain(&format!("\ninterrupted: {what} (again to quit at once)"));
}

/// Whether Ctrl-C was pressed or SIGTERM received.
pub(super) fn stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}
