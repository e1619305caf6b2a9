//! Semihosting calls to QEMU's host: files, command line and exit status.
//!
//! Calls and numbers: Arm, "Semihosting for AArch32 and AArch64", 2.0.
#![allow(unsafe_code)]

use core::ffi::CStr;
use core::fmt::Write;
use cortex_m_semihosting::{nr, syscall};
use heapless::String;

/// Exit status of QEMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Exit {
    /// All checks of the image passed.
    Success = 0,
    /// A check of the image failed.
    Failure = 1,
    /// Invalid input of the image.
    Input = 2,
    /// A panic.
    Panic = 101,
    /// A processor fault.
    Fault = 102,
    /// An unexpected interrupt.
    StrayInterrupt = 103,
    /// Watchdog timeout.
    Watchdog = 104,
}

/// A file on the host, in QEMU's working directory. Closed when QEMU ends.
pub struct File(usize);

impl File {
    /// Opens a file for reading.
    ///
    /// # Panics
    /// If the host can't open it.
    pub fn read_from(name: &CStr) -> Self {
        Self::open(name, nr::open::R_BINARY)
    }

    /// Creates or truncates a file.
    ///
    /// # Panics
    /// If the host can't create it.
    pub fn write_to(name: &CStr) -> Self {
        Self::open(name, nr::open::RW_TRUNC_BINARY)
    }

    fn open(name: &CStr, mode: usize) -> Self {
        // SAFETY: the arguments of SYS_OPEN: a string ending in NUL, the mode, its length without the NUL.
        let handle = unsafe { syscall!(OPEN, name.as_ptr(), mode, name.count_bytes()) };
        assert!(handle != usize::MAX, "the host can't open {name:?}");
        Self(handle)
    }

    /// Fills `bytes`; `false` when the file ends before.
    pub fn read_exact(&mut self, mut bytes: &mut [u8]) -> bool {
        while !bytes.is_empty() {
            let got = self.read_some(bytes);
            if got == 0 {
                return false;
            }
            bytes = &mut bytes[got..];
        }
        true
    }

    /// Waits for bytes and reads as many as are available and fit; returns their number, 0 at the end.
    fn read_some(&mut self, bytes: &mut [u8]) -> usize {
        // SAFETY: the arguments of SYS_READ: handle, a buffer the host may write, its length.
        let left = unsafe { syscall!(READ, self.0, bytes.as_mut_ptr(), bytes.len()) };
        bytes.len() - left.min(bytes.len())
    }

    /// Writes all of `bytes`.
    ///
    /// # Panics
    /// If writing fails.
    pub fn write_all(&mut self, bytes: &[u8]) {
        assert!(self.write(bytes), "the host does not take {} bytes", bytes.len());
    }

    /// Writes all of `bytes`; `false` if writing fails.
    fn write(&mut self, bytes: &[u8]) -> bool {
        // SAFETY: the arguments of SYS_WRITE: handle, a buffer the host may read, its length.
        let left = unsafe { syscall!(WRITE, self.0, bytes.as_ptr(), bytes.len()) };
        left == 0
    }
}

/// QEMU's standard output or standard error, for text.
pub struct Text(File);

impl Text {
    /// Standard output.
    pub fn out() -> Self {
        Self(File::open(c":tt", nr::open::RW_TRUNC_BINARY))
    }

    /// Standard error.
    pub fn err() -> Self {
        Self(File::open(c":tt", nr::open::RW_APPEND_BINARY))
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        if self.0.write(text.as_bytes()) { Ok(()) } else { Err(core::fmt::Error) }
    }
}

/// QEMU's standard input and output.
pub struct Stream {
    input: File,
    output: File,
}

impl Stream {
    /// Opens both.
    ///
    /// # Panics
    /// If the host can't open them.
    pub fn open() -> Self {
        Self {
            input: File::open(c":tt", nr::open::R_BINARY),
            output: File::open(c":tt", nr::open::RW_TRUNC_BINARY),
        }
    }

    /// Writes all of `bytes`; `false` if the host has closed the connection.
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        self.output.write(bytes)
    }

    /// Waits for one whole chunk, whose length `whole` gives from its header; returns the length. `None` if the host
    /// has closed the connection.
    pub fn read(&mut self, to: &mut [u8], whole: impl Fn(&[u8]) -> Option<usize>) -> Option<usize> {
        let mut have = 0;
        loop {
            let got = self.input.read_some(&mut to[have..]);
            if got == 0 {
                return None;
            }
            have += got;
            if whole(&to[..have]).is_some_and(|length| have >= length) {
                return Some(have);
            }
        }
    }
}

/// The number in `name=number` on the image's command line (`-semihosting-config arg=...`).
pub fn argument(name: &str) -> Option<u32> {
    let arguments = command_line();
    arguments.split(' ').find_map(|word| word.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
}

/// The arguments of the image, separated by blanks.
pub fn command_line() -> String<256> {
    let mut bytes = [0_u8; 256];
    let mut block = [bytes.as_mut_ptr() as usize, bytes.len() - 1];
    // SAFETY: the argument of SYS_GET_CMDLINE: a buffer the host may write and its length.
    let failed = unsafe { cortex_m_semihosting::syscall1(nr::GET_CMDLINE, block.as_mut_ptr() as usize) };
    let mut arguments = String::new();
    if failed == 0
        && let Ok(line) = CStr::from_bytes_until_nul(&bytes)
    {
        // Both hold 256 bytes.
        let _ = arguments.write_str(line.to_str().unwrap_or_default());
    }
    arguments
}

/// Ends QEMU with the status.
pub fn exit(status: Exit) -> ! {
    const SYS_EXIT_EXTENDED: usize = 0x20;
    const APPLICATION_EXIT: u32 = 0x20026;
    let block = [APPLICATION_EXIT, status as u32];
    loop {
        // SAFETY: the argument of SYS_EXIT_EXTENDED: the reason and the status.
        unsafe { cortex_m_semihosting::syscall1(SYS_EXIT_EXTENDED, block.as_ptr() as usize) };
    }
}
