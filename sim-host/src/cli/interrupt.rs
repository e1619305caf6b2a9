//! Ctrl-C: the first asks the work to stop and keep what is done, the second ends the program.

use super::outputs::complain;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);
static INSTALLED: OnceLock<()> = OnceLock::new();

/// Installs the handler once, for work in columns.
pub(super) fn install() {
    install_saying("finishing the columns under way");
}

/// Installs the handler once; `what` is done after the first Ctrl-C.
pub(super) fn install_saying(what: &'static str) {
    INSTALLED.get_or_init(|| {
        // Without a handler Ctrl-C ends the program at once, which loses work but harms nothing.
        let _ = ctrlc::set_handler(move || {
            if STOP.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
            complain(&format!("\ninterrupted: {what} (again to quit at once)"));
        });
    });
}

/// Whether Ctrl-C was pressed.
pub(super) fn stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}
