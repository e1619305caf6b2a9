//! Pseudo terminal: the serial line as a device that any program can open.

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::File;
use std::io::{Read, Write};

/// The board's end of a pseudo terminal.
pub struct Pty {
    end: File,
    /// Name of the device, for example /dev/pts/5.
    pub name: String,
    /// Kept open, so that the terminal stays when a program closes it.
    _device: File,
}

impl Pty {
    /// Opens a pseudo terminal in raw mode.
    ///
    /// # Errors
    /// The system has no free pseudo terminal.
    pub fn open() -> std::io::Result<Self> {
        let end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&end)?;
        unlockpt(&end)?;
        rustix::io::ioctl_fionbio(&end, true)?;
        let name = ptsname(&end, Vec::new())?.to_string_lossy().into_owned();
        let device = File::options().read(true).write(true).open(&name)?;
        let mut raw = tcgetattr(&device)?;
        raw.make_raw();
        tcsetattr(&device, OptionalActions::Now, &raw)?;
        Ok(Self { end: end.into(), name, _device: device })
    }

    /// Bytes written by a program.
    pub fn read(&mut self) -> Vec<u8> {
        let mut bytes = vec![0; 4096];
        // A non-blocking file reports missing data as an error.
        let length = self.end.read(&mut bytes).unwrap_or(0);
        bytes.truncate(length);
        bytes
    }

    /// Writes bytes to the reader; unread bytes are lost, as on a wire.
    pub fn write(&mut self, bytes: &[u8]) {
        let _ = self.end.write(bytes);
    }
}
