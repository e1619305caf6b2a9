//! Text to QEMU's standard output; to its standard error while that carries the loop's bytes.

use super::semihosting::Text;
use core::fmt::{Arguments, Write};
use core::sync::atomic::{AtomicBool, Ordering};

static ASIDE: AtomicBool = AtomicBool::new(false);

/// From now on text goes to standard error.
pub fn aside() {
    ASIDE.store(true, Ordering::Relaxed);
}

/// Writes a line. A host that does not take it changes nothing.
pub fn line(text: Arguments<'_>) {
    let mut host = if ASIDE.load(Ordering::Relaxed) { Text::err() } else { Text::out() };
    let _ = host.write_fmt(text).and_then(|()| host.write_str("\n"));
}
