//! Text output to QEMU's standard output, or to standard error while standard output carries the loop.

use super::semihosting::Text;
use core::fmt::{Arguments, Write};
use core::sync::atomic::{AtomicBool, Ordering};

static ASIDE: AtomicBool = AtomicBool::new(false);

/// Redirects text to standard error.
pub fn aside() {
    ASIDE.store(true, Ordering::Relaxed);
}

/// Writes a line. A failed write is ignored.
pub fn line(text: Arguments<'_>) {
    let mut host = if ASIDE.load(Ordering::Relaxed) { Text::err() } else { Text::out() };
    let _ = host.write_fmt(text).and_then(|()| host.write_str("\n"));
}
