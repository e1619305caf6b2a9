//! Text to QEMU's standard output; to its standard error while that carries the loop's bytes.

use core::fmt::{Arguments, Write};
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m_semihosting::hio;

static ASIDE: AtomicBool = AtomicBool::new(false);

/// From now on text goes to standard error.
pub fn aside() {
    ASIDE.store(true, Ordering::Relaxed);
}

/// Writes a line. A host that does not take it changes nothing.
pub fn line(text: Arguments<'_>) {
    let host = if ASIDE.load(Ordering::Relaxed) { hio::hstderr() } else { hio::hstdout() };
    if let Ok(mut host) = host {
        let _ = host.write_fmt(text).and_then(|()| host.write_str("\n"));
    }
}
